"""Excitations that are measured, adjusted or found.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_nms_modes.py
"""
import functools
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import LONGEST, PROGRAM, ROOT, ProgramTest

EXAMPLE = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "ceinms_example"
MUSCLES = ["lat_gas_r", "med_gas_r", "per_brev_r", "per_long_r", "per_tert_r", "soleus_r", "tib_ant_r"]


@functools.lru_cache(maxsize=None)
def _made_once():
    folder = tempfile.TemporaryDirectory()
    path = Path(folder.name) / "ankle.h5"
    subprocess.run([PROGRAM, "data", "synthesize", "nms", "--out", path], check=True, capture_output=True,
                   timeout=LONGEST)
    return folder, path


def channels(file, trial, grid):
    return {name: channel[()] for name, channel in file["trials"][trial][grid]["channels"].items()}


class AnkleStudy(ProgramTest):
    def setUp(self):
        super().setUp()
        shutil.copy(_made_once()[1], self.path("ankle.h5"))

    def without(self, muscle, name="less.h5"):
        shutil.copy(self.path("ankle.h5"), self.path(name))
        with h5py.File(self.path(name), "r+") as file:
            for trial in file["trials"].values():
                del trial["excitations"]["channels"][muscle]
        return name

    def test_assisted_lies_between_open_loop_and_the_moments(self):
        self.succeeds("simulate", "nms", "--data", "ankle.h5", "--out", "open.h5")
        errors = []
        for gamma in (1000000, 100, 1):
            said = self.succeeds("simulate", "nms", "--data", "ankle.h5", "--mode", "assisted", "--gamma", gamma,
                                 "--out", f"assisted_{gamma}.h5")
            self.assertIn("excitations of 0 muscles were found, of 7 adjusted", said)
            with h5py.File(self.path("ankle.h5")) as data, h5py.File(self.path(f"assisted_{gamma}.h5")) as file:
                moment = channels(data, "train_60", "moments")["ankle_angle_r_moment"]
                found = channels(file, "train_60", "simulated")["ankle_angle_r_moment"]
                errors.append(np.sqrt(np.mean((moment - found)**2)))
                after = channels(file, "train_60", "excitations")
                before = channels(file, "train_60", "excitations_measured")
            self.assertEqual(sorted(after), MUSCLES)
            for muscle in MUSCLES:
                self.assertTrue(np.all((after[muscle] >= 0) & (after[muscle] <= 1)))
                if gamma == 1000000:
                    np.testing.assert_array_equal(after[muscle], before[muscle])
        with h5py.File(self.path("ankle.h5")) as data, h5py.File(self.path("open.h5")) as file:
            moment = channels(data, "train_60", "moments")["ankle_angle_r_moment"]
            error = np.sqrt(np.mean((moment - channels(file, "train_60", "simulated")["ankle_angle_r_moment"])**2))
        # The filter at the rate of the frames instead of that of the EMG.
        self.assertLess(abs(errors[0] - error), 0.02 * error)
        self.assertGreater(errors[0], errors[1])
        self.assertGreater(errors[1], 5 * errors[2])

    def test_a_muscle_without_emg_is_found(self):
        less = self.without("tib_ant_r")
        done = self.run_program("simulate", "nms", "--data", less, "--out", "x.h5")
        self.assertEqual(done.returncode, 2)
        self.assertIn("less.h5: trial 'train_120': grid 'excitations' has no channel 'tib_ant_r'", done.stderr)
        said = self.succeeds("simulate", "nms", "--data", less, "--mode", "hybrid", "--out", "hybrid.h5")
        self.assertIn("excitations of 1 muscles were found, of 0 adjusted", said)
        with h5py.File(self.path("hybrid.h5")) as file:
            found = channels(file, "train_60", "excitations")
            measured = channels(file, "train_60", "excitations_measured")
        self.assertEqual(sorted(set(found) - set(measured)), ["tib_ant_r"])
        self.assertGreater(found["tib_ant_r"].max(), 0.05)
        for muscle in measured:
            np.testing.assert_array_equal(found[muscle], measured[muscle])

    def test_no_emg_at_all(self):
        with h5py.File(self.path("ankle.h5"), "r+") as file:
            for trial in file["trials"].values():
                del trial["excitations"]
        said = self.succeeds("simulate", "nms", "--data", "ankle.h5", "--mode", "optimised", "--beta", "0.5",
                             "--out", "optimised.h5")
        self.assertIn("mode optimised: alpha 1, beta 0.5", said)
        with h5py.File(self.path("optimised.h5")) as file:
            self.assertNotIn("excitations_measured", file["trials"]["train_60"])

    def test_same_answer_twice(self):
        for name in ("a.h5", "b.h5"):
            self.succeeds("simulate", "nms", "--data", "ankle.h5", "--mode", "assisted", "--out", name)
        self.assertEqual(self.path("a.h5").read_bytes(), self.path("b.h5").read_bytes())

    def test_wrong_words(self):
        simulate = ("simulate", "nms", "--data", "ankle.h5", "--out", "x.h5")
        self.fails("--mode: there is no mode 'asisted'; did you mean 'assisted'?", *simulate, "--mode", "asisted")
        self.fails("--mode open_loop takes excitations as measured: expected neither weights nor muscles", *simulate,
                   "--mode", "open_loop", "--beta", "2")
        self.fails("ankle.h5: weights and muscles of a mode were given without --mode hybrid, assisted or optimised",
                   *simulate, "--beta", "2")
        self.fails("ankle.h5: beta = -2: expected a number of at least 0", *simulate, "--mode", "assisted",
                   "--beta", "-2")
        self.fails("ankle.h5: adjust: no joint that is fitted has the muscle 'soleus'; did you mean 'soleus_r'?",
                   *simulate, "--mode", "hybrid", "--adjust", "soleus")
        self.fails("ankle.h5: mode hybrid: every muscle has a measured excitation and none is to be synthesised or "
                   "adjusted: nothing to find", *simulate, "--mode", "hybrid")
        self.fails("--mode, its weights and its muscles: the problem 'drive' has none, only nms has", "simulate",
                   "drive", "--data", "ankle.h5", "--out", "x.h5", "--mode", "hybrid")


@unittest.skipUnless((EXAMPLE / "exe_hybrid.xml").exists(), "needs the shared data")
class FromCeinms(ProgramTest):
    def project(self, old="", new=""):
        """CEINMS's example with one piece of its execution replaced; its setup."""
        for name in ("exc.xml", "true.xml", "setup_true_hybrid_1.xml"):
            shutil.copy(EXAMPLE / name, self.path(name))
        shutil.copytree(EXAMPLE / "trial1", self.path("trial1"), dirs_exist_ok=True)
        text = (EXAMPLE / "exe_hybrid.xml").read_text()
        self.assertIn(old, text)
        self.write("exe_hybrid.xml", text.replace(old, new) if old else text)
        return "setup_true_hybrid_1.xml"

    def test_one_import_is_enough(self):
        done = self.run_program("data", "ceinms", self.project(), "--out", "hybrid.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("`sinew simulate nms` adjusts the excitations", " ".join(done.stderr.split()))
        done = self.run_program("simulate", "nms", "--data", "hybrid.h5", "--out", "found.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("mode assisted: alpha 1, beta 2, gamma 3; excitations of 1 muscles were found, of 10 adjusted",
                      done.stdout)
        self.assertIn("note: muscle 'bifemsh_r': its measured excitation is not looked at", done.stderr)
        with h5py.File(self.path("found.h5")) as file:
            objective = channels(file, "trial1", "objective")["objective"]
            found = channels(file, "trial1", "excitations")
            measured = channels(file, "trial1", "excitations_measured")
        self.assertEqual(len(objective), 121)
        self.assertNotIn("bifemsh_r", measured)
        # Open loop: 116.83 with the excitations that the moments were made with.
        self.assertLess(objective.sum(), 111)
        adjusted = sum(np.abs(found[muscle] - measured[muscle]).sum() for muscle in measured)
        self.assertGreater(adjusted, 0.1)
        self.succeeds("simulate", "nms", "--data", "hybrid.h5", "--mode", "open_loop", "--out", "open.h5")

    def test_wrong_executions(self):
        for old, new, message in (
                ("<beta>2</beta>", "<beta>-2</beta>", "<beta> is -2, expected a number of at least 0"),
                ("<beta>2</beta>", "<beta>two</beta>", "beta is 'two', expected a number"),
                ("<gamma>3</gamma>", "", "<hybrid> has no <gamma>"),
                ("soleus_r tib_ant_r", "soles_r tib_ant_r",
                 "<hybrid>: the subject has no muscle 'soles_r'; did you mean 'soleus_r'?"),
                ("<hybrid>", "<hybrd>", "exe_hybrid.xml:"),
        ):
            with self.subTest(new=new):
                setup = self.project(old, new)
                done = self.run_program("data", "ceinms", setup, "--out", "hybrid.h5")
                self.assertEqual(done.returncode, 2)
                self.assertIn(message, done.stderr)
                self.assertRegex(done.stderr, r"^sinew: error: exe_hybrid\.xml:\d+: ")
                self.assertFalse(self.path("hybrid.h5").exists())


if __name__ == "__main__":
    unittest.main()

"""A CEINMS-RT project through the program: its calibration file becomes a data set that is fitted.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_ceinms_rt.py
"""
import os
import random
import re
import shutil
import unittest
import xml.etree.ElementTree as ET
from pathlib import Path

import h5py
import numpy as np

from program import ROOT, ProgramTest, contents

WALKING = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "walking_emg"
BEFORE = "gait2392_simbody_marker_ankle_knee_hip_r.xml"
ANKLE = ("tib_ant_r", "soleus_r", "med_gas_r", "lat_gas_r")


def table(path):
    """Columns of a .sto by name."""
    lines = path.read_text().splitlines()
    begin = next(i for i, line in enumerate(lines) if line.strip() == "endheader") + 1
    names = lines[begin].split()
    return dict(zip(names, np.loadtxt(lines[begin + 1:], ndmin=2).T))


def muscles(path):
    root = ET.fromstring(path.read_text(encoding="utf-8-sig"))
    return {m.find("name").text: {c.tag: c.text for c in m} for m in root.find("muscles")}


def one_pass(b, a, values):
    """y_k = sum b x - sum a y, from rest."""
    out = np.zeros(len(values))
    for k in range(len(values)):
        out[k] = (sum(b[i] * values[k - i] for i in range(len(b)) if k >= i) -
                  sum(a[i] * out[k - 1 - i] for i in range(len(a)) if k >= i + 1))
    return out


@unittest.skipUnless(WALKING.is_dir(), f"{WALKING} is not there")
class CeinmsRt(ProgramTest):
    def layout(self, folder="root"):
        """The project as CEINMS-RT has it: names are relative to the folder that holds cfg/."""
        model = self.path(folder) / "cfg" / "LowerLimbModel"
        (model / "model").mkdir(parents=True)
        (model / "data" / "walk36").mkdir(parents=True)
        for name in ("Calibration.xml", "executionEMG.xml"):
            shutil.copyfile(WALKING / name, model / name)
        shutil.copyfile(WALKING / "gait2392.osim", model / "model" / "gait2392.osim")
        shutil.copyfile(WALKING / BEFORE, model / "data" / BEFORE)
        for name in ("ik.sto", "id.sto", "emgFilt.sto"):
            shutil.copyfile(WALKING / "walk36" / name, model / "data" / "walk36" / name)
        return model

    def change(self, path, old, new):
        text = path.read_text(encoding="utf-8-sig")
        self.assertIn(old, text)
        path.write_text(text.replace(old, new))

    def imports(self, *words):
        """Notes, on one line each."""
        done = self.run_program("data", "ceinms", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr.replace("\n  ", " ")

    def refuses(self, part, *words):
        before = contents(self.folder)
        done = self.run_program("data", "ceinms", *words)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertEqual((done.stderr.count("sinew: error: "), done.stderr.count("\n")), (1, 1), done.stderr)
        self.assertIn(part, done.stderr)
        self.assertEqual(contents(self.folder), before, "something was written")

    def test_the_published_project_is_one_command(self):
        notes = self.imports(WALKING / "Calibration.xml", "--validate", "walk36:35:55,walk45:1:58", "--out", "w.h5")
        for words in ("(--execution): rigid", "EMD: the times of the excitations are later by 0.1 s", "C1 and C2 are 0",
                      "interpolates them between nodes", "its penalty for fibres", "annealing"):
            self.assertIn(words, notes)
        emg, moments = (table(WALKING / "walk36" / name) for name in ("emgFilt.sto", "id.sto"))
        with h5py.File(self.path("w.h5")) as file:
            self.assertEqual({n: t.attrs["role"] for n, t in file["trials"].items()},
                             {"walk36": "train", "walk36_35_55": "validate", "walk45": "validate"})
            trial = file["trials/walk36"]
            np.testing.assert_allclose(trial["moments/time"], np.arange(1900, 2401) / 100, atol=1e-9)
            np.testing.assert_array_equal(trial["moments/channels/ankle_angle_r_moment"][:],
                                          moments["ankle_angle_r_moment"][1900:2401])
            # What acts at 19.00 s was measured at 18.90 s.
            at = np.argmin(np.abs(trial["excitations/time"][:] - 19))
            self.assertEqual(trial["excitations/channels/soleus_r"][at], emg["soleus_r"][1890])
            self.assertEqual(sorted(trial["lengths/channels"]), sorted(ANKLE))
            self.assertEqual(file["trials/walk45/moments/time"][-1], 58)
            self.path("made.xml").write_text(file["files/subject.xml"][()].decode())
        before, made = muscles(WALKING / BEFORE), muscles(self.path("made.xml"))
        for name, values in before.items():
            self.assertEqual(made[name], {**values, "C1": "0", "C2": "0"})

    def test_the_subject_is_written_back_to_the_byte(self):
        """Nothing but the fitted numbers changes: not C1 and C2, which CEINMS-RT does not use, nor the byte-order mark."""
        self.imports(WALKING / "Calibration.xml", "--out", "w.h5")
        self.run_program("identify", "nms", "--data", "w.h5", "--solver", "lm", "--max-evaluations", "5", "--intervals", "linear",
                         "--quiet", "--out", "run.h5")
        self.succeeds("data", "subject", "run.h5", "--out", "back.xml")
        original, back = (WALKING / BEFORE).read_bytes(), self.path("back.xml").read_bytes()
        self.assertEqual(back[:3] == b"\xef\xbb\xbf", original[:3] == b"\xef\xbb\xbf")
        fitted = {"shapeFactor", "strengthCoefficient", "tendonSlackLength", "optimalFiberLength"}
        before, after = muscles(WALKING / BEFORE), muscles(self.path("back.xml"))
        for name, values in before.items():
            same = set(values) - (fitted if name in ANKLE else set())
            self.assertEqual({tag: after[name][tag] for tag in same}, {tag: values[tag] for tag in same})

    def test_without_crop_times_it_is_all_of_the_recording(self):
        model = self.layout()
        text = (model / "Calibration.xml").read_text(encoding="utf-8-sig")
        text = re.sub(r"<cropM(in|ax)TimeFromZero>[^<]*</cropM(in|ax)TimeFromZero>", "", text)
        # EMD moves the EMG to later times: before that there is none.
        (model / "Calibration.xml").write_text(re.sub(r"<EMD>[^<]*</EMD>", "<EMD>0</EMD>", text))
        self.imports(model / "Calibration.xml", "--out", "all.h5")
        moments = table(WALKING / "walk36" / "id.sto")["time"]
        with h5py.File(self.path("all.h5")) as file:
            (name,) = file["trials"]
            times = file[f"trials/{name}/moments/time"][:]
        self.assertAlmostEqual(times[0], moments[0], 6)
        self.assertGreater(times[-1], moments[-1] - 0.1)

    def test_lengths_are_those_of_data_muscles(self):
        self.imports(WALKING / "Calibration.xml", "--out", "w.h5")
        self.succeeds("data", "import", WALKING / "walk36" / "ik.sto", WALKING / "gait2392.osim", "--trial", "all", "--out", "all.h5")
        self.succeeds("data", "muscles", "all.h5", "--muscles", ",".join(ANKLE), "--joints", "ankle_angle_r", "--quiet")
        with h5py.File(self.path("w.h5")) as made, h5py.File(self.path("all.h5")) as whole:
            first = round(made["trials/walk36/lengths/time"][0] * 100)
            for grid in ("lengths", "moment_arms.ankle_angle_r"):
                for muscle in ANKLE:
                    values = made[f"trials/walk36/{grid}/channels/{muscle}"][:]
                    expected = whole[f"trials/all/{grid}/channels/{muscle}"][first:first + len(values)]
                    np.testing.assert_allclose(values, expected, rtol=0, atol=1e-12)

    def test_the_fit_is_within_ceinms_rt_s_ranges_and_better_than_the_published_one(self):
        """The published answer to the same question: five seconds, 14 numbers."""
        published = muscles(WALKING / "subjectCalibrated.xml")
        before = muscles(WALKING / BEFORE)
        self.imports(WALKING / "Calibration.xml", "--out", "w.h5")
        self.run_program("identify", "nms", "--data", "w.h5", "--solver", "hop", "--quiet", "--out", "run.h5")
        with h5py.File(self.path("run.h5")) as run:
            numbers = run["parameters"]
            bounds = {n: (lo, hi) for n, lo, hi in zip(numbers["name"].asstr()[:], numbers["lower"][:], numbers["upper"][:])}
            cost = run["run"].attrs["cost"]
            self.assertEqual(len(run["uncertainty/name"]), 14)
        slack = 1e-5  # digits that were published
        for name in ANKLE:
            group = name if name == "tib_ant_r" else "group_2"
            for tag, parameter, scale in (
                    ("shapeFactor", f"{name}.shape", 1), ("strengthCoefficient", f"{group}.strength", 1),
                    ("tendonSlackLength", f"{name}.tendon_slack_length", float(before[name]["tendonSlackLength"])),
                    ("optimalFiberLength", f"{name}.optimal_length", float(before[name]["optimalFiberLength"]))):
                lower, upper = bounds[parameter]
                value = float(published[name][tag]) / scale
                self.assertTrue(lower - slack < value < upper + slack, (parameter, value, lower, upper))
        theirs = self.path("theirs")
        theirs.mkdir()
        (theirs / "walk36").mkdir()
        for name in ("gait2392.osim", "subjectCalibrated.xml", "walk36/ik.sto", "walk36/id.sto", "walk36/emgFilt.sto"):
            shutil.copyfile(WALKING / name, theirs / name)
        shutil.copyfile(WALKING / "Calibration.xml", theirs / "Calibration.xml")
        self.change(theirs / "Calibration.xml", f"<inputSubjectXMLName>{BEFORE}", "<inputSubjectXMLName>subjectCalibrated.xml")
        self.imports(theirs / "Calibration.xml", "--out", "theirs.h5")
        # The groups of the published subject are those of its own, calibrated numbers: the calf still shares one.
        told = self.run_program("simulate", "nms", "--data", "theirs.h5", "--out", "theirs_out.h5").stdout
        rmse = float(next(line.split()[3] for line in told.splitlines() if " train " in line))
        with h5py.File(self.path("w.h5")) as file:
            moment = file["trials/walk36/moments/channels/ankle_angle_r_moment"][:]
        # cost is half of the squares over variance and samples
        theirs_cost = 0.5 * rmse ** 2 / moment.var(ddof=1)
        self.assertLess(cost, theirs_cost)
        self.assertGreater(cost, 0.5 * theirs_cost)  # the same problem, not another one

    def test_ceinms_rt_s_own_layout_from_any_folder(self):
        model = self.layout()
        self.imports(model / "Calibration.xml", "--out", "layout.h5")
        self.imports(WALKING / "Calibration.xml", "--out", "flat.h5")
        with h5py.File(self.path("layout.h5")) as a, h5py.File(self.path("flat.h5")) as b:
            self.assertEqual(a["files/subject.xml"][()], b["files/subject.xml"][()])
            for grid in a["trials/walk36"]:
                for channel in a[f"trials/walk36/{grid}/channels"]:
                    where = f"trials/walk36/{grid}/channels/{channel}"
                    np.testing.assert_array_equal(a[where][:], b[where][:])

    def test_raw_emg_is_filtered_as_ceinms_rt_does(self):
        model = self.layout()
        self.change(model / "Calibration.xml", "<EMD>0.1</EMD>", "<filterEMG>true</filterEMG><EMD>0</EMD>")
        self.refuses("data/walk36/emg.sto", model / "Calibration.xml", "--out", "raw.h5")
        raw = table(model / "data" / "walk36" / "emgFilt.sto")
        noise = np.random.default_rng(3).standard_normal(len(raw["time"]))
        raw = {name: values if name == "time" else values * noise for name, values in raw.items()}
        lines = ["EMG", f"nRows={len(noise)}", f"nColumns={len(raw)}", "endheader", "\t".join(raw)]
        lines += ["\t".join(repr(float(v)) for v in row) for row in zip(*raw.values())]
        (model / "data" / "walk36" / "emg.sto").write_text("\n".join(lines) + "\n")
        # Channels in alphabetical order: bifemlh_r ... vas_med_r.
        self.change(model / "executionEMG.xml", "<maxEMG>1 1 1 1 1 1 1 1 1<", "<maxEMG>0.5 0 0 0 0 0 0 0 0<")
        self.imports(model / "Calibration.xml", "--out", "raw.h5")
        coefficients = {f.tag: [[float(v) for v in f.find(c).text.split()] for c in ("bCoeff", "aCoeff")]
                        for f in ET.parse(model / "executionEMG.xml").getroot() if f.tag in ("hpFilter", "lpFilter")}
        with h5py.File(self.path("raw.h5")) as file:
            grid = file["trials/walk36/excitations"]
            first = round(grid["time"][0] * 100)
            for channel in ("soleus_r", "bifemlh_r"):
                envelope = one_pass(*coefficients["lpFilter"], np.abs(one_pass(*coefficients["hpFilter"], raw[channel])))
                greatest = max(envelope.max(), 0.5 if channel == "bifemlh_r" else 0)
                made = grid[f"channels/{channel}"][:]
                np.testing.assert_allclose(made, envelope[first:first + len(made)] / greatest, atol=1e-9)

    def test_the_execution_knows_the_tendon(self):
        model = self.layout()
        text = ("<execution><NMSmodel><type><realTime><openLoop/></realTime></type><tendon><{}/></tendon><activation><exponential/>"
                "</activation></NMSmodel></execution>")
        (model / "executionRT.xml").write_text(text.format("elasticBiSec"))
        self.assertNotIn("--execution", self.imports(model / "Calibration.xml", "--out", "a.h5"))
        self.write("other.xml", text.format("elastic"))
        self.imports(model / "Calibration.xml", "--execution", "other.xml", "--out", "b.h5")
        for name, tendon in (("a.h5", "elastic"), ("b.h5", "equilibrium")):
            with h5py.File(self.path(name)) as file:
                self.assertIn(f"  tendon: {tendon}\n", file["files/nms.yaml"][()].decode())
        self.refuses("no such file", model / "Calibration.xml", "--execution", "missing.xml", "--out", "c.h5")
        self.write("setup.xml", "<ceinmsCalibration/>")
        self.refuses("setup.xml:1: --execution goes with a calibration of CEINMS-RT", "setup.xml", "--execution", "other.xml", "--out", "c.h5")

    def test_wrong_projects_get_one_sentence_and_write_nothing(self):
        for file, old, new, words in (
                ("Calibration.xml", "model/gait2392.osim", "model/gait.osim", "Calibration.xml:18: <osimFile> names"),
                ("Calibration.xml", f"<inputSubjectXMLName>{BEFORE}", "<inputSubjectXMLName>missing.xml",
                 "Calibration.xml:47: <inputSubjectXMLName> names 'cfg/LowerLimbModel/data/missing.xml', which is not there"),
                ("Calibration.xml", "<trialName>walk36", "<trialName>walk99", "Calibration.xml:36: trial 'walk99' names"),
                ("Calibration.xml", "_single<", "_both<", "Calibration.xml:29: CEINMS-RT has no objective function"),
                ("Calibration.xml", "<dofs>ankle_angle_r", "<dofs>ankle_angle", "did you mean 'ankle_angle_r'?"),
                ("Calibration.xml", "<cropMaxTimeFromZero>24", "<cropMaxTimeFromZero>70", "its window ends 70 s"),
                ("Calibration.xml", "<cropMinTimeFromZero>19", "<cropMinTimeFromZero>24", "the window 24 to 24 s is none"),
                ("Calibration.xml", "simulatedAnnealing", "simulatedannealing", "expected <ceinmsCalibration>, <ceinms>, or CEINMS-RT's"),
                (f"data/{BEFORE}", "<muscles>", "<muscle>", "not well-formed XML"),
                (f"data/{BEFORE}", "soleus_r", "soleus_x", "soleus_x"),
                ("data/walk36/emgFilt.sto", "soleus_r", "solus_r", "there is no column 'soleus_r'"),
                ("data/walk36/id.sto", "ankle_angle_r_moment", "moment", "there is no column 'ankle_angle_r_moment'"),
                ("data/walk36/ik.sto", "ankle_angle_r", "angle", "there is no column 'ankle_angle_r'"),
                ("model/gait2392.osim", 'name="soleus_r"', 'name="soleus"', "soleus_r"),
        ):
            with self.subTest(words=words):
                shutil.rmtree(self.path("root"), ignore_errors=True)
                model = self.layout()
                self.change(model / file, old, new)
                self.refuses(words, model / "Calibration.xml", "--out", "w.h5")
        for word in ("walk45:1", "walk45:8:1", ":1:2", "walk45:a:b", "walk45:1:inf"):
            self.refuses(f"--validate {word}: expected TRIAL", WALKING / "Calibration.xml", "--validate", word, "--out", "w.h5")
        self.refuses("there is already a trial called 'walk36'", WALKING / "Calibration.xml", "--validate", "walk36", "--out", "w.h5")

    def test_spoilt_bytes_never_crash(self):
        model = self.layout()
        chance = random.Random(5)
        for path in (model / "Calibration.xml", model / "data" / BEFORE):
            good = path.read_bytes()
            for _ in range(12):
                bad = bytearray(good)
                for _ in range(20):
                    bad[chance.randrange(len(bad))] = chance.randrange(256)
                path.write_bytes(bytes(bad[:chance.choice((len(bad), chance.randrange(len(bad))))]))
                done = self.run_program("data", "ceinms", model / "Calibration.xml", "--out", "w.h5")
                self.assertIn(done.returncode, (0, 2), done.stderr)
                if done.returncode == 2:
                    self.assertEqual(done.stderr.count("sinew: error: "), 1, done.stderr)
            path.write_bytes(good)


if __name__ == "__main__":
    unittest.main()

"""--quiet, --threads, --seed and --json, on every command that they mean something to.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_common_options.py
"""
import json
import os
import pty
import subprocess
import unittest

import h5py

from laboratory_files import mot
from program import PROGRAM, ProgramTest

QUIET = (("data", "synthesize"), ("data", "kinematics"), ("data", "muscles"), ("simulate",), ("identify",), ("diagnose",),
         ("compare",), ("report",), ("mbs",))
THREADS = (("data", "synthesize"), ("data", "kinematics"), ("simulate",), ("identify",), ("diagnose",), ("compare",),
           ("report",))
SEED = (("data", "synthesize"), ("identify",), ("diagnose",), ("compare",))
JSON = (("list",), ("data", "synthesize"), ("data", "import"), ("data", "cut"), ("data", "split"), ("data", "drop"), ("data", "loads"),
        ("data", "kinematics"),
        ("data", "envelope"), ("data", "ceinms"), ("data", "muscles"), ("simulate",), ("identify",), ("diagnose",),
        ("compare",), ("mbs",))


class Declared(ProgramTest):
    def test_wherever_they_mean_something(self):
        for option, commands in (("--quiet", QUIET), ("--threads", THREADS), ("--seed", SEED), ("--json", JSON)):
            for words in commands:
                with self.subTest(" ".join(words) + " " + option):
                    self.assertRegex(self.succeeds(*words, "--help"), rf"{option}\b")

    def test_with_the_same_meaning_and_range_everywhere(self):
        for words in THREADS:
            hint = f" (see sinew {' '.join(words)} --help)"
            self.assertIn("default: the cores of the machine", " ".join(self.succeeds(*words, "--help").split()))
            for value in ("0", "-1", "1025", "two", "1.5", ""):
                self.fails(f"--threads: Value {value} not in range 1 to 1024{hint}", *words, "--threads", value)
        for words in SEED:
            hint = f" (see sinew {' '.join(words)} --help)"
            for value in ("-1", "one", "1.5", "9007199254740993"):
                self.fails(f"--seed: Value {value} not in range 0 to 9007199254740992{hint}", *words, "--seed", value)
        for words in JSON:
            self.fails(f"--json: expected a name, not an empty word (see sinew {' '.join(words)} --help)", *words, "--json", "")


class Json(ProgramTest):
    def written(self, *words):
        """What the command reports of the data set that it wrote is what `data info` says of the file."""
        report = json.loads(self.succeeds(*words, "--json", "-"))
        out = words[words.index("--out") + 1] if "--out" in words else words[2]
        info = json.loads(self.succeeds("data", "info", out, "--json"))
        self.assertEqual({key: report[key] for key in info}, info, words)
        return report

    def test_of_commands_that_write_a_data_set(self):
        self.written("data", "synthesize", "contact", "--out", "new.h5", "--quiet", "--threads", 1)
        self.write("walk.mot", mot())
        self.written("data", "import", "walk.mot", "--out", "walk.h5")
        self.stances()
        self.written("data", "cut", "stances.h5", "--trial", "train_1", "--window", "0.1:0.3", "--as", "new")
        self.written("data", "drop", "stances.h5", "--trial", "new")
        self.written("data", "split", "stances.h5", "--every", "0.2")

    def test_into_a_file_beside_the_text(self):
        text = self.succeeds("data", "synthesize", "contact", "--out", "new.h5", "--json", "new.json")
        self.assertEqual(text, "new.h5: 5 trials, synthetic (a small humanoid robot stepping)\n")
        self.assertEqual(json.loads(self.path("new.json").read_text()),
                         json.loads(self.succeeds("data", "info", "new.h5", "--json")))

    def test_of_inverse_kinematics(self):
        self.succeeds("data", "synthesize", "contact", "--out", "stances.h5")
        fits = self.written("data", "kinematics", "stances.h5", "--quiet")["marker_fit"]
        self.assertEqual([fit["trial"] for fit in fits], sorted(fit["trial"] for fit in fits))
        self.assertEqual(len(fits), 5)
        for fit in fits:
            self.assertGreater(fit["rms_m"], 0)
            self.assertLess(fit["rms_m"], fit["max_m"])
            self.assertEqual((fit["unmatched"], fit["unconverged_frames"]), ([], 0))
            self.assertEqual((fit["undetermined"], fit["undetermined_in"]), ([], []))
            self.assertTrue(fit["worst_marker"])
            self.assertLess(fit["worst_frame"], fit["frames"])
            self.assertGreater(fit["agreeing_starts"], 0)
            self.assertLessEqual(fit["agreeing_starts"], fit["starts"])
        with h5py.File(self.path("stances.h5")) as file:
            self.assertEqual(json.loads(file["files/kinematics.json"].asstr()[()]), fits)

    def test_of_a_simulation(self):
        self.stances()
        words = ("simulate", "contact", "--data", "stances.h5", "--quiet")
        found = json.loads(self.succeeds(*words, "--out", "sim.h5", "--json", "-"))
        self.assertEqual((found["schema"], found["problem"], found["data"], found["files"]),
                         ("sinew.simulation/1", "contact", "stances.h5", ["sim.h5"]))
        fitted = [fit for fit in found["fit"] if fit["role"] != "predicted"]
        self.assertEqual({fit["role"] for fit in fitted if fit["trial"] == "train_1"}, {"train"})
        self.assertEqual({fit["role"] for fit in fitted}, {"train", "validate"})
        self.assertTrue(all(fit["rmse"] > 0 and fit["n"] > 0 for fit in fitted))
        several = json.loads(self.succeeds(*words, "--out", "sim.sto", "--json", "-"))
        self.assertEqual(several["fit"], found["fit"])
        for name in several["files"]:
            self.assertTrue(self.path(name).is_file(), name)

    def test_of_lists(self):
        for what, name in (("problems", "contact"), ("solvers", "ceres"), ("integrators", "rk_merson"), ("formats", ".h5")):
            entries = json.loads(self.succeeds("list", what, "--json", "-"))[what]
            self.assertIn(name, [entry["name"] for entry in entries])
        listed = json.loads(self.succeeds("list", "parameters", "contact", "--json", "-"))
        self.assertEqual(listed["problem"], "contact")
        stiffness = {p["name"]: p for p in listed["parameters"]}["stiffness"]
        self.assertLess(stiffness["lower"], stiffness["start"])
        self.assertEqual((stiffness["unit"], stiffness["scale"]), ("N/m3", "log"))
        effects = json.loads(self.succeeds("list", "effects", "drive", "--json", "-"))["effects"]
        self.assertTrue(all(effect["parameters"] and effect["level"] for effect in effects))
        self.assertIn("description", json.loads(self.succeeds("list", "channels", "contact", "--json", "-")))


class Threads(ProgramTest):
    def test_do_not_change_inverse_kinematics(self):
        for threads in (1, 3):
            self.succeeds("data", "synthesize", "contact", "--out", f"{threads}.h5", "--threads", threads)
            self.succeeds("data", "kinematics", f"{threads}.h5", "--quiet", "--threads", threads)
        self.assertEqual(self.path("1.h5").read_bytes(), self.path("3.h5").read_bytes())

    def test_do_not_change_a_simulation(self):
        self.succeeds("data", "synthesize", "free_body", "--out", "body.h5")
        for threads in (1, 3):
            self.succeeds("simulate", "free_body", "--data", "body.h5", "--out", f"{threads}.h5", "--threads", threads)
        self.assertEqual(self.path("1.h5").read_bytes(), self.path("3.h5").read_bytes())


class Quiet(ProgramTest):
    def test_shows_nothing_while_it_works(self):
        """On a terminal, where progress is shown without it."""
        for words in (("data", "kinematics", "stances.h5"), ("mbs", "all", "--accuracy", "1e-4")):
            self.succeeds("data", "synthesize", "contact", "--out", "stances.h5")
            shown = {}
            for option in ("", "--quiet"):
                try:
                    ours, theirs = pty.openpty()
                except OSError as error:  # a container without /dev/pts
                    self.skipTest(str(error))
                with self.subTest(f"{words} {option}"):
                    process = self.start_on(theirs, *words, *filter(None, [option]))
                    os.close(theirs)
                    shown[option] = self.everything_from(ours)
                    self.assertEqual(process.wait(), 0)
            self.assertIn(" of ", shown[""])
            self.assertEqual(shown["--quiet"], "")

    def start_on(self, terminal, *words):
        return subprocess.Popen([PROGRAM, *words], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=terminal)

    @staticmethod
    def everything_from(terminal):
        text = b""
        while True:
            try:
                piece = os.read(terminal, 4096)
            except OSError:  # the last writer is gone
                piece = b""
            if not piece:
                os.close(terminal)
                return text.decode()
            text += piece


if __name__ == "__main__":
    unittest.main()

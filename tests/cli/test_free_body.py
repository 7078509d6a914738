"""The thrown body through the program: contact from a pose, what is wrong with it, and the tosses of a real cube.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_free_body.py
"""
import json
import os
import unittest
from pathlib import Path

import h5py

from program import ROOT, ProgramTest

SHARED = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "cube_tosses"
BENCHMARK = ROOT / "benchmarks" / "cube_tosses"


class FreeBodyTest(ProgramTest):
    def diagnosis(self, *words):
        self.succeeds("data", "synthesize", "free_body", "--seed", "2", *words, "--out", "toss.h5")
        self.succeeds("diagnose", "free_body", "--data", "toss.h5", "--threads", "2", "--quiet", "--out", "why.h5", "--json",
                      "why.json")
        return json.loads((Path(self.folder) / "why.json").read_text())

    def test_nothing_is_wrong(self):
        found = self.diagnosis()
        self.assertEqual(found["verdict"], "adequate", found["sentences"])
        self.assertGreater(found["family_p_value"], 0.05)

    def test_a_strong_gravity_and_a_slow_clock_cannot_be_told_apart(self):
        found = self.diagnosis("--effect", "gravity_error:gravity_error=0.01", "--set", "train=4")
        self.assertEqual(found["verdict"], "ambiguous", found["sentences"])
        named = {c["effect"] for c in found["causes"]} | {a["effect"] for a in found["alternatives"]}
        self.assertLessEqual({"gravity_error", "clock_rate"}, named)

    def test_a_wrong_inertia_is_named(self):
        found = self.diagnosis("--effect", "inertia_error:inertia_error=0.05", "--set", "train=4")
        cause = next(c for c in found["causes"] if c["effect"] == "inertia_error")
        low, high = cause["parameters"][0]["ci95"]
        self.assertLess(low - 0.001, 0.05)
        self.assertLess(0.05, high + 0.001)
        gain = next(g for g in found["gains"] if g["channel"] == "position")
        self.assertGreater(gain["reduction"], 0.5)

    def test_a_whole_toss_is_predicted_from_its_flight(self):
        self.succeeds("data", "synthesize", "free_body", "--set", "train=3", "--set", "validate=2", "--out", "toss.h5")
        self.succeeds("identify", "free_body", "--data", "toss.h5", "--quiet", "--max-evaluations", "40", "--out", "run.h5")
        with h5py.File(Path(self.folder) / "run.h5") as file:
            tosses = file["details/free_body"]
            self.assertEqual(len(tosses), 5)
            for name in tosses:
                self.assertEqual(tosses[name]["predicted"].shape, tosses[name]["measured"].shape)
                self.assertLess(abs(tosses[name]["position_error"][:5]).max(), 5e-4)

    def test_threads_change_nothing(self):
        self.succeeds("data", "synthesize", "free_body", "--set", "train=3", "--set", "validate=0", "--out", "toss.h5")
        answers = []
        for threads in ("1", "2"):
            self.succeeds("identify", "free_body", "--data", "toss.h5", "--threads", threads, "--quiet", "--max-evaluations", "12", "--out",
                          "run.h5", "--json", "run.json")
            answers.append(json.loads((Path(self.folder) / "run.json").read_text())["parameters"])
        self.assertEqual(*answers)

    @unittest.skipUnless(SHARED.is_dir(), "needs the shared data")
    def test_friction_of_the_real_cube(self):
        for i, number in enumerate((0, 60, 120, 180, 240, 300, 360, 420)):
            files = [SHARED / f"{number}.csv"] + ([BENCHMARK / "free_body.yaml"] if i == 0 else [])
            done = self.run_program("data", "import", *files, "--map", BENCHMARK / "pose.yaml", "--trial", f"toss_{number}", "--out",
                                    "cube.h5", *(["--append"] if i else []))
            self.assertEqual(done.returncode, 0, done.stderr)
        self.succeeds("identify", "free_body", "--data", "cube.h5", "--threads", "2", "--release",
                      "mass_centre_offset,inertia_error,length_scale", "--quiet", "--max-evaluations", "60", "--out", "run.h5", "--json",
                      "run.json")
        found = {p["name"]: p["value"] for p in json.loads((Path(self.folder) / "run.json").read_text())["parameters"]}
        self.assertAlmostEqual(found["friction"], 0.18, delta=0.05)
        self.assertAlmostEqual(found["mass_centre_z"], 0.006, delta=0.003)


if __name__ == "__main__":
    unittest.main()

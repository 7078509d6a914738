"""The program that a user's model becomes: docs/examples/outside/tank.cpp and its made-up data.

    SINEW_OWN_MODEL=build/release/tests/cli/own_model_tank /usr/bin/python3 -B -m unittest test_own_model
"""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from program import LONGEST, ROOT, ProgramTest, contents

TANK = os.environ.get("SINEW_OWN_MODEL", "")


@unittest.skipUnless(TANK, "SINEW_OWN_MODEL names no program")
class OwnModel(ProgramTest):
    def setUp(self):
        super().setUp()
        maker = ROOT / "docs" / "examples" / "outside" / "make_tank_data.py"
        subprocess.run(["/usr/bin/python3", "-B", maker, self.path("tank.h5")], check=True, timeout=LONGEST)

    def run_program(self, *words):
        return subprocess.run([TANK, *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              timeout=LONGEST, check=False)

    def refuses(self, part, *words):
        before = contents(self.folder)
        done = self.run_program(*words)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertTrue(done.stderr.startswith("tank: error: "), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(part, done.stderr)
        self.assertEqual(contents(self.folder), before, "something was written")

    def identified(self, *words):
        self.succeeds("identify", "--data", "tank.h5", "--out", "run.h5", "--json", "run.json", "--quiet", *words)
        return json.loads(self.path("run.json").read_text())

    def test_finds_the_effect_that_is_hidden_in_its_data(self):
        self.succeeds("diagnose", "--data", "tank.h5", "--out", "diagnosis.h5", "--json", "diagnosis.json", "--quiet")
        diagnosis = json.loads(self.path("diagnosis.json").read_text())
        self.assertEqual(diagnosis["verdict"], "explained")
        self.assertEqual([cause["effect"] for cause in diagnosis["causes"]], ["overflow"])
        found = {p["name"]: p for p in diagnosis["causes"][0]["parameters"]}
        for name, truth in {"overflow_rate": 0.08, "rim_level": 0.2}.items():  # make_tank_data.py
            self.assertLess(abs(found[name]["value"] - truth), 4 * found[name]["std_error"], name)

    def test_identifies_with_the_effect_released(self):
        run = self.identified("--release", "overflow")
        found = {p["name"]: p for p in run["parameters"]}
        for name, truth in {"outflow_area": 1e-4, "pump_gain": 2e-5}.items():
            self.assertLess(abs(found[name]["value"] - truth), 4 * found[name]["std_error"], name)

    def test_the_name_of_the_only_problem_may_be_said(self):
        first = self.identified()
        self.succeeds("identify", "tank", "--data", "tank.h5", "--out", "run.h5", "--json", "run.json", "--quiet")
        second = json.loads(self.path("run.json").read_text())
        self.assertEqual(first["parameters"], second["parameters"])

    def test_the_other_commands_work_too(self):
        self.identified()
        self.succeeds("simulate", "--data", "tank.h5", "--from", "run.h5", "--out", "simulated.h5")
        with h5py.File(self.path("simulated.h5")) as file:
            self.assertEqual(sorted(file["trials"]), ["check", "fill", "high", "low"])
        self.succeeds("compare", "--data", "tank.h5", "--solvers", "ceres,lm", "--repeats", "2", "--out", "study.h5",
                      "--quiet")
        self.assertEqual(self.succeeds("list", "problems").split()[0], "tank")
        self.assertIn("initial_level@fill", self.succeeds("list", "parameters", "--data", "tank.h5"))
        self.assertIn("validate", self.succeeds("list", "channels", "--data", "tank.h5"))
        effects = self.succeeds("list", "effects", "--data", "tank.h5")
        self.assertIn("overflow  [boundary]", effects)
        self.assertIn("level.time_offset  [sensor]", effects)

    def test_a_simulation_keeps_an_effect_that_was_held(self):
        def simulated(out, *words):
            done = self.run_program("simulate", "--data", "tank.h5", "--out", out, *words)
            self.assertEqual(done.returncode, 0, done.stderr)
            with h5py.File(self.path(out)) as file:
                return done.stderr, file["trials/check/simulated/channels/level"][()]

        words = ("identify", "--data", "tank.h5", "--release", "overflow", "--quiet", "--out")
        self.succeeds(*words, "run.h5", "--fix", "level.gain=1.25")
        with h5py.File(self.path("run.h5")) as file:
            names = [name.decode() for name in file["parameters/name"][()]]
            found = dict(zip(names, file["parameters/value"][()]))
        self.assertEqual(found["level.gain"], 1.25)
        notes, with_gain = simulated("with.h5", "--from", "run.h5")
        self.assertEqual(notes, "", "a note about effects at their null values")
        without = simulated("without.h5", "--from", "run.h5", "--set", "level.gain=1")[1]
        self.assertLess(abs(with_gain / without - 1.25).max(), 1e-6)

    def test_a_note_counts_the_nuisance_values_that_are_left_out(self):
        self.succeeds("identify", "--data", "tank.h5", "--release", "level.offset", "--quiet", "--out", "run.h5")
        self.succeeds("data", "drop", "tank.h5", "--trial", "low")
        done = self.run_program("simulate", "--data", "tank.h5", "--from", "run.h5", "--out", "simulated.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(done.stderr.startswith("note: 1 nuisance value of run.h5 "), done.stderr)

    def test_no_usable_answer_has_the_name_of_the_program(self):
        # Nothing can be learned from a noise as large as the signal.
        with h5py.File(self.path("tank.h5"), "r+") as file:
            for number, trial in enumerate(file["trials"].values()):
                level = trial["logger/channels/level"]
                level[...] = np.random.default_rng(number).normal(0.1, 0.05, level.shape)
        done = self.run_program("diagnose", "--data", "tank.h5", "--out", "diagnosis.h5", "--quiet")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertTrue(done.stderr.startswith("tank: no usable answer: "), done.stderr)

    def test_bad_input_is_one_line(self):
        self.refuses("problem 'tnk' does not exist; did you mean 'tank'?", "identify", "tnk", "--data", "tank.h5",
                     "--out", "run.h5")
        self.refuses("parameter 'area' does not exist", "identify", "--data", "tank.h5", "--out", "run.h5", "--fix",
                     "area=1")
        self.refuses("has no synthetic experiment", "data", "synthesize", "tank", "--out", "new.h5")
        self.refuses("give --data F.h5", "list", "parameters")
        self.refuses("unknown command 'mbs'", "mbs")
        self.write("tank.yaml", "tank: {volume: 3}")
        self.refuses("volume", "identify", "--data", "tank.h5", "--config", "tank.yaml", "--out", "run.h5")

    def test_data_that_lack_a_channel_are_refused(self):
        with h5py.File(self.path("tank.h5"), "r+") as file:
            grid = file["trials/fill/logger/channels"]
            grid.move("pump", "pmp")
        self.refuses("tank.h5: trial 'fill' has no channel 'pump', which is an input of the model", "identify",
                     "--data", "tank.h5", "--out", "run.h5")


if __name__ == "__main__":
    unittest.main()

"""The embedded data of a knee joint's drive: what ./demo says of them, against the truth beside them.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_knee_drive.py
"""
import json
import subprocess
import sys
import unittest

import h5py

from program import LONGEST, PROGRAM, ROOT, ProgramTest, differences

DATA = ROOT / "datasets" / "data"
KNEE = DATA / "knee_drive.h5"


class KneeDrive(ProgramTest):
    def test_the_recipe_makes_these_data(self):
        subprocess.run([sys.executable, str(DATA / "make_knee_drive.py"), PROGRAM, str(self.folder)], check=True,
                       timeout=LONGEST)
        with h5py.File(KNEE) as embedded, h5py.File(self.path("knee_drive.h5")) as made:
            self.assertEqual(differences(embedded, made), [])
        self.assertEqual(self.path("knee_drive.truth.json").read_text(), (DATA / "knee_drive.truth.json").read_text())

    def test_the_data_hold_no_label_and_are_small(self):
        data = KNEE.read_bytes()
        self.assertLess(len(data), 300_000)
        truth = json.loads((DATA / "knee_drive.truth.json").read_text())
        for effect, parameters in truth["effects"].items():
            for word in (effect, *parameters):
                self.assertNotIn(word.encode(), data)
        with h5py.File(KNEE) as file:
            self.assertEqual(file.attrs["synthetic"], 1)

    def test_the_diagnosis_finds_what_was_hidden_and_what_it_brings(self):
        self.succeeds("diagnose", "drive", "--data", KNEE, "--out", "why.h5", "--json", "why.json", "--quiet")
        found = json.loads(self.path("why.json").read_text())
        truth = json.loads((DATA / "knee_drive.truth.json").read_text())
        self.assertEqual(found["verdict"], "explained")
        self.assertEqual([cause["effect"] for cause in found["causes"]], list(truth["effects"]))
        true = {**truth["base"], **next(iter(truth["effects"].values()))}
        # Four standard errors: a chance of 1e-4 for each number of this seed, were the intervals exact.
        for p in found["extended_parameters"]:
            if p["name"] in true:
                self.assertLess(abs(p["value"] - true.pop(p["name"])), 4 * p["std_error"], p["name"])
        self.assertEqual(true, {})
        self.assertGreater(found["gain"]["ci95"][0], 0.8)  # held out, 90 % less
        # 1600 correlated samples tell the noise to some percent.
        self.assertAlmostEqual(found["gain"]["validate_rmse_after"], truth["position_noise_rad"],
                               delta=0.1 * truth["position_noise_rad"])
        # By eye the base model looks right.
        self.assertGreater(min(fit["r2"] for fit in found["base"]["fit"]), 0.99)

    def test_the_base_fit_is_that_of_identify(self):
        for seed, words in ((1, []), (2, ["--from", "run.h5"])):
            self.succeeds("identify", "drive", "--data", KNEE, "--out", "run.h5", "--json", "run.json", "--seed", seed, "--quiet")
            cost = json.loads(self.path("run.json").read_text())["cost"]
            self.succeeds("diagnose", "drive", "--data", KNEE, "--out", "why.h5", "--json", "why.json", "--seed", seed, "--quiet",
                          *words)
            base = json.loads(self.path("why.json").read_text())["base"]
            self.assertAlmostEqual(base["cost"], cost, delta=1e-9 * cost)


if __name__ == "__main__":
    unittest.main()

"""The ankle on a dynamometer through the program: calibration in steps, details, what speaks against the data.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_ankle_on_dynamometer.py
"""
import json
import unittest

import h5py
import numpy as np

from program import ProgramTest

SMALL = ("--set", "duration=3", "speeds=2", "rate=100")
TRUTH = {"attachment_inertia": 0.083, "strap_stiffness": 6600, "strap_pretension": 29, "passive_exponent": 5.2, "delay": 0.042,
         "strength.triceps": 1.22, "strength.dorsiflexors": 0.84, "tendon_slack_length.triceps": 1.008}


class AnkleOnDynamometer(ProgramTest):
    def test_levels_are_calibrated_one_after_the_other_and_then_together(self):
        self.succeeds("data", "synthesize", "ankle_on_dynamometer", *SMALL, "--quiet", "--out", "ankle.h5")
        run = json.loads(self.succeeds("identify", "ankle_on_dynamometer", "--data", "ankle.h5", "--stepwise", "--solver", "lm",
                                       "--intervals", "linear", "--threads", "2", "--quiet", "--out", "run.h5", "--json", "-"))
        found = {parameter["name"]: parameter for parameter in run["parameters"]}
        for name, true in TRUTH.items():
            lower, upper = found[name]["ci95"]
            # Twice the interval: eight intervals of 95 % do not all hold.
            self.assertLess(abs(found[name]["value"] - true), upper - lower, name)
        steps = {fact["step"] for fact in run["finding_facts"]}
        self.assertLessEqual({"attachment alone", "passive", "active"}, steps)
        held_out = [fit for fit in run["fit"] if fit["channel"] == "machine_torque" and fit["role"] == "validate"]
        self.assertEqual(len(held_out), 3)
        for fit in held_out:
            self.assertLess(fit["rmse"], 0.6, fit["trial"])  # [N m], twice the noise
        with h5py.File(self.path("run.h5")) as file:
            trial = file["details/ankle_on_dynamometer/active_060"]
            total = trial["torque_of_attachment"][:] + trial["torque_of_sole"][:] + trial["torque_of_straps"][:]
            np.testing.assert_allclose(total, trial["machine_torque"][:], atol=1e-9)

    def test_a_passive_trial_that_is_not_and_a_wrong_sign_are_said(self):
        self.succeeds("data", "synthesize", "ankle_on_dynamometer", *SMALL, "--quiet", "--out", "ankle.h5")
        with h5py.File(self.path("ankle.h5"), "r+") as file:
            torque = file["trials/passive_60/machine/channels/machine_torque"]
            torque[:] = -torque[:]
            file["trials/active_060"].attrs["passive"] = 1.0
        said = self.run_program("simulate", "ankle_on_dynamometer", "--data", "ankle.h5", "--out", "predicted.h5")
        self.assertEqual(said.returncode, 0, said.stderr)
        said = " ".join((said.stdout + said.stderr).split())
        self.assertIn("is said to be passive, but the excitation of", said)
        self.assertIn("is the sign of machine_angle or of machine_torque wrong", said)

    def test_what_is_missing_is_one_line(self):
        self.succeeds("data", "synthesize", "ankle_on_dynamometer", *SMALL, "--quiet", "--out", "ankle.h5")
        with h5py.File(self.path("ankle.h5"), "r+") as file:
            del file["trials/active_060/excitations"]
        self.refuses("trial 'active_060' has no grid 'excitations'; a trial of a person who relaxes has the condition passive = 1",
                     "identify", "ankle_on_dynamometer", "--data", "ankle.h5", "--out", "run.h5")


if __name__ == "__main__":
    unittest.main()

"""What the ground has to do so that a whole body moves as recorded: `sinew data dynamics`, and the contact of steps
that are predicted by it.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_dynamics.py
"""
import json
import os
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import ROOT, ProgramTest

SHARED = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data"))
GAIT = SHARED / "gait_subject01"


class Dynamics(ProgramTest):
    def refused(self, change, message, *words):
        name = self.changed_stances(change)
        before = self.path(name).read_bytes()
        done = self.run_program("data", "dynamics", name, *words)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn(message, " ".join(done.stderr.split()))
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertEqual(self.path(name).read_bytes(), before)

    def test_adds_channels_to_every_trial(self):
        name = self.stances()
        said = json.loads(self.succeeds("data", "dynamics", name, "--json", "-"))
        self.assertEqual(len(said["whole_body"]), 5)
        for trial in said["whole_body"]:
            self.assertAlmostEqual(trial["mass_kg"], 5.8, delta=0.1)
            self.assertAlmostEqual(trial["mean_vertical_force_over_weight"], 1, delta=0.1)
        with h5py.File(self.path(name)) as file:
            channels = file["trials/train_1/dynamics/channels"]
            self.assertEqual(sorted(channels), sorted(f"{kind}_{axis}" for kind in
                             ("whole_body_load", "whole_body_torque", "mass_centre") for axis in "xyz"))
            self.assertEqual(channels["whole_body_load_x"].attrs["unit"], "N")

    def test_bad_input_is_one_line(self):
        def without(coordinate):
            def change(file):
                del file[f"trials/train_1/coordinates/channels/{coordinate}"]
            return change

        def in_mm(file):
            for axis in "xyz":
                file[f"trials/train_1/coordinates/channels/pelvis_t{axis}"][()] *= 1000

        def without_mass(file):
            text = file["files/model.osim"][()].decode()
            del file["files/model.osim"]
            while "<mass>" in text:
                start, rest = text.split("<mass>", 1)
                text = start + "<mass >0</mass>" + rest.split("</mass>", 1)[1]
            file["files/model.osim"] = text

        def no_coordinates(file):
            for trial in file["trials"].values():
                del trial["coordinates"]

        self.refused(without("pelvis_ty"), "trial 'train_1': no data for coordinate 'pelvis_ty', which moves 100 % of the")
        self.refused(in_mm, "m from the origin: are its coordinates in mm?")
        self.refused(without_mass, "have no mass")
        self.refused(no_coordinates, "run `sinew data kinematics` on markers first")
        self.refused(lambda file: None, "--cutoff -1: expected a frequency in Hz", "--cutoff", "-1")


@unittest.skipUnless(GAIT.is_dir(), f"{GAIT} is not there")
class MeasuredDynamics(ProgramTest):
    """A walking person on two plates."""

    def with_notes(self, *words):
        done = self.run_program(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def setUp(self):
        super().setUp()
        prefix = GAIT / "ExperimentalData_subject01_walk"
        self.with_notes("data", "import", f"{prefix}.trc", f"{prefix}_grf.mot", GAIT / "Gait10dof18musc_subject01.osim",
                        "--trial", "walk", "--out", "gait.h5", "--external-loads", f"{prefix}_grf.xml")
        self.succeeds("data", "kinematics", "gait.h5", "--weights", GAIT / "IK_walk_Setup_IK.xml", "--quiet")
        self.succeeds("data", "dynamics", "gait.h5")

    def test_plates_carry_what_the_body_needs(self):
        with h5py.File(self.path("gait.h5")) as file:
            walk = file["trials/walk"]
            time = walk["dynamics/time"][()]
            inside = (time > 0.62) & (time < 2.03)  # both plates carry all
            for axis, most in (("x", 20), ("y", 25)):
                body = walk[f"dynamics/channels/whole_body_load_{axis}"][()]
                plates = sum(np.interp(time, walk["forces/time"][()], walk[f"forces/channels/{foot}_force_{axis}"][()])
                             for foot in ("right", "left"))
                self.assertLess(np.sqrt(np.mean((body - plates)[inside] ** 2)), most, axis)

    def test_a_step_without_its_plate(self):
        for stance, window, plate, role in (("right_stance", "0.60:1.43", "right", "train"),
                                            ("left_stance", "1.23:2.04", "left", "validate")):
            self.succeeds("data", "cut", "gait.h5", "--trial", "walk", "--window", window, "--as", stance, "--plate",
                          plate, "--role", role)
        self.succeeds("data", "drop", "gait.h5", "--trial", "walk")
        self.with_notes("data", "soles", "gait.h5", "--out", "soles.yaml")
        result = json.loads(self.with_notes("identify", "contact", "--data", "gait.h5", "--config", "soles.yaml", "--solver",
                                            "continuation", "--intervals", "linear", "--out", "run.h5", "--json", "-"))
        errors = {other["prediction"]: {one["channel"]: one for one in other["fit"]} for other in result["alternatives"]}
        body = errors["from the motion of the whole body, in single support"]["left_force_y"]
        self.assertLess(body["rmse"], 0.03 * 72.6 * 9.81)
        self.assertGreater(body["band95_half_width"], 0)
        alone = errors["from the motion alone"]["left_force_y"]
        self.assertLess(alone["rmse"], alone["band95_half_width"])
        findings = " ".join(result["findings"])
        self.assertRegex(findings, r"predicted from the motion alone \d+ N \(95 % band \+-\d+ N\)")


if __name__ == "__main__":
    unittest.main()

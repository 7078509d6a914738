"""Measured and simulated ground reactions as OpenSim's external loads: `sinew data loads`.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_loads.py
"""
import json
import os
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import ROOT, ProgramTest

GAIT = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "gait_subject01"


def add_centres_of_pressure(file):
    for trial in ("train_1", "train_2"):
        forces = file[f"trials/{trial}/forces/channels"]
        side = "right" if "right_force_y" in forces else "left"
        for axis in "xz":
            forces[f"{side}_cop_{axis}"] = 0.1 + 0 * forces[f"{side}_force_y"][()]
            forces[f"{side}_cop_{axis}"].attrs.update({"unit": "m", "kind": "measured"})


class Loads(ProgramTest):
    def table(self, name):
        """Columns by name."""
        lines = self.path(name).read_text().splitlines()
        body = lines[lines.index("endheader") + 1:]
        rows = np.array([[float(word) for word in line.split()] for line in body[1:]])
        return dict(zip(body[0].split(), rows.T))

    @unittest.skipUnless(GAIT.exists(), "no shared data")
    def test_a_recording_is_written_as_it_was_read(self):
        forces = [str(GAIT / "ExperimentalData_subject01_walk_grf.mot"), "--external-loads",
                  str(GAIT / "ExperimentalData_subject01_walk_grf.xml")]
        self.run_program("data", "import", *forces, "--trial", "walk", "--out", "walk.h5")  # notes that times are rounded
        os.mkdir(self.path("opensim"))
        said = json.loads(self.succeeds("data", "loads", "walk.h5", "--out", "grf.mot", "--setup", "opensim/loads.xml",
                                        "--bodies", "right=calcn_r,left=calcn_l", "--json", "-"))
        self.assertEqual(said["instants"], 1501)
        self.assertIn("<datafile>../grf.mot</datafile>", self.path("opensim/loads.xml").read_text())
        self.succeeds("data", "import", "grf.mot", "--external-loads", "opensim/loads.xml", "--trial", "walk",
                      "--out", "again.h5")
        with h5py.File(self.path("walk.h5")) as first, h5py.File(self.path("again.h5")) as second:
            first, second = first["trials/walk/forces/channels"], second["trials/walk/forces/channels"]
            self.assertEqual(sorted(first), sorted(second))
            for name in first:
                np.testing.assert_allclose(second[name][()], first[name][()], rtol=0, atol=1e-6, err_msg=name)
                self.assertEqual(second[name].attrs["unit"], first[name].attrs["unit"])

    def test_what_was_measured_counts_before_what_was_simulated(self):
        self.changed_stances(add_centres_of_pressure)
        self.succeeds("simulate", "contact", "--data", "stances.h5", "--out", "simulated.h5")
        for name, files in (("measured", ["stances.h5"]), ("simulated", ["simulated.h5"]),
                            ("both", ["stances.h5", "simulated.h5"])):
            self.succeeds("data", "loads", *files, "--trial", "train_1", "--out", f"{name}.mot", "--rate", 100)
        measured, simulated, both = (self.table(f"{name}.mot") for name in ("measured", "simulated", "both"))
        loaded = measured["right_ground_force_vy"] > 0.02 * max(max(measured["right_ground_force_vy"]),
                                                                max(simulated["right_ground_force_vy"]))
        self.assertGreater(np.count_nonzero(loaded), 10)
        for column in ("vx", "vy", "vz", "px", "pz"):
            column = f"right_ground_force_{column}"
            np.testing.assert_array_equal(both[column][loaded], measured[column][loaded])
        self.assertGreater(max(abs(simulated["right_ground_force_vy"] - measured["right_ground_force_vy"])), 1)

        def unmeasured(file):
            add_centres_of_pressure(file)
            channels = file["trials/train_1/forces/channels"]
            for name in channels:
                channels[name][()] = np.nan

        said = json.loads(self.succeeds("data", "loads", self.changed_stances(unmeasured, "without.h5"), "simulated.h5",
                                        "--trial", "train_1", "--out", "filled.mot", "--rate", 100, "--json", "-"))
        self.assertEqual({span["trial"] for span in said["spans"]}, {"simulated.h5: train_1"})
        self.assertEqual(said["gaps"], [])
        np.testing.assert_array_equal(self.table("filled.mot")["right_ground_force_vy"], simulated["right_ground_force_vy"])

    def test_a_step_that_nothing_tells_is_said(self):
        self.changed_stances(add_centres_of_pressure)
        for name, window in (("first", "0:0.2"), ("second", "0.3:0.5")):
            self.succeeds("data", "cut", "stances.h5", "--trial", "train_1", "--window", window, "--as", name)
        with h5py.File(self.path("stances.h5"), "r+") as file:
            for values in file["trials/second/forces/channels"].values():
                values[()] = np.nan
        done = self.run_program("data", "loads", "stances.h5", "--trial", "first,second", "--out", "a.mot", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("trial 'second' does not know the force, and no other trial does: written as zero", " ".join(done.stderr.split()))
        gap, = json.loads(done.stdout)["gaps"]
        self.assertEqual((gap["plate"], gap["trial"]), ("right", "second"))
        self.assertAlmostEqual(gap["from_s"], 0.3, delta=1 / 60)

    def test_a_step_has_the_times_of_its_recording(self):
        self.changed_stances(add_centres_of_pressure)
        self.succeeds("data", "cut", "stances.h5", "--trial", "train_1", "--window", "0.1:0.3", "--as", "step")
        self.refuses("of two recordings ('train_1', 'train_2')", "data", "loads", "stances.h5", "--out", "a.mot", "--trial",
                     "step,train_2")
        said = json.loads(self.succeeds("data", "loads", "stances.h5", "--out", "a.mot", "--recording", "train_1", "--trial",
                                        "step", "--setup", "a.xml", "--json", "-"))
        self.assertAlmostEqual(said["from_s"], 0.1, delta=1 / 60)
        self.assertAlmostEqual(said["to_s"], 0.3, delta=1 / 60)
        self.assertIn("<applied_to_body>calcn_r</applied_to_body>", self.path("a.xml").read_text())

    def test_bad_input_is_one_line(self):
        def change(file):
            add_centres_of_pressure(file)
            del file["files/contact.yaml"]

        self.changed_stances(change)
        for message, words in (
                ("--setup: on which body plate 'right' acts is not known: give it as --bodies right=BODY", ["--setup", "a.xml"]),
                ("expected PLATE=BODY", ["--setup", "a.xml", "--bodies", "right"]),
                ("no trial has a plate 'rigth'; expected one of right", ["--setup", "a.xml", "--bodies", "rigth=calcn_r"]),
                ("--bodies: only --setup names bodies", ["--bodies", "right=calcn_r"]),
                ("stances.h5 holds no such trial; did you mean 'train_1'?", ["--trial", "trian_1"]),
                ("expected at most 2e+07", ["--rate", "1e12"]),
                ("has right_force_y without right_cop_x", ["--trial", "train_3"])):
            trial = [] if "--trial" in words else ["--trial", "train_1"]
            self.refuses(message, "data", "loads", "stances.h5", "--out", "a.mot", *trial, *words)


if __name__ == "__main__":
    unittest.main()

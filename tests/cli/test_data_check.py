"""sinew data check and stances: what is found, masked and said.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_data_check.py
"""
import json
import os
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import ROOT, ProgramTest

SHARED = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data"))
DRIVE = ROOT / "datasets" / "data" / "knee_drive.h5"
POSITION = "trials/train_2/joint/channels/position"


class DataCheck(ProgramTest):
    def drive(self, change=None, name="drive.h5"):
        self.path(name).write_bytes(DRIVE.read_bytes())
        if change:
            with h5py.File(self.path(name), "r+") as file:
                change(file)
        return name

    def findings(self, *words):
        return json.loads(self.succeeds("data", "check", *words, "--json", "-"))["findings"]

    @staticmethod
    def drop_out(file):
        values = file[POSITION][()]
        # Far from 0, and short against the trial.
        at = int(np.argmax(np.abs(values)))
        values[at - 4:at + 4] = 0
        file[POSITION][...] = values

    def test_the_examples_of_the_program_have_no_remark(self):
        for name in ("knee_drive", "nao_stance", "ankle_study"):
            said = self.succeeds("data", "check", ROOT / "datasets" / "data" / f"{name}.h5")
            self.assertRegex(said, r": \d+ trials, \d+ channels: nothing found\n", name)

    def test_a_dropout_is_said_masked_and_remembered(self):
        name = self.drive(self.drop_out)
        found = self.findings(name)
        self.assertEqual([(f["kind"], f["trial"], f["channel"]) for f in found], [("dropout", "train_2", "position")])
        self.assertIn("drops out once", found[0]["sentence"])
        self.assertEqual([m["channel"] for m in found[0]["mask"]], ["position"])
        self.assertEqual(len(self.findings(name, "drive")), 1)
        self.succeeds("identify", "drive", "--data", name, "--out", "before.h5", "--intervals", "linear", "--quiet", "--json", "before.json")
        warnings = " ".join(map(str, json.loads(self.path("before.json").read_text())["warnings"]))
        self.assertIn("position in trial 'train_2' drops out", warnings)
        said = self.succeeds("data", "check", name, "--mask", "auto", "--out", "masked.h5")
        self.assertIn("(8 values are gaps now)", " ".join(said.split()))
        with h5py.File(self.path("masked.h5")) as file:
            self.assertEqual(int(np.isnan(file[POSITION][()]).sum()), 8)
            self.assertIn("reason: dropout", file["files/mask.yaml"][()].decode())
        self.assertEqual(self.findings("masked.h5"), [])
        self.assertIn("masked: 1 span of position in trial 'train_2'", self.succeeds("data", "info", "masked.h5"))
        self.succeeds("identify", "drive", "--data", "masked.h5", "--out", "run.h5", "--intervals", "linear", "--quiet", "--json", "run.json")
        warnings = " ".join(map(str, json.loads(self.path("run.json").read_text())["warnings"]))
        self.assertIn("the data were masked before: 1 span of position", warnings)

    def test_a_joint_that_moves_against_its_input_is_a_note_of_the_problem(self):
        def turn_round(file):
            for trial in file["trials"].values():
                torque = trial["joint/channels/torque"]
                torque[...] = -torque[()]

        name = self.drive(turn_round)
        self.assertNotIn("notes", json.loads(self.succeeds("data", "check", name, "--json", "-")))
        self.assertEqual(json.loads(self.succeeds("data", "check", DRIVE, "drive", "--json", "-"))["notes"], [])
        self.assertIn("nothing found", self.succeeds("data", "check", DRIVE, "drive"))
        found = json.loads(self.succeeds("data", "check", name, "drive", "--json", "-"))
        self.assertEqual(found["findings"], [])
        self.assertEqual(len(found["notes"]), 1)
        self.assertIn("moves against 'torque'", found["notes"][0])
        said = " ".join(self.succeeds("data", "check", name, "drive").split())
        self.assertIn("no finding, 1 note of drive note: the joint moves against 'torque'", said)
        self.succeeds("identify", "drive", "--data", name, "--out", "run.h5", "--max-evaluations", "50", "--intervals", "linear", "--quiet", "--json", "run.json")
        self.assertIn("moves against 'torque'", json.dumps(json.loads(self.path("run.json").read_text())["warnings"]))

    def test_data_of_which_nothing_is_left(self):
        def forget(file):
            for trial in file["trials"].values():
                if trial.attrs["role"] in ("train", b"train"):
                    values = trial["joint/channels/position"]
                    values[...] = np.full(len(values), np.nan)

        name = self.drive(forget)
        done = self.run_program("data", "check", name)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("no usable data", done.stderr)
        before = self.path(name).read_bytes()
        self.assertEqual(self.run_program("data", "check", name, "--mask", "auto").returncode, 1)
        self.assertEqual(self.path(name).read_bytes(), before)

    def write(self, name, trials):
        """trials: {trial: {grid: (times, {channel: (values, unit, kind)})}}."""
        with h5py.File(self.path(name), "w") as file:
            file.attrs["sinew_schema"] = "dataset/1"
            for trial, grids in trials.items():
                group = file.create_group(f"trials/{trial}")
                group.attrs["role"] = "train"
                for grid, (times, channels) in grids.items():
                    group[f"{grid}/time"] = times
                    for channel, (values, unit, kind) in channels.items():
                        made = group.create_dataset(f"{grid}/channels/{channel}", data=values)
                        made.attrs["unit"], made.attrs["kind"] = unit, kind
        return name

    def test_a_device_that_is_late_in_one_recording(self):
        times = np.arange(0, 30, 0.01)

        def recording(period, delay):
            def shape(c, k):
                p = 2 * np.pi * times / period
                return np.sin(p + c) + 0.5 * np.sin(2 * p + 2 * c + k) + 0.01 * np.sin(37 * times + c)

            return {name: (times + (delay if name == "forces" else 0), {f"{name}_{c}": (shape(c, k), unit, "measured") for c in range(3)})
                    for k, (name, unit) in enumerate((("angles", "rad"), ("moments", "N*m"), ("forces", "N")))}

        name = self.write("late.h5", {"a": recording(1.15, 0.15), "b": recording(1.06, 0)})
        found = self.findings(name)
        self.assertEqual([(f["kind"], f["grid"], f["channel"], f["mask"]) for f in found], [("lag", "forces", "", [])])
        self.assertIn("All of grid 'forces' in trial 'a' is out of step with trial 'b'", found[0]["sentence"])
        self.assertEqual(self.findings(self.write("fine.h5", {"a": recording(1.15, 0), "b": recording(1.06, 0)})), [])

    def test_a_quaternion_and_an_input_that_contradict_the_rest(self):
        times = np.arange(0, 1, 0.01)

        def toss(k):
            half = 2 * times + k
            parts = {"w": np.cos(half), "x": 0.6 * np.sin(half), "y": 0.8 * np.sin(half), "z": 0 * half}
            command = k + (k + 1) * (np.sin(7 * times * times) + 0.3 * np.sin(20 * times))
            return {"pose": (times, {**{f"orientation_{c}": (v, "1", "measured") for c, v in parts.items()},
                                     "command": (command, "V", "input")})}

        trials = {f"toss_{k}": toss(k) for k in range(4)}
        self.assertEqual(self.findings(self.write("fine.h5", trials)), [])
        trials["toss_1"]["pose"][1]["orientation_x"][0][30:60] *= 0.3
        trials["toss_2"]["pose"][1]["command"][0][40:60] += 3 * np.sin(np.pi * np.arange(20) / 20) ** 2
        found = {(f["kind"], f["trial"]): f["sentence"] for f in self.findings(self.write("wrong.h5", trials))}
        self.assertIn("are no rotation: their norm differs from 1", found["inconsistent", "toss_1"])
        self.assertIn("Command in trial 'toss_2' differs by up to", found["displaced", "toss_2"])
        self.assertIn("which it repeats elsewhere", found["displaced", "toss_2"])

    def test_wrong_words(self):
        name = self.drive()
        self.fails("--mask all: expected auto", "data", "check", name, "--mask", "all")
        self.fails("--out: nothing is written without --mask auto", "data", "check", name, "--out", "o.h5")
        self.refuses("did you mean 'drive'", "data", "check", name, "drve")
        self.refuses("has a plate", "data", "stances", name)


@unittest.skipUnless((SHARED / "gait_walk3d").is_dir(), f"{SHARED / 'gait_walk3d'} is not there")
class Stances(ProgramTest):
    def test_stances_of_a_walk_over_two_plates(self):
        folder = SHARED / "gait_walk3d"
        done = self.run_program("data", "import", folder / "grf_walk.mot", "--external-loads", folder / "grf_walk.xml", "--trial", "walk",
                                "--out", "walk.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(self.succeeds("data", "stances", "walk.h5", "--drop", "--json", "-"))["trials"][0]
        read_by_eye = [("Right_GRF", 0.266, 1.024), ("Left_GRF", 0.836, 1.590), ("Right_GRF", 1.411, 2.168)]
        self.assertEqual([c["plate"] for c in found["contacts"]], [plate for plate, _, _ in read_by_eye])
        for contact, (_, first, last) in zip(found["contacts"], read_by_eye):
            self.assertAlmostEqual(contact["from_s"], first, delta=0.008)
            self.assertAlmostEqual(contact["to_s"], last, delta=0.008)
        self.assertEqual([c["role"] for c in found["contacts"]], ["train", "train", "validate"])
        self.assertEqual({p["plate"]: p["places"] for p in found["plates"]}, {"Left_GRF": 1, "Right_GRF": 2})
        with h5py.File(self.path("walk.h5")) as file:
            self.assertEqual(sorted(file["trials"]), ["walk_Left_GRF_1", "walk_Right_GRF_1", "walk_Right_GRF_2"])


if __name__ == "__main__":
    unittest.main()

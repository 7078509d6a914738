"""Steps that no plate measured: `sinew data steps`, and what `identify` and `simulate` predict of them.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_steps.py
"""
import json
import os
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import ROOT, ProgramTest

SHARED = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data"))
GAIT = SHARED / "gait_walk3d"
PERIOD = 1.2  # s


def add_walk(file, lean=0.0, plate=None):
    """The recording 'walk': legs that swing against each other as pendulums, while the body goes along a line that is turned
    by `lean` rad. No plate, or one under the right foot between these times."""
    time = np.arange(0, 6 * PERIOD + 0.3, 0.01)
    source = file["trials/train_1/coordinates/channels"]
    walk = file.create_group("trials/walk")
    walk.attrs["role"] = "train"
    grid = walk.create_group("coordinates")
    grid["time"] = time
    swing = 0.35 * np.cos(2 * np.pi * time / PERIOD)
    moving = {"pelvis_tx": 0.4 * np.cos(lean) * time, "pelvis_tz": -0.4 * np.sin(lean) * time, "pelvis_rotation": 0 * time + lean,
              "hip_flexion_r": swing, "hip_flexion_l": -swing}
    for name in source:
        values = moving.get(name, np.zeros(len(time)) if name.startswith(("knee", "ankle", "hip")) else source[name][0] + 0 * time)
        grid[f"channels/{name}"] = values
        for key, value in source[name].attrs.items():
            grid[f"channels/{name}"].attrs[key] = value
    if plate:
        forces = walk.create_group("forces")
        forces["time"] = time
        forces["channels/right_force_y"] = np.where((time > plate[0]) & (time < plate[1]), 50.0, 0.0)
        forces["channels/right_force_y"].attrs.update({"unit": "N", "kind": "measured"})


class Steps(ProgramTest):
    def walk(self, **how):
        def change(file):
            add_walk(file, **how)
        return self.changed_stances(change)

    def found(self, name, *words):
        return json.loads(self.succeeds("data", "steps", name, "--trial", "walk", "--list", "--json", "-", *words))

    def test_a_foot_lands_farthest_ahead_and_leaves_farthest_behind(self):
        for lean in (0.0, 2.0):
            found = self.found(self.walk(lean=lean))
            steps = found["trials"][0]["steps"]
            # The right leg is farthest ahead at whole periods, behind half a period later. Delays come from other trials.
            begin, end = found["begin_delay"]["mean_s"] or 0, found["end_delay"]["mean_s"] or 0
            right = [(s["from_s"] - begin, s["to_s"] - end) for s in steps if s["plate"] == "right"]
            left = [(s["from_s"] - begin, s["to_s"] - end) for s in steps if s["plate"] == "left"]
            self.assertEqual((len(right), len(left)), (5, 6))
            for i, (lands, leaves) in enumerate(right):
                self.assertAlmostEqual(lands, (i + 1) * PERIOD, delta=0.003)
                self.assertAlmostEqual(leaves, (i + 1.5) * PERIOD, delta=0.003)
            for i, (lands, leaves) in enumerate(left):
                self.assertAlmostEqual(lands, (i + 0.5) * PERIOD, delta=0.003)
                self.assertAlmostEqual(leaves, (i + 1) * PERIOD, delta=0.003)

    def test_steps_on_a_plate_are_left_to_it(self):
        name = self.walk(plate=(1.3, 1.7))
        found = self.found(name)["trials"][0]
        self.assertEqual(found["on_a_plate"], 1)
        self.assertEqual(len([s for s in found["steps"] if s["plate"] == "right"]), 4)

    def test_they_become_trials(self):
        name = self.walk()
        text = self.succeeds("data", "steps", name, "--drop")
        self.assertIn("walk_right_1", text)
        with h5py.File(self.path(name)) as file:
            self.assertNotIn("walk", file["trials"])
            step = file["trials/walk_left_6"]
            self.assertEqual(step.attrs["role"], "validate")
            plate = step["plates"]
            self.assertEqual(sorted(plate["channels"]), sorted(f"left_{kind}" for kind in (
                "force_x", "force_y", "force_z", "cop_x", "cop_z", "moment_y")))
            self.assertTrue(np.isnan(plate["channels/left_force_y"][()]).all())
            self.assertGreater(step["coordinates/time"][-1], plate["time"][-1] + 0.2)
        check = json.loads(self.run_program("data", "check", name, "--json", "-").stdout)
        self.assertNotIn("plates", {finding["grid"] for finding in check["findings"]})

    def test_bad_input_is_one_line(self):
        name = self.walk()
        self.refuses("trial 'wlak' does not exist; expected one of train_1, train_2, train_3, validate_1, validate_2, walk", "data", "steps", name, "--trial", "wlak")
        self.refuses("--list: nothing is written with it", "data", "steps", name, "--list", "--drop")
        self.write("nothing.yaml", "drive: {}\n")
        self.refuses("contact", "data", "steps", name, "--config", "nothing.yaml")
        self.refuses("no trial holds coordinates and is no step already", "data", "steps", self.changed_stances(
            lambda file: [trial["coordinates"].name and file.move(trial["coordinates"].name, trial.name + "/other")
                          for trial in file["trials"].values()]))
        standing = self.changed_stances(lambda file: add_walk(file), "standing.h5")
        with h5py.File(self.path(standing), "r+") as file:
            for side in "rl":
                file[f"trials/walk/coordinates/channels/hip_flexion_{side}"][()] *= 0.01
        done = self.run_program("data", "steps", standing, "--trial", "walk")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no step without a plate was found", done.stderr)


@unittest.skipUnless(GAIT.is_dir(), f"{GAIT} is not there")
class MeasuredSteps(ProgramTest):
    """A person who walks over three plates, recorded twice: once with them, once as if there were none."""

    def with_notes(self, *words):
        done = self.run_program(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_forces_are_predicted_where_no_plate_was(self):
        markers, model = GAIT / "markers_walk.trc", GAIT / "subject_walk_scaled.osim"
        self.with_notes("data", "import", markers, GAIT / "grf_walk.mot", model, "--external-loads", GAIT / "grf_walk.xml", "--trial",
                        "walk", "--out", "walk.h5")
        self.with_notes("data", "import", markers, "--trial", "free", "--append", "--out", "walk.h5")
        self.with_notes("data", "kinematics", "walk.h5", "--weights", GAIT / "ik_tasks_walk.xml", "--quiet")
        self.with_notes("data", "dynamics", "walk.h5")
        self.with_notes("data", "stances", "walk.h5", "--trial", "walk", "--drop")
        self.with_notes("data", "soles", "walk.h5", "--out", "soles.yaml")
        plates = {}
        with h5py.File(self.path("walk.h5"), "r+") as file:
            for name in ("walk_Right_GRF_2", "walk_Left_GRF_1"):  # known to this test alone
                forces = file[f"trials/{name}/forces"]
                plates[name.replace("walk", "free")] = (forces["time"][()], {c: forces["channels"][c][()] for c in forces["channels"]})
                del file[f"trials/{name}"]
        self.with_notes("data", "steps", "walk.h5", "--config", "soles.yaml", "--drop")
        result = json.loads(self.with_notes("identify", "contact", "--data", "walk.h5", "--config", "soles.yaml", "--solver",
                                            "continuation", "--intervals", "linear", "--out", "run.h5", "--json", "-"))
        said = {(one["trial"], one["channel"]): one for one in result["unmeasured"]}
        self.assertIn("free_Left_GRF_1, not measured, from the motion of the whole body: ", " ".join(result["findings"]))
        weight = 85.3 * 9.81
        self.with_notes("simulate", "contact", "--data", "walk.h5", "--config", "soles.yaml", "--from", "run.h5", "--out", "sim.h5", "--quiet")
        with h5py.File(self.path("run.h5")) as run, h5py.File(self.path("sim.h5")) as simulated:
            for trial, (time, channels) in plates.items():
                # Three frames beyond the plate's are enough to see that a step begins and ends when it does.
                for channel, most in (("force_y", 0.04), ("force_x", 0.025), ("force_z", 0.02)):
                    name = trial[5:-1] + channel
                    node = run[f"prediction/{trial}/{name}"]
                    frames = node["time"][()]
                    half = np.median(np.diff(frames)) / 2
                    measured = np.array([np.mean(channels[name][abs(time - t) < half]) if any(abs(time - t) < half) else 0 for t in frames])
                    error = node["simulated"][()] - measured
                    self.assertLess(np.sqrt(np.mean(error ** 2)), most * weight, name)
                    self.assertGreater(np.mean(abs(error) < node["band95_half_width"][()]), 0.8, name)
                    self.assertEqual(said[trial, name]["from"], "the motion of the whole body")
                    self.assertEqual(node.attrs["role"], "predicted")
                    again = simulated[f"trials/{trial}/simulated/channels"]
                    np.testing.assert_array_equal(again[name][()], node["simulated"][()])
                    np.testing.assert_array_equal(again[name + "_band95"][()], node["band95_half_width"][()])


if __name__ == "__main__":
    unittest.main()

"""A linear axis in closed loop whose position and force are measured and compared.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_controlled_axis.py
"""
import json
import shutil
import unittest

import h5py
import numpy as np

from controlled_axis import MASS, VISCOUS, write_axis
from program import ROOT, ProgramTest, differences


class ForceIsCompared(ProgramTest):
    """The sensor of the force has the same name as the model's force at which unknown terms act."""

    def test_diagnose_tells_both_apart(self):
        write_axis(self.path("axis.h5"), coulomb=1.5)
        self.succeeds("diagnose", "drive", "--data", "axis.h5", "--out", "why.h5", "--json", "why.json", "--quiet")
        result = json.loads(self.path("why.json").read_text())
        scored = [score["effect"] for score in result["scores"]]
        self.assertEqual(len(scored), len(set(scored)))
        self.assertLessEqual({"force(time)", "force_reading(time)", "force_reading(position)", "position(time)"}, set(scored))
        self.assertEqual([cause["effect"] for cause in result["causes"]], ["coulomb_friction"])
        found = {p["name"]: p for p in result["extended_parameters"]}
        for name, true in (("inertia", MASS), ("viscous_friction", VISCOUS), ("coulomb_torque", 1.5)):
            self.assertAlmostEqual(found[name]["value"], true, delta=4 * found[name]["std_error"], msg=name)

    def test_effects_are_released(self):
        write_axis(self.path("axis.h5"), coulomb=1.5)
        self.succeeds("identify", "drive", "--data", "axis.h5", "--release", "coulomb_friction", "--out", "run.h5",
                      "--json", "run.json", "--quiet")
        found = {p["name"]: p for p in json.loads(self.path("run.json").read_text())["parameters"]}
        self.assertAlmostEqual(found["coulomb_torque"]["value"], 1.5, delta=4 * found["coulomb_torque"]["std_error"])
        for term in ("force(time)", "force_reading(time)"):
            self.succeeds("identify", "drive", "--data", "axis.h5", "--release", term, "--out", "run.h5", "--json", "run.json",
                          "--quiet")
            names = [p["name"] for p in json.loads(self.path("run.json").read_text())["parameters"]]
            self.assertEqual(sum(name.startswith(term + "[") for name in names), 8)


class OffsetsOfOneKind(ProgramTest):
    """Offsets of the reference, of the drive's force and of the position are one and the same in closed loop."""

    def test_none_of_them_is_ruled_out_beside_another(self):
        write_axis(self.path("axis.h5"), fit="position", reference_offset=0.003, coulomb=2.0)
        self.succeeds("diagnose", "drive", "--data", "axis.h5", "--out", "why.h5", "--json", "why.json", "--quiet")
        result = json.loads(self.path("why.json").read_text())
        stated = {cause["effect"] for cause in result["causes"]} | {other["effect"] for other in result["alternatives"]}
        self.assertLessEqual({"reference.offset", "torque_offset", "position.offset"}, stated)
        self.assertEqual(result["verdict"], "ambiguous")


class ValidationTrialsOnly(ProgramTest):
    def test_a_run_is_simulated_on_them(self):
        write_axis(self.path("axis.h5"), fit="position")
        self.succeeds("identify", "drive", "--data", "axis.h5", "--out", "run.h5", "--quiet")
        with h5py.File(self.path("axis.h5"), "r+") as file:
            for name in list(file["trials"]):
                if name.startswith("train"):
                    del file["trials"][name]
        done = self.run_program("simulate", "drive", "--data", "axis.h5", "--from", "run.h5", "--out", "sim.h5")
        self.assertEqual((done.returncode, done.stderr.replace("\n  ", " ")),
                         (0, "note: 6 nuisance values of run.h5 belong to trials that these data do not have\n"))
        with h5py.File(self.path("sim.h5")) as sim, h5py.File(self.path("run.h5")) as run:
            self.assertEqual(sorted(sim["trials"]), ["validate_4", "validate_5"])
            for trial in sim["trials"]:
                self.assertEqual(sim["trials"][trial].attrs["role"], "validate")
                # The step of the integration is chosen at other starts.
                np.testing.assert_allclose(sim[f"trials/{trial}/simulated/channels/position"],
                                           run[f"prediction/{trial}/position/simulated"], atol=1e-6)

    def test_every_problem_predicts_them_as_among_training_trials(self):
        shutil.copy(ROOT / "datasets" / "data" / "ankle_study.h5", self.path("nms.h5"))
        self.stances("contact.h5")
        self.succeeds("data", "synthesize", "free_body", "--set", "train=2", "validate=1", "--out", "free_body.h5", "--quiet")
        for problem in ("nms", "contact", "free_body"):
            data = f"{problem}.h5"
            self.succeeds("identify", problem, "--data", data, "--out", "run.h5", "--intervals", "linear", "--quiet")
            self.succeeds("simulate", problem, "--data", data, "--from", "run.h5", "--out", "all.h5")
            with h5py.File(self.path(data), "r+") as file:
                for name in [name for name, trial in file["trials"].items() if trial.attrs["role"] != "validate"]:
                    del file["trials"][name]
            self.assertEqual(self.run_program("simulate", problem, "--data", data, "--from", "run.h5", "--out", "sim.h5").returncode, 0)
            with h5py.File(self.path("all.h5")) as everything, h5py.File(self.path("sim.h5")) as sim:
                self.assertGreater(len(sim["trials"]), 0)
                for trial in sim["trials"]:
                    self.assertEqual(differences(everything[f"trials/{trial}"], sim[f"trials/{trial}"]), [], (problem, trial))

    def test_a_fit_of_them_is_refused(self):
        write_axis(self.path("axis.h5"), fit="position", train=0)
        for command, *words in (["identify"], ["diagnose"], ["compare", "--solvers", "lm"]):
            self.fails("axis.h5: no trial with the role train has a channel that is compared: nothing to fit", command,
                       "drive", "--data", "axis.h5", "--out", "run.h5", *words)


if __name__ == "__main__":
    unittest.main()

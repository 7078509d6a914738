"""The way from data to an answer, and what the program says to machines.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_workflow.py
"""
import json
import unittest

import h5py
import numpy as np

from program import ProgramTest

TRUE_STIFFNESS = 9.0e5  # [N/m3] default of `data synthesize contact`
MODEL_DIFFERENCE = 0.02  # the truth has a finer mesh and motion than the fitted model; measured: 0.1 %

CLOCK = 1e-9  # [s] times are rounded

RUN_KEYS = {"problem", "solver", "stop_reason", "evaluations", "seconds", "cost", "parameters", "fit", "warnings"}
PARAMETER_KEYS = {"name", "value", "unit", "lower", "upper", "std_error", "ci95", "verdict", "reason"}
FIT_KEYS = {"trial", "role", "channel", "unit", "rmse", "r2", "n"}
VERDICTS = {"identifiable", "weak", "not_identifiable", "at_bound"}
STUDY_KEYS = {"problem", "best_cost", "target", "solvers"}
SOLVER_KEYS = {"solver", "repeats", "successes", "cost_median", "cost_worst", "evaluations", "evaluations_to_target",
               "seconds", "seconds_to_target", "parameters"}


class Workflow(ProgramTest):
    def test_from_markers_to_a_report(self):
        said = self.succeeds("data", "synthesize", "contact", "--out", "data.h5", "--seed", 4)
        self.assertEqual(said, "data.h5: 5 trials, synthetic (a small humanoid robot stepping)\n")
        said = self.succeeds("data", "kinematics", "data.h5", "--quiet")
        self.assertRegex(said, r"train_1: \d+ frames, 38 markers: 0\.\d+ mm RMS, 0\.\d+ mm at most "
                               r"\(\w+ at [\d.]+ s, frame \d+\)\n  \d+ of \d+ starts end at the lowest cost\n")

        said = self.succeeds("identify", "contact", "--data", "data.h5", "--out", "run.h5", "--json", "run.json")
        self.assertIn("identify contact on data.h5 (synthetic, 3 train + 2 validate trials)\n", said)
        facts = json.loads(self.path("run.json").read_text())["finding_facts"]
        self.assertIn({"kind": "identifiable", "about": ["stiffness"], "step": ""}, facts)
        self.assertIn({"kind": "not_identifiable", "about": ["static_friction", "dynamic_friction", "viscous_friction"],
                       "step": ""}, facts)
        with h5py.File(self.path("run.h5")) as run:
            values = dict(zip(run["parameters/name"].asstr()[()], run["parameters/value"][()]))
            self.assertEqual(run["run"].attrs["finished"], 1)
        self.assertAlmostEqual(values["stiffness"] / TRUE_STIFFNESS, 1, delta=MODEL_DIFFERENCE)

        said = self.succeeds("simulate", "contact", "--data", "data.h5", "--from", "run.h5", "--out", "sim.h5")
        self.assertIn("right_force_y", said)
        with h5py.File(self.path("sim.h5")) as sim, h5py.File(self.path("run.h5")) as run:
            simulated, predicted = sim["trials/validate_2/simulated"], run["prediction/validate_2/right_force_y"]
            both = np.isin(simulated["time"], predicted["time"])  # it reaches further, for sensors that may be late
            np.testing.assert_array_equal(simulated["channels/right_force_y"][both], predicted["simulated"])
        self.succeeds("data", "info", "sim.h5")

        said = self.succeeds("compare", "contact", "--data", "data.h5", "--solvers", "ceres,sa", "--repeats", 2,
                             "--max-evaluations", 300, "--out", "study.h5")
        self.assertIn("Study file: study.h5\n", said)

        said = self.succeeds("report", "run.h5", "study.h5", "--out-dir", "report")
        self.assertEqual(said, "Report: report/index.html\n")
        page = self.path("report/index.html").read_text()
        self.assertIn("stiffness", page)
        self.assertTrue(json.loads(self.path("report/index.ipynb").read_text())["cells"])

    def test_storage_files_of_a_simulation(self):
        self.stances()
        said = self.succeeds("simulate", "contact", "--data", "stances.h5", "--out", "sim.sto")
        self.assertTrue(said.startswith("sim_train_1.sto\nsim_train_2.sto\n"))
        done = self.run_program("data", "import", "sim_train_1.sto", "--out", "back.h5")
        self.assertEqual(done.returncode, 0)
        self.assertIn("note: sim_train_1.sto: has no unit for", done.stderr)
        self.assertIn("right_force_y", self.succeeds("data", "info", "back.h5", "--json"))

    def test_cut_and_drop(self):
        self.stances()
        self.succeeds("data", "cut", "stances.h5", "--trial", "train_1", "--window", "0.1:0.4", "--as", "part",
                      "--role", "validate", "--plate", "right")
        self.succeeds("data", "drop", "stances.h5", "--trial", "train_1")
        trials = json.loads(self.succeeds("data", "info", "stances.h5", "--json"))["trials"]
        self.assertEqual(sorted(trials), ["part", "train_2", "train_3", "validate_1", "validate_2"])
        self.assertEqual(trials["part"]["role"], "validate")
        self.assertGreaterEqual(trials["part"]["grids"]["forces"]["first_s"], 0.1 - CLOCK)
        self.assertLess(trials["part"]["grids"]["coordinates"]["first_s"], 0.1)  # a margin for the splines

    def test_import_with_a_map(self):
        self.write("bench.csv", "t,qm,tau\n0,0,2\n10,90,3\n20,180,4\n")
        self.write("map.yaml", "title: a bench\ntime: {column: t, unit: ms}\n"
                               "channels:\n"
                               "  position: {column: qm, unit: deg, sigma: 0.1}\n"
                               "  torque: {column: tau, unit: N*m, kind: input, scale: -1}\n"
                               "constants: {gear_ratio: {value: 120, unit: \"1\"}}\n"
                               "conditions: {speed_rad_per_s: 0.52}\n")
        self.succeeds("data", "import", "bench.csv", "--map", "map.yaml", "--trial", "slow", "--role", "validate",
                      "--out", "bench.h5")
        with h5py.File(self.path("bench.h5")) as file:
            self.assertEqual(file.attrs["title"], "a bench")
            trial = file["trials/slow"]
            self.assertEqual((trial.attrs["role"], trial.attrs["speed_rad_per_s"]), ("validate", 0.52))
            grid = trial["bench"]
            np.testing.assert_allclose(grid["time"], [0, 0.01, 0.02], rtol=1e-15)
            position, torque = grid["channels/position"], grid["channels/torque"]
            np.testing.assert_allclose(position, [0, np.pi / 2, np.pi], rtol=1e-15)
            self.assertEqual((position.attrs["unit"], position.attrs["kind"]), ("rad", "measured"))
            self.assertAlmostEqual(position.attrs["sigma"], np.radians(0.1), delta=1e-15)
            np.testing.assert_array_equal(torque, [-2, -3, -4])
            self.assertEqual(torque.attrs["kind"], "input")
            self.assertEqual(file["constants/gear_ratio"][()], 120)


class Machines(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def test_json_of_identify(self):
        text = self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--json", "-")
        result = json.loads(text)  # and so it is the only thing on standard output
        self.assertEqual(result["schema"], "sinew.run/1")
        self.assertLessEqual(RUN_KEYS, set(result))
        self.assertEqual(len(result["parameters"]), 5)
        for parameter in result["parameters"]:
            self.assertLessEqual(PARAMETER_KEYS, set(parameter))
            self.assertIn(parameter["verdict"], VERDICTS)
        self.assertEqual({entry["trial"] for entry in result["fit"]},
                         {"train_1", "train_2", "train_3", "validate_1", "validate_2"})
        for entry in result["fit"]:
            self.assertLessEqual(FIT_KEYS, set(entry))
            self.assertIn(entry["role"], ("train", "validate", "predicted"))
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--json", "run.json")
        written = json.loads(self.path("run.json").read_text())
        for seconds in (result, written):
            del seconds["seconds"]
        self.assertEqual(written, result)

    def test_json_of_compare(self):
        text = self.succeeds("compare", "contact", "--data", "stances.h5", "--solvers", "ceres,sa", "--repeats", 2,
                             "--max-evaluations", 300, "--out", "study.h5", "--json", "-")
        study = json.loads(text)
        self.assertEqual(study["schema"], "sinew.study/1")
        self.assertLessEqual(STUDY_KEYS, set(study))
        self.assertEqual([entry["solver"] for entry in study["solvers"]], ["ceres", "sa"])
        for entry in study["solvers"]:
            self.assertLessEqual(SOLVER_KEYS, set(entry))
            self.assertEqual(entry["repeats"], 2)

    def test_no_usable_answer_is_status_1(self):
        done = self.run_program("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--max-evaluations", 0)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr,
                         "sinew: no usable answer: not even the start was evaluated: 0 evaluations, 0 left\n")


if __name__ == "__main__":
    unittest.main()

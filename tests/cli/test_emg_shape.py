"""EMG of a cyclic movement through the program: learnt with electrodes, predicted without, and what it does to the muscles.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_emg_shape.py
"""
import json
import unittest

import h5py
import numpy as np

from program import ProgramTest

SMALL = ("--set", "speeds=4", "--set", "raw=0", "--set", "train=5", "--set", "validate=2", "--set", "subject=2")


class EmgShapeTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.succeeds("data", "synthesize", "emg_shape", *SMALL, "--out", "person.h5")

    def identify(self):
        return self.succeeds("identify", "emg_shape", "--data", "person.h5", "--solver", "lm", "--intervals", "linear", "--quiet",
                             "--out", "shape.h5", "--json", "shape.json")

    def rmse(self, file, trial, name):
        with h5py.File(self.path(file)) as simulated, h5py.File(self.path("person.h5")) as data:
            at = simulated[f"trials/{trial}/simulated"]
            for grid in data[f"trials/{trial}"].values():
                if name in grid.get("channels", {}):
                    predicted = np.interp(grid["time"][:], at["time"][:], at["channels"][name][:])
                    return float(np.sqrt(np.mean((predicted - grid["channels"][name][:]) ** 2)))
        raise KeyError(name)

    def test_from_electrodes_to_moments_without(self):
        self.identify()
        lead = next(p for p in json.loads(self.path("shape.json").read_text())["parameters"] if p["name"] == "lead")
        self.assertEqual((lead["verdict"], lead["unit"]), ("identifiable", "s"))
        self.assertTrue(0 < lead["value"] < 1)
        self.succeeds("simulate", "emg_shape", "--data", "person.h5", "--from", "shape.h5", "--out", "b.h5")
        self.path("a.yaml").write_text("emg_shape: {angle: ankle_angle_r, model: averaging}\n")
        self.succeeds("simulate", "emg_shape", "--data", "person.h5", "--config", "a.yaml", "--out", "a.h5")
        errors = {file: np.mean([self.rmse(file, f"validate_{speed}", muscle) for speed in ("045", "075", "090", "120")
                                 for muscle in ("lat_gas_r", "med_gas_r", "soleus_r", "tib_ant_r")]) for file in ("a.h5", "b.h5")}
        # Person 2 shifts phase with speed.
        self.assertLess(errors["b.h5"], 0.85 * errors["a.h5"])
        self.run_program("identify", "nms", "--data", "person.h5", "--solver", "lm", "--intervals", "linear", "--quiet", "--out", "n.h5")
        moments = {}
        for name, words in (("measured", ()), ("b", ("--excitations", "b.h5")), ("a", ("--excitations", "a.h5"))):
            done = self.run_program("simulate", "nms", "--data", "person.h5", "--from", "n.h5", *words, "--out", f"t_{name}.h5")
            self.assertEqual(done.returncode, 0, done.stderr)
            moments[name] = np.mean([self.rmse(f"t_{name}.h5", f"validate_{speed}", "ankle_angle_r_moment")
                                     for speed in ("045", "075", "090", "120")])
        self.assertLess(moments["measured"], moments["b"])
        self.assertLess(moments["b"], moments["a"])

    def test_an_angle_alone_is_enough_at_home(self):
        self.identify()
        facts = json.loads(self.path("shape.json").read_text())["warning_facts"]
        facts = next(dict(zip(w["names"], w["numbers"])) for w in facts if "reference.speed" in w["names"])
        jitter = ", ".join(f"{name[len('jitter.'):]}: {value}" for name, value in facts.items() if name.startswith("jitter."))
        settings = (f"reference: {{speed: {facts['reference.speed']}, period: {facts['reference.period']}}}\n"
                    f"  knots: {facts['knots']:.0f}\n  jitter: {{{jitter}}}")
        self.path("home.yaml").write_text("emg_shape:\n  angle: ankle_angle_r\n  muscles: [lat_gas_r, med_gas_r, per_long_r, soleus_r, "
                                          "tib_ant_r]\n  " + settings + "\n")
        with h5py.File(self.path("person.h5"), "r+") as file:
            for trial in list(file["trials"]):
                if trial != "validate_120":
                    del file["trials"][trial]
            emg = file["trials/validate_120/excitations/channels"]["soleus_r"][:]
            at = file["trials/validate_120/excitations/time"][:]
            del file["trials/validate_120/excitations"]
        done = self.run_program("simulate", "emg_shape", "--data", "person.h5", "--config", "home.yaml", "--from", "shape.h5", "--out",
                                "emg.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("nuisance values of shape.h5 belong to trials that these data do not have", " ".join(done.stderr.split()))
        with h5py.File(self.path("emg.h5")) as file:
            grid = file["trials/validate_120/simulated"]
            predicted = np.interp(at, grid["time"][:], grid["channels/soleus_r"][:])
        self.assertGreater(np.corrcoef(predicted, emg)[0, 1] ** 2, 0.8)

    def test_the_band_is_in_the_run_file(self):
        self.identify()
        with h5py.File(self.path("shape.h5")) as run:
            node = run["details/emg_shape/trials/validate_075/soleus_r"]
            self.assertEqual(len(node["predicted"]), len(node["deviation"]))
            self.assertTrue(np.all(node["deviation"][:] > 0))
        self.assertEqual(json.loads(self.path("shape.json").read_text())["problem"], "emg_shape")

    def test_what_is_wrong_is_said(self):
        self.refuses("--excitations: the problem 'emg_shape' takes none, only nms does", "simulate", "emg_shape", "--data", "person.h5",
                     "--excitations", "person.h5", "--out", "x.h5")
        self.refuses("--intervals: 'fast'", "identify", "emg_shape", "--data", "person.h5", "--intervals", "fast", "--out", "x.h5")
        self.path("bad.yaml").write_text("emg_shape: {angle: knee}\n")
        self.refuses("has no channel 'knee', the angle of the settings", "identify", "emg_shape", "--data", "person.h5", "--config",
                     "bad.yaml", "--out", "x.h5")
        self.succeeds("data", "synthesize", "emg_shape", "--set", "speeds=1", "--set", "raw=0", "--set", "train=2", "--set", "validate=0",
                      "--out", "one.h5")
        self.refuses("--excitations one.h5: has no trial", "simulate", "nms", "--data", "person.h5", "--excitations", "one.h5", "--out",
                     "x.h5")
        self.refuses("--effect", "data", "synthesize", "emg_shape", *SMALL, "--effect", "fatig:soleus_r.fatigue=0.1", "--out", "x.h5")


if __name__ == "__main__":
    unittest.main()

"""Cases with a hidden effect: what the generator gives away, and the benchmark end to end on a few files."""
import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import PROGRAM, ROOT, ProgramTest

GENERATE = os.environ.get(
    "SINEW_HIDDEN_EFFECTS_GENERATE",
    str(ROOT / "build" / "release" / "benchmarks" / "hidden_effects" / "hidden_effects_generate"))
RUN = ROOT / "benchmarks" / "hidden_effects" / "run.py"


@unittest.skipUnless(Path(GENERATE).exists(), "the benchmarks are not built")
class HiddenEffectsTest(ProgramTest):
    def generate(self, *words, name="case"):
        done = subprocess.run([GENERATE, *map(str, words), "--no-correlations", "--out", self.path(name + ".h5"),
                               "--truth", self.path(name + ".json")], capture_output=True, text=True, timeout=60,
                              check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return self.path(name + ".h5"), json.loads(self.path(name + ".json").read_text())

    def structure(self, path):
        """Names, attributes and shapes of a file, without its samples."""
        found = {}
        with h5py.File(path) as file:
            file.visititems(lambda name, item: found.update(
                {name: (sorted((k, str(v)) for k, v in item.attrs.items()), getattr(item, "shape", None))}))
            found[""] = sorted((k, str(v)) for k, v in file.attrs.items())
        return found

    def test_the_file_has_no_label(self):
        none, _ = self.generate("--kind", "none", "--seed", 3, name="none")
        plain = self.structure(none)
        for kind in ("single", "pair", "outsider"):
            path, truth = self.generate("--kind", kind, "--seed", 3, "--size", 3, name=kind)
            self.assertEqual(self.structure(path), plain)
            for effect in truth["effects"]:
                self.assertNotIn(effect["name"].encode(), path.read_bytes())

    def test_a_seed_names_one_case_and_its_design_does_not_depend_on_the_size(self):
        first, truth = self.generate("--seed", 5, "--size", 2, name="first")
        again, _ = self.generate("--seed", 5, "--size", 2, name="again")
        self.assertEqual(first.read_bytes(), again.read_bytes())
        _, larger = self.generate("--seed", 5, "--size", 4, name="larger")
        self.assertEqual(larger["base"], truth["base"])
        self.assertEqual(larger["effects"][0]["name"], truth["effects"][0]["name"])
        self.assertAlmostEqual(larger["effects"][0]["norm"] / truth["effects"][0]["norm"], 2, delta=0.05)  # 1 % each

    def test_the_effect_is_in_the_readings(self):
        quiet, _ = self.generate("--kind", "none", "--seed", 7, name="none")
        loud, truth = self.generate("--kind", "single", "--effect", "coulomb_friction", "--seed", 7, "--size", 6)
        with h5py.File(quiet) as a, h5py.File(loud) as b:
            for trial in a["trials"]:
                path = f"trials/{trial}/joint/channels/"
                np.testing.assert_array_equal(a[path + "torque"][()], b[path + "torque"][()])
                difference = b[path + "position"][()] - a[path + "position"][()]
                self.assertGreater(np.abs(difference).max(), 1e-4)  # same noise: what is left is the effect
        self.assertAlmostEqual(truth["effects"][0]["norm"], 6 * truth["unit_norm"], delta=0.3)

    def test_wrong_words(self):
        def error(*words):
            done = subprocess.run([GENERATE, *words, "--out", self.path("x.h5"), "--truth", self.path("x.json")],
                                  capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertFalse(self.path("x.h5").exists())
            return done.stderr
        self.assertIn("--kind odd: expected one of none, single, pair, outsider", error("--kind", "odd"))
        self.assertIn("--size 0: expected", error("--size", "0"))
        self.assertIn("--effect friction: expected one of", error("--effect", "friction"))
        self.assertIn("cannot have a size of 900", error("--effect", "hold", "--size", "900"))

    def test_benchmark_end_to_end(self):
        done = subprocess.run([sys.executable, str(RUN), "--sinew", PROGRAM, "--generate", GENERATE, "--kind",
                               "none,single", "--cases", "2", "--sizes", "30", "--effect", "coulomb_friction", "--jobs",
                               "1", "--out", self.path("results.json")], capture_output=True, text=True, timeout=110,
                              check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        results = json.loads(self.path("results.json").read_text())
        single = results["summary"]["single"][0]
        self.assertEqual(single["failed"], 0)
        # Thirty times what an oracle just detects, and nothing in the library is that like it.
        self.assertEqual(single["detected"]["hits"], 2)
        self.assertEqual(single["in_set"]["hits"], 2)
        self.assertEqual(len(results["cases"]), 4)
        self.assertIn("false alarms", done.stdout)


if __name__ == "__main__":
    unittest.main()

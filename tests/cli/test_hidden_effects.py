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
SEPARATE = RUN.with_name("separate.py")


GENERATOR = """#!/bin/sh
echo case >> calls.txt
[ $(wc -l < calls.txt) -ne 3 ] || { echo stopped >&2; exit 1; }
while [ $# -gt 1 ]; do
  [ "$1" != --truth ] || echo '{"effects": [], "base": {}}' > "$2"
  shift
done
"""
DIAGNOSIS = """#!/bin/sh
while [ $# -gt 1 ]; do
  [ "$1" != --json ] || echo '{"verdict": "adequate", "causes": [], "alternatives": [], "unknown_terms": [], "base": {}}' > "$2"
  shift
done
"""


class StoppedTest(ProgramTest):
    """Cases that had ended are kept; the programs are stand-ins, of which the third case fails once."""

    def test_resumed_it_does_only_what_is_left(self):
        for name, text in (("generate", GENERATOR), ("sinew", DIAGNOSIS)):
            self.write(name, text)
            self.path(name).chmod(0o755)
        words = [sys.executable, RUN, "--sinew", "sinew", "--generate", "generate", "--kind", "none", "--cases", "5", "--jobs", "1",
                 "--out", "results.json"]

        def run(*more):
            return subprocess.run([*words, *more], cwd=self.folder, capture_output=True, text=True, timeout=60, check=False)

        self.assertEqual(run().returncode, 1)
        self.assertFalse(self.path("results.json").exists())
        with self.path("results.json.cases").open("a") as kept:
            kept.write('{"kind": "no')  # cut off
        calls = self.path("calls.txt").read_text().count("case")
        self.assertIn("made with other settings", run("--resume", "--program-seed", "2").stderr)
        done = run("--resume")
        self.assertEqual(done.returncode, 0, done.stderr)
        # With one job, the cases after the third one went on.
        self.assertEqual(self.path("calls.txt").read_text().count("case"), calls + 1)
        cases = json.loads(self.path("results.json").read_text())["cases"]
        self.assertEqual([case["seed"] for case in cases], [1, 2, 3, 4, 5])
        self.assertFalse(self.path("results.json.cases").exists())


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

    def test_further_trials_change_nothing_else(self):
        words = ("--kind", "single", "--effect", "stribeck_friction", "--seed", 11, "--size", 3)
        plain, truth = self.generate(*words, name="plain")
        kinds = ["same", "rest", "creep", "hold", "fast", "sharp"]
        more, again = self.generate(*words, *(w for kind in kinds for w in ("--also", kind)), name="more")
        self.assertEqual(again.pop("also"), kinds)
        self.assertEqual(again, truth)
        with h5py.File(plain) as a, h5py.File(more) as b:
            for trial in a["trials"]:
                for channel in ("torque", "position"):
                    path = f"trials/{trial}/joint/channels/{channel}"
                    np.testing.assert_array_equal(a[path][()], b[path][()])
            added = sorted(set(b["trials"]) - set(a["trials"]))
            self.assertEqual([name.split("_")[-1] for name in added], kinds)
            trials = {kind: b["trials"][name]["joint"] for kind, name in zip(kinds, added)}
            position = {kind: trial["channels/position"][()] for kind, trial in trials.items()}
            torque = {kind: trial["channels/torque"][()] for kind, trial in trials.items()}
            for kind, trial in trials.items():
                self.assertAlmostEqual(trial["time"][-1], 10, msg=kind)
                self.assertEqual(len(trial["time"]), 10001 if kind == "sharp" else 1001)
            ordinary = b["trials/train_1/joint/channels/position"][()]
        # Noise of 3 mrad: over 0.1 s a mean speed is known to 0.05 rad/s.
        speed = {kind: np.abs(p[10:] - p[:-10]).max() * 10 for kind, p in position.items() if kind != "sharp"}
        self.assertEqual(np.abs(torque["rest"]).max(), 0)
        self.assertLess(np.abs(position["rest"]).max(), 0.35)
        self.assertLess(np.abs(position["rest"][-200:]).max(), 0.1)
        self.assertGreater(np.abs(position["fast"]).max(), 1.5)
        self.assertLess(np.abs(position["fast"]).max(), 3)
        self.assertGreater(speed["fast"], np.abs(ordinary[10:] - ordinary[:-10]).max() * 10)
        held = [position["hold"][k + 100:k + 124].std() for k in range(0, 1000, 125)]
        self.assertLess(max(held), 0.03)
        self.assertGreater(np.ptp(position["hold"]), 1.8)
        self.assertGreater(np.sum(np.abs(np.diff(torque["sharp"])) > 0.05 * np.ptp(torque["sharp"])), 20)

    def test_what_counts_as_separated(self):
        sys.path.insert(0, str(SEPARATE.parent))
        import separate
        def other(of, effect, same_class=False):
            return {"instead_of": of, "effect": effect, "same_class": same_class, "correlation": -0.9,
                    "separated_by": "motion over a wider range of positions"}
        found = {"causes": [{"effect": "a"}], "alternatives": [other("a", "b", True), other("a", "c"), other("a", "d")]}
        def names(truth):
            return [(p["rival"], p["class"]) for p in separate.rivals(truth, found)]
        self.assertEqual(names("a"), [("b", True), ("c", False), ("d", False)])
        self.assertEqual(names("b"), [("a", True), ("c", False), ("d", False)])  # of the class of a
        self.assertEqual(names("c"), [("a", False)])  # nothing is said about c and d
        self.assertEqual(separate.set_size(found), 3)
        pair = separate.rivals("a", found)[1]
        self.assertEqual((pair["kind"], pair["correlation"]), ("fast", 0.9))
        case = {"after": {"fast": {"truth_in_set": True, "stated": ["a"]}, "same": {"truth_in_set": True, "stated": ["a", "c"]},
                          "hold": {"truth_in_set": False, "stated": []}, "rest": {"failure": "x"}}}
        self.assertEqual([separate.separated(case, pair, k) for k in ("fast", "same", "hold", "rest", "creep")],
                         [True, False, False, False, None])

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
        self.assertIn("--also odd: expected one of same, rest,", error("--also", "odd"))
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

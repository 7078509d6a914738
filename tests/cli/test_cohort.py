"""The same steps for every subject of a cohort: what is done is kept, failures stay with their subject.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_cohort.py
"""
import html.parser
import json
import os
import signal
import time
import unittest

import h5py

from program import LONGEST, ProgramTest, differences

STEPS = """out: results
steps:
  data:
    - data synthesize contact --seed {seed} --set encoders=1 --set train=3 --set validate=1 --out {out}/data.h5
    - data drop {out}/data.h5 --trial train_3
  fit: identify contact --data {data} --solver lm --intervals linear --out {out}/run.h5
  all:
    run:
      - simulate contact --data {data} --from {fit} --out {out}/all.h5
      - [data, info, "{data}"]
    after: [fit]
"""
SUBJECTS = "subjects: {anna: {seed: 4}, bert: {seed: 5}, carl: {seed: 6}}\n"


class Links(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found += [value for name, value in attributes if name in ("href", "src")]


class Cohort(ProgramTest):
    def outcomes(self, *words, status=0):
        """{subject: {step: outcome}} of one run."""
        done = self.run_program("run", "cohort.yaml", "--quiet", "--json", "all.json", *words)
        self.assertEqual(done.returncode, status, done.stderr)
        self.said = done.stdout + done.stderr
        self.json = json.loads(self.path("all.json").read_text())
        found = {}
        for task in self.json["tasks"]:
            found.setdefault(task["subject"], {})[task["step"]] = task["outcome"]
        return found

    def all(self, outcome):
        return {subject: dict.fromkeys(("data", "fit", "all"), outcome) for subject in ("anna", "bert", "carl")}

    def test_what_is_done_is_kept(self):
        self.write("cohort.yaml", SUBJECTS + STEPS)
        self.assertEqual(self.outcomes("--threads", 2), self.all("done"))
        self.assertEqual(self.json["schema"], "sinew.cohort/1")
        stiffness = {one["subject"]: one for one in self.json["estimates"] if one["parameter"] == "stiffness"}
        for name in ("anna", "bert", "carl"):
            with h5py.File(self.path(f"results/{name}/run.h5")) as run:
                names = [one.decode() for one in run["parameters/name"]]
                self.assertEqual(stiffness[name]["value"], run["parameters/value"][names.index("stiffness")])
        spread = next(one for one in self.json["spreads"] if one["parameter"] == "stiffness")
        self.assertEqual((spread["subjects"], spread["identifiable"]), (3, 3))
        self.assertEqual(spread["median"], sorted(one["value"] for one in stiffness.values())[1])
        self.assertRegex(self.said, r"stiffness +N/m3 +fit +3/3 ")
        page = self.path("results/index.html").read_text()
        for link in Links(page).found:
            self.assertTrue(self.path("results").joinpath(link).is_file(), link)
        self.assertEqual(page.count("<td>stiffness</td>"), 4)
        self.assertIn("carl", page)

        self.assertEqual(self.outcomes(), self.all("kept"))
        self.path("results/bert/run.h5").unlink()
        expected = self.all("kept")
        expected["bert"].update(fit="done", all="done")  # what follows reads other bytes: the times differ
        self.assertEqual(self.outcomes(), expected)
        self.write("cohort.yaml", (SUBJECTS + STEPS).replace("seed: 6", "seed: 7"))
        expected = self.all("kept")
        expected["carl"] = self.all("done")["carl"]
        self.assertEqual(self.outcomes(), expected)

    def test_a_failure_stays_with_its_subject(self):
        self.write("cohort.yaml", SUBJECTS + STEPS.replace("--solver lm", "--solver lm --fix stiffness={stiffness}"))
        self.write("cohort.yaml", self.path("cohort.yaml").read_text().replace("{seed: 4}", "{seed: 4, stiffness: 9e5}").replace(
            "{seed: 5}", "{seed: 5, stiffness: much}").replace("{seed: 6}", "{seed: 6, stiffness: 9e5}"))
        expected = self.all("done")
        expected["bert"].update(fit="failed", all="not run")
        self.assertEqual(self.outcomes(status=1), expected)
        failed = next(one for one in self.json["tasks"] if one["outcome"] == "failed")
        self.assertIn("--fix", failed["reason"])
        self.assertIn(f"failed: fit of bert: {failed['reason']}"[:60], self.said)
        self.assertIn("sinew: no usable answer: 1 step failed\n", self.said)
        self.assertIn("--fix", self.path("results/index.html").read_text())
        self.assertIn(failed["reason"], self.path(failed["log"]).read_text())
        self.write("cohort.yaml", self.path("cohort.yaml").read_text().replace("much", "9e5"))
        expected = self.all("kept")
        expected["bert"].update(fit="done", all="done")
        self.assertEqual(self.outcomes(), expected)

    def test_subjects_of_a_pattern(self):
        for name in ("s2", "s1"):
            self.stances(f"{name}.h5")
        self.write("notes.txt", "none of them")
        self.write("cohort.yaml", "subjects: \"*.h5\"\nout: of\nsteps:\n  fit: identify contact --data {file} --solver lm "
                                  "--intervals linear --out {out}/run.h5\n")
        self.assertEqual(self.outcomes(), {"s1": {"fit": "done"}, "s2": {"fit": "done"}})
        with h5py.File(self.path("s1.h5"), "r+") as data:
            data.attrs["title"] = "other bytes"
        self.assertEqual(self.outcomes(), {"s1": {"fit": "done"}, "s2": {"fit": "kept"}})

    def test_wrong_pipelines_write_nothing(self):
        whole = SUBJECTS + STEPS
        for old, new, said in (
                ("out: results", "out: results\nwhere: here", "cohort.yaml:3: unknown key 'where'"),
                ("{seed}", "{sed}", "step 'data': {sed} stands for nothing here; did you mean 'seed'?"),
                ("--solver lm", "--sovler lm", "step 'fit' of anna: unknown option '--sovler'; did you mean '--solver'?"),
                ("identify contact", "identfy contact", "unknown command 'identfy'; did you mean 'identify'?"),
                ("after: [fit]", "after: [fitt]", "after 'fitt'; did you mean 'fit'?"),
                ("--solver lm", "--solver {all}", "waits for itself"),
                ("--out {out}/run.h5", "--out all.h5", "all.h5 is written by anna, fit too"),
                ("simulate contact --data {data} --from {fit} --out {out}/all.h5", "data info x", "writes no file of its own"),
                ("anna", "an/na", "'an/na' is no name"),
                (whole, "subjects: []\nout: a\nsteps: {}", "subjects: there is none"),
                (whole, "subjects: [a]\nout: a", "steps"),
                (whole, "subjects: [a]\nout: a\nsteps: {s: run other.yaml}", "writes no file of its own|run runs itself"),
                (whole, "[", "is not YAML")):
            self.write("cohort.yaml", whole.replace(old, new))
            with self.subTest(new):
                done = self.run_program("run", "cohort.yaml")
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                self.assertRegex(done.stderr, "^sinew: error: [^\n]*\n$")
                self.assertTrue(any(part in done.stderr for part in said.split("|")), done.stderr)
                self.assertEqual(os.listdir(self.folder), ["cohort.yaml"])


class Stopped(ProgramTest):
    LONG = ("subjects: [anna, bert]\nout: results\nsteps:\n  fit: identify contact --data stances.h5 --solver sa "
            "--max-evaluations 150000 --intervals linear --out {out}/run.h5\n")

    def setUp(self):
        super().setUp()
        self.stances()
        self.write("cohort.yaml", self.LONG)

    def wait_for(self, condition):
        deadline = time.monotonic() + LONGEST
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def working(self):
        """Process ids of commands that work in this folder."""
        found = []
        for name in filter(str.isdigit, os.listdir("/proc")):
            try:
                if os.readlink(f"/proc/{name}/cwd") == os.path.realpath(self.folder):
                    found.append(int(name))
            except OSError:
                pass
        return found

    def test_goes_on_where_it_was_stopped(self):
        self.succeeds("identify", "contact", "--data", "stances.h5", "--solver", "sa", "--max-evaluations", 150000, "--intervals",
                      "linear", "--quiet", "--out", "whole.h5")
        for stop, status in ((signal.SIGTERM, 143), (signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL)):
            with self.subTest(stop.name):
                cohort = self.start("run", "cohort.yaml", "--threads", 2, "--quiet")
                # The first checkpoint, after 2 s.
                self.wait_for(lambda: all(self.path(f"results/{name}/run.h5").exists() for name in ("anna", "bert")))
                cohort.send_signal(stop)
                _, said = cohort.communicate(timeout=LONGEST)
                self.assertEqual(cohort.returncode, status, said)
                if stop != signal.SIGKILL:
                    self.assertIn(f"stopped by {stop.name}; 0 of 2 steps are done: the same command goes on\n", said)
                self.wait_for(lambda: not self.working())
                kept = {}
                for name in ("anna", "bert"):
                    with h5py.File(self.path(f"results/{name}/run.h5")) as run:
                        self.assertEqual(run["run"].attrs["finished"], 0)
                        kept[name] = run["run"].attrs["evaluations"]
                self.succeeds("run", "cohort.yaml", "--threads", 2, "--quiet")
                for name in ("anna", "bert"):
                    with h5py.File(self.path(f"results/{name}/run.h5")) as run, h5py.File(self.path("whole.h5")) as whole:
                        self.assertLess(kept[name], run["run"].attrs["evaluations"])
                        self.assertEqual(differences(run, whole), [])
                    self.path(f"results/{name}/run.h5").unlink()

    def test_two_at_once_are_refused(self):
        cohort = self.start("run", "cohort.yaml", "--threads", 2, "--quiet")
        self.wait_for(lambda: len(self.working()) > 2)
        done = self.run_program("run", "cohort.yaml")
        self.assertEqual(done.returncode, 2)
        self.assertIn("results/index.html: is being written by process", done.stderr)
        cohort.send_signal(signal.SIGTERM)
        cohort.communicate(timeout=LONGEST)


if __name__ == "__main__":
    unittest.main()

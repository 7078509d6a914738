"""Runs that were stopped, or changed by hand: drawn as such, taken only with a warning in the result.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_unfinished.py
"""
import json
import signal
import time
import unittest

import h5py

from program import LONGEST, ProgramTest

UNFINISHED = "run.h5 is of a run that was not finished: its values are those of the best point so far"
SEARCH = ("identify", "contact", "--data", "stances.h5", "--solver", "sa", "--quiet", "--intervals", "linear", "--out")


class WithRun(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def stop_a_search(self, stop):
        """Leaves run.h5 by a signal, or by its last checkpoint if that is SIGKILL."""
        search = self.start(*SEARCH, "run.h5")
        self.addCleanup(lambda: search.poll() is None and search.kill())
        deadline = time.monotonic() + LONGEST
        while not self.path("run.h5").exists():  # the first checkpoint, after 2 s
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        search.send_signal(stop)
        search.communicate(timeout=LONGEST)

    def finish_a_search(self):
        self.succeeds(*SEARCH, "run.h5", "--max-evaluations", 300)

    def change(self, path, place, value):
        with h5py.File(self.path(path), "r+") as file:
            if "@" in place:
                group, _, name = place.partition("@")
                file[group].attrs[name] = value
            else:
                file[place][...] = value


class Unfinished(WithRun):
    def test_is_drawn_and_said(self):
        for stop in (signal.SIGKILL, signal.SIGTERM):
            self.stop_a_search(stop)
            self.succeeds("report", "run.h5", "--out-dir", "page")
            self.assertIn("This run has not finished: what follows is its state after", self.path("page/index.html").read_text())
            self.path("run.h5").unlink()
        words = ("compare", "contact", "--data", "stances.h5", "--solvers", "sa", "--repeats", 50, "--quiet", "--out", "study.h5")
        study = self.start(*words)
        time.sleep(1.5)
        study.send_signal(signal.SIGINT)
        study.communicate(timeout=LONGEST)
        self.assertEqual(study.returncode, 130)
        self.succeeds("report", "study.h5", "--out-dir", "page")
        self.assertIn("This comparison has not finished", self.path("page/index.html").read_text())

    def test_parameters_are_taken_with_a_warning(self):
        self.stop_a_search(signal.SIGKILL)
        for out in ("sim.h5", "sim.sto"):
            done = self.run_program("simulate", "contact", "--data", "stances.h5", "--from", "run.h5", "--out", out, "--json",
                                    f"{out}.json", "--quiet")
            self.assertEqual((done.returncode, " ".join(done.stderr.split())), (0, f"warning: {UNFINISHED}"))
            self.assertEqual(json.loads(self.path(f"{out}.json").read_text())["warnings"], [UNFINISHED])
        with h5py.File(self.path("sim.h5")) as file:
            self.assertIn(f"; warning: {UNFINISHED}", file.attrs["source"])
        self.assertIn(f"; warning: {UNFINISHED}", self.path("sim_train_1.sto").read_text().splitlines()[0])
        found = json.loads(self.succeeds("diagnose", "contact", "--data", "stances.h5", "--from", "run.h5", "--out", "d.h5", "--json",
                                         "-", "--quiet"))
        self.assertIn("unfinished_start", [fact["kind"] for fact in found["warning_facts"]])
        self.assertIn(UNFINISHED, found["warnings"])

    def test_a_finished_run_has_none(self):
        self.finish_a_search()
        self.succeeds("simulate", "contact", "--data", "stances.h5", "--from", "run.h5", "--out", "sim.h5", "--quiet", "--json",
                      "sim.json")
        self.assertEqual(json.loads(self.path("sim.json").read_text())["warnings"], [])
        found = json.loads(self.succeeds("diagnose", "contact", "--data", "stances.h5", "--from", "run.h5", "--out", "d.h5", "--json",
                                         "-", "--quiet"))
        kinds = [fact["kind"] for fact in found["warning_facts"]]
        self.assertFalse({"unfinished_start", "stated_cost"} & set(kinds), kinds)


class Changed(WithRun):
    def setUp(self):
        super().setUp()
        self.finish_a_search()

    def test_a_stated_cost_is_looked_at(self):
        self.change("run.h5", "run@cost", 1e-3)
        said = r"run.h5 states the cost 0.0010*, but its values have the cost [0-9.e]+: it was changed, or made by another build"
        done = self.run_program("simulate", "contact", "--data", "stances.h5", "--from", "run.h5", "--out", "sim.h5", "--quiet")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(" ".join(done.stderr.split()), f"^warning: {said}")
        found = json.loads(self.succeeds("diagnose", "contact", "--data", "stances.h5", "--from", "run.h5", "--out", "d.h5", "--json",
                                         "-", "--quiet"))
        self.assertIn("stated_cost", [fact["kind"] for fact in found["warning_facts"]])

    def test_resuming_evaluates_the_best_point_again(self):
        with h5py.File(self.path("run.h5"), "r+") as run:
            run["trace/cost"][7] = 1e-3
        self.refuses("run.h5 states the cost 0.001 for its best point, which has the cost ", *SEARCH, "run.h5", "--resume",
                     "--max-evaluations", 300)

    def test_resuming_needs_the_same_version(self):
        self.change("run.h5", "run@version", "0.0.1")
        self.refuses("--resume: run.h5 was made with version 0.0.1, not 0.1.0", *SEARCH, "run.h5", "--resume", "--max-evaluations",
                     300)

    def test_resuming_a_comparison_needs_the_same_budget(self):
        words = ("compare", "contact", "--data", "stances.h5", "--solvers", "sa", "--repeats", 2, "--quiet", "--out", "study.h5")
        self.succeeds(*words, "--max-evaluations", 100)
        self.refuses("--resume: study.h5 was made with --max-evaluations 100, not 200", *words, "--max-evaluations", 200, "--resume")
        self.refuses("--resume: study.h5 was made with other parameters (they differ in their free)", *words, "--max-evaluations",
                     100, "--resume", "--fix", "dissipation=100")


if __name__ == "__main__":
    unittest.main()

"""SIGINT and SIGTERM stop long work within a second; what was found is kept, and the resumed result is that of an
uninterrupted run.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_signals.py
"""
import os
import signal
import time
import unittest

import h5py
import numpy as np

from program import LONGEST, ProgramTest, differences

BOTH = {signal.SIGINT: 130, signal.SIGTERM: 143}
SOON = LONGEST / 60  # [s] 10 of a machine that does much other work as well; alone it takes less than one (stop_signals_test.cpp)


class Stopped(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def stop(self, stop, moment, *words):
        """Starts a command and stops it after so many seconds. Returns its standard error, None if it had ended, "" if not begun."""
        program = self.start(*words)
        try:
            time.sleep(moment)
            if program.poll() is not None:
                self.assertEqual(program.returncode, 0)
                return None
            program.send_signal(stop)
            began = time.monotonic()
            _, errors = program.communicate(timeout=LONGEST)
        finally:
            if program.poll() is None:
                program.kill()
            program.communicate()
        if program.returncode == 0:
            return None
        if program.returncode == -stop:  # before its first line: the libraries were still being loaded
            return ""
        self.assertLess(time.monotonic() - began, SOON)
        self.assertEqual(program.returncode, BOTH[stop], errors)
        self.assertRegex(errors, rf"(^|\n)sinew: stopped by {stop.name}[^\n]*\n$")
        self.assertFalse([name for name in os.listdir(self.folder) if name.startswith(".sinew-")], "a lock or temporary file")
        return errors

    def timed(self, *words):
        began = time.monotonic()
        self.succeeds(*words)
        return time.monotonic() - began

    def stop_midway(self, stop, seconds, *words, midway=lambda: True):
        """Stops a command that takes about so many seconds when it has something to keep that is of the middle. The moment is found by
        bisection, again from a wider range where the speed of a busy machine has changed."""
        early, late, moment = 0, None, 0.6 * seconds
        for _ in range(40):
            said = self.stop(stop, moment, *words)
            keeps = said is not None and "; parts.h5 holds " in said
            if keeps and midway():
                return said
            self.path("parts.h5").unlink(missing_ok=True)
            # What was kept is of the end, or of the begin: by the time only.
            if said is None or keeps and 2 * moment > seconds:
                late = moment
            else:
                early = moment
            if late is not None and late - early < 0.02:
                early, late = 0.5 * early, 2 * late
            moment = 1.5 * moment if late is None else (early + late) / 2
        self.fail("never stopped in the middle")

    def length(self, name, place):
        with h5py.File(self.path(name)) as run:
            return len(run[place]) if place in run else 0

    def same(self, one, two, but=()):
        with h5py.File(self.path(one)) as first, h5py.File(self.path(two)) as second:
            found = [place for place in differences(first, second) if not place.endswith(tuple(but))]
            self.assertEqual(found, [])

    def test_identify(self):
        self.succeeds("data", "synthesize", "nms", "--out", "nms.h5")
        for problem, data, solver, budget in (("contact", "stances.h5", "sa", 60000), ("contact", "stances.h5", "sa+lm", 60000),
                                              ("nms", "nms.h5", "cmaes", 500), ("nms", "nms.h5", "nlopt:GN_CRS2_LM", 500)):
            words = ("identify", problem, "--data", data, "--solver", solver, "--max-evaluations", budget, "--intervals",
                     "linear", "--quiet", "--out")
            seconds = self.timed(*words, "whole.h5")
            for stop in BOTH:
                with self.subTest(solver=solver, stop=stop.name):
                    said = self.stop_midway(stop, seconds, *words, "parts.h5")
                    self.assertRegex(said or "", r"; parts.h5 holds \d+ evaluations( and \d+ fits?)?: the same command with --resume goes on\n$")
                    with h5py.File(self.path("parts.h5")) as run:
                        self.assertEqual(run["run"].attrs["finished"], 0)
                        evaluations = run["run"].attrs["evaluations"]
                    self.assertIn(f" {evaluations} evaluations", said)
                    again = self.stop(stop, 0.15, *words, "parts.h5", "--resume")
                    with h5py.File(self.path("parts.h5")) as run:
                        self.assertGreaterEqual(run["run"].attrs["evaluations"], evaluations, again)
                    self.succeeds(*words, "parts.h5", "--resume")
                    self.same("whole.h5", "parts.h5")
                    self.path("parts.h5").unlink()

    def test_identify_from_many_starts(self):
        """The local searches that had ended are not done again."""
        self.succeeds("data", "synthesize", "nms", "--out", "nms.h5")
        words = ("identify", "nms", "--data", "nms.h5", "--solver", "multistart", "--intervals", "linear", "--quiet", "--threads", 1,
                 "--out")
        seconds = self.timed(*words, "whole.h5")
        searches = self.length("whole.h5", "searches/cost")
        self.stop_midway(signal.SIGTERM, seconds, *words, "parts.h5",
                         midway=lambda: 0 < self.length("parts.h5", "searches/cost") < searches)
        with h5py.File(self.path("parts.h5")) as run:
            self.assertGreater(run["searches/evaluations"][:].sum(), 0)
        self.succeeds(*words, "parts.h5", "--resume")
        self.same("whole.h5", "parts.h5")

    def test_identify_by_derivatives(self):
        """Residuals and derivatives of the search, and the fits of the intervals, are not evaluated again."""
        self.succeeds("data", "synthesize", "nms", "--out", "nms.h5")
        for solver in ("lm", "ceres"):
            words = ("identify", "nms", "--data", "nms.h5", "--solver", solver, "--quiet", "--threads", 1, "--out")
            seconds = self.timed(*words, "whole.h5")
            with self.subTest(solver=solver):
                self.stop_midway(signal.SIGTERM, seconds, *words, "parts.h5",
                                 midway=lambda: self.length("parts.h5", "resume/residuals/evaluation") > 0)
                self.succeeds(*words, "parts.h5", "--resume")
                self.same("whole.h5", "parts.h5")
                self.path("parts.h5").unlink()

    def test_diagnose(self):
        self.succeeds("data", "synthesize", "drive", "--out", "drive.h5", "--effect", "asymmetric_friction:forward_friction=0.16,backward_friction=0.08")
        words = ("diagnose", "drive", "--data", "drive.h5", "--quiet", "--out")
        seconds = self.timed(*words, "whole.h5")
        for stop in BOTH:
            with self.subTest(stop=stop.name):
                said = self.stop_midway(stop, seconds, *words, "parts.h5", midway=lambda: self.length("parts.h5", "resume/fits/question") > 0)
                self.assertRegex(said, r"; parts.h5 holds \d+ evaluations? and \d+ fits?: the same command with --resume goes on\n$")
                with h5py.File(self.path("parts.h5")) as run:
                    self.assertEqual(run["run"].attrs["finished"], 0)
                    kept = len(run["resume/fits/question"])
                again = self.stop(stop, 0.2, *words, "parts.h5", "--resume")
                with h5py.File(self.path("parts.h5")) as run:
                    self.assertGreaterEqual(len(run["resume/fits/question"]), kept, again)
                self.refuses("was made with --seed 1, not 2", *words, "parts.h5", "--resume", "--seed", 2)
                self.refuses("was made with --fix , not inertia", *words, "parts.h5", "--resume", "--fix", "inertia=0.15")
                self.succeeds(*words, "parts.h5", "--resume")
                self.same("whole.h5", "parts.h5")
                self.path("parts.h5").unlink()

    def test_a_problem_whose_simulations_take_long(self):
        self.succeeds("data", "synthesize", "free_body", "--out", "toss.h5")
        words = ("identify", "free_body", "--data", "toss.h5", "--quiet", "--out", "parts.h5")
        self.stop_midway(signal.SIGTERM, 2, *words)
        with h5py.File(self.path("parts.h5")) as run:
            self.assertEqual(run["run"].attrs["finished"], 0)

    def test_before_anything_is_there(self):
        moment = 0.4
        for _ in range(30):  # until it is met at work: later than the begin of a slow build, before its end
            said = self.stop(signal.SIGTERM, moment, "data", "synthesize", "emg_shape", "--out", "d.h5")
            self.path("d.h5").unlink(missing_ok=True)
            if said:
                break
            moment *= 1.3 if said == "" else 0.8
        self.assertRegex(said or "", "before .*: begin it again\n$")
        self.assertEqual(os.listdir(self.folder), ["stances.h5"])

    def test_resume_of_what_was_never_saved_begins(self):
        words = ("--data", "stances.h5", "--quiet", "--max-evaluations", 300, "--resume", "--out")
        for command in (("identify", "contact", "--solver", "sa"), ("compare", "contact", "--solvers", "sa", "--repeats", 2)):
            done = self.run_program(*command, *words, f"{command[0]}.h5")
            self.assertEqual((done.returncode, done.stderr),
                             (0, f"note: --resume: {command[0]}.h5 is not there yet, this begins from the start\n"))

    def test_compare(self):
        words = ("compare", "contact", "--data", "stances.h5", "--solvers", "sa,lm", "--repeats", 4, "--max-evaluations", 20000,
                 "--quiet", "--out")
        seconds = self.timed(*words, "whole.h5")
        for stop in BOTH:
            with self.subTest(stop=stop.name):
                said = self.stop_midway(stop, seconds, *words, "parts.h5")
                self.assertRegex(said or "", r"; parts.h5 holds the \d+ runs? that had ended: the same command with --resume ")
                with h5py.File(self.path("parts.h5")) as study:
                    self.assertEqual(study["study"].attrs["finished"], 0)
                    self.assertLess(len(study["study/runs/cost"]), 8)
                self.succeeds(*words, "parts.h5", "--resume")
                self.same("whole.h5", "parts.h5", but=("seconds_to_target",))
                self.path("parts.h5").unlink()

    def test_report(self):
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--solver", "lm", "--intervals", "linear",
                      "--quiet")
        for stop in BOTH:
            for moment in (0.05, 0.5, 1.5):
                self.assertIsNotNone(self.stop(stop, moment, "report", "run.h5", "--out-dir", "page"))
                self.assertFalse(self.path("page").exists())
        for moment in (0.2, 0.6, 1):  # what a killed one has started ends at once, and leaves the next one its folder
            killed = self.start("report", "run.h5", "--out-dir", "page")
            time.sleep(moment)
            killed.kill()
            self.succeeds("report", "run.h5", "--out-dir", "page")
            killed.communicate()
            self.assertEqual(sorted(os.listdir(self.path("page"))), ["index.html", "index.ipynb"])


if __name__ == "__main__":
    unittest.main()

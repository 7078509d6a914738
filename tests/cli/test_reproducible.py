"""The same question has the same answer: on any number of threads, and after any interruption.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_reproducible.py
"""
import shutil
import signal
import time
import unittest

import h5py
import numpy as np

from program import LONGEST, ProgramTest, differences

SEARCHES = {  # solver: further words
    "ceres": (), "sa": ("--max-evaluations", 500), "cmaes": ("--max-evaluations", 500), "multistart": (),
    "sa+ceres": ("--max-evaluations", 500)}


MORE_SECONDS = 5  # the first checkpoint comes after 2 s, and what it holds is taken over faster than evaluated


class WithStances(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def identify(self, out, *words):
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", out, "--quiet", *words)

    def assert_same_run(self, a, b):
        with h5py.File(self.path(a)) as first, h5py.File(self.path(b)) as second:
            self.assertEqual(differences(first, second), [])


class Reproducible(WithStances):
    def test_on_any_number_of_threads(self):
        for solver, words in SEARCHES.items():
            with self.subTest(solver):
                self.identify("one.h5", "--solver", solver, "--threads", 1, *words)
                self.identify("two.h5", "--solver", solver, "--threads", 2, *words)
                self.assert_same_run("one.h5", "two.h5")

    def test_another_seed_is_another_search(self):
        self.identify("one.h5", "--solver", "sa", "--max-evaluations", 100, "--seed", 1)
        self.identify("two.h5", "--solver", "sa", "--max-evaluations", 100, "--seed", 2)
        with h5py.File(self.path("one.h5")) as first, h5py.File(self.path("two.h5")) as second:
            self.assertIn("/trace/x", differences(first, second))

    def test_synthesis(self):
        self.succeeds("data", "synthesize", "contact", "--seed", 7, "--out", "one.h5")
        self.succeeds("data", "synthesize", "contact", "--seed", 7, "--out", "two.h5")
        self.succeeds("data", "synthesize", "contact", "--seed", 8, "--out", "three.h5")
        self.assertEqual(self.path("one.h5").read_bytes(), self.path("two.h5").read_bytes())
        self.assertNotEqual(self.path("one.h5").read_bytes(), self.path("three.h5").read_bytes())


class Resumed(WithStances):
    def test_to_the_answer_of_an_uninterrupted_run(self):
        for solver in ("sa", "cmaes"):
            with self.subTest(solver):
                self.identify("whole.h5", "--solver", solver, "--max-evaluations", 1000)
                self.identify("parts.h5", "--solver", solver, "--max-evaluations", 300)
                self.identify("parts.h5", "--solver", solver, "--max-evaluations", 1000, "--resume")
                self.assert_same_run("whole.h5", "parts.h5")

    def test_without_evaluating_anew(self):
        mark = 1234567.891  # a cost that no evaluation gives, nor the best, which is looked at
        self.identify("run.h5", "--solver", "sa", "--max-evaluations", 300)
        with h5py.File(self.path("run.h5"), "r+") as run:
            run["trace/cost"][299] = mark
        self.identify("run.h5", "--solver", "sa", "--max-evaluations", 300, "--resume")
        with h5py.File(self.path("run.h5")) as run:
            self.assertEqual(run["trace/cost"].shape, (300,))
            self.assertEqual(run["trace/cost"][299], mark)

    def long_search(self):
        """An annealing that takes tens of seconds, as soon as its first checkpoint is there."""
        search = self.start("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--solver", "sa",
                            "--quiet")
        self.addCleanup(lambda: search.poll() is None and search.kill())
        deadline = time.monotonic() + LONGEST
        while not self.path("run.h5").exists():
            self.assertIsNone(search.poll(), "it ended before its first checkpoint")
            self.assertLess(time.monotonic(), deadline, "no checkpoint")
            time.sleep(0.02)
        return search

    def evaluations(self, finished):
        with h5py.File(self.path("run.h5")) as run:
            self.assertEqual(run["run"].attrs["finished"], finished)
            self.assertTrue(np.isfinite(run["parameters/value"]).all())
            return run["run"].attrs["evaluations"]

    def completes(self):
        """The unfinished run is gone on with to an end (a budget of time) and keeps what it had.

        A budget of evaluations would not do: annealing plans its cooling by it.
        """
        done = self.evaluations(finished=0)
        shutil.copy(self.path("run.h5"), self.path("unfinished.h5"))
        self.identify("run.h5", "--solver", "sa", "--max-seconds", MORE_SECONDS, "--resume")
        self.assertGreater(self.evaluations(finished=1), done)
        with h5py.File(self.path("run.h5")) as run, h5py.File(self.path("unfinished.h5")) as before:
            # Of a long search a part of the points is kept, and fewer of them the longer it is.
            kept = run["trace/evaluation"][()] < done
            rows = np.searchsorted(before["trace/evaluation"][()], run["trace/evaluation"][kept])
            np.testing.assert_array_equal(run["trace/evaluation"][kept], before["trace/evaluation"][()][rows])
            np.testing.assert_array_equal(run["trace/x"][()][kept], before["trace/x"][()][rows])
            np.testing.assert_array_equal(run["trace/cost"][kept], before["trace/cost"][()][rows])

    def test_after_ctrl_c(self):
        search = self.long_search()
        search.send_signal(signal.SIGINT)
        said, errors = search.communicate(timeout=LONGEST)
        self.assertEqual(search.returncode, 130)
        self.assertRegex(errors, "^sinew: stopped by SIGINT; run.h5 holds [0-9]+ evaluations( and [0-9]+ fits?)?: the same command with --resume goes on\n$")
        self.assertIn("NOT converged: interrupted after", said)
        with h5py.File(self.path("run.h5")) as run:
            self.assertEqual(run["run"].attrs["stop_reason"], "interrupted")
        self.completes()

    def test_after_a_kill(self):
        search = self.long_search()
        search.kill()
        search.communicate(timeout=LONGEST)
        self.assertEqual(search.returncode, -signal.SIGKILL)
        self.completes()

    def test_a_kill_at_any_moment_leaves_a_readable_file_or_none(self):
        for moment in np.linspace(0, 0.15, 16):
            search = self.start("identify", "contact", "--data", "stances.h5", "--out", "short.h5", "--quiet")
            time.sleep(moment)
            search.kill()
            search.communicate(timeout=LONGEST)
            if self.path("short.h5").exists():
                with h5py.File(self.path("short.h5")) as run:
                    self.assertEqual(run["run"].attrs["finished"], 1)
                self.path("short.h5").unlink()


if __name__ == "__main__":
    unittest.main()

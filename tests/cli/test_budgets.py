"""Budgets of a run, and what commands take of the machine's memory.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_budgets.py
"""
import os
import subprocess
import unittest

import h5py
import numpy as np

from program import PROGRAM, ProgramTest, differences


class Starts(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()
        self.words = ("identify", "contact", "--data", "stances.h5", "--quiet", "--intervals", "linear")

    def starts_of(self, *words):
        self.succeeds(*self.words, "--out", "run.h5", *words)
        with h5py.File(self.path("run.h5")) as run:
            return len(run["stages/cost"]), run["run"].attrs["starts"]

    def test_as_many_as_asked(self):
        self.assertEqual(self.starts_of("--solver", "multistart", "--starts", 7), (7, 7))
        self.assertEqual(self.starts_of("--solver", "multistart"), (20, 20))

    def test_of_a_comparison(self):
        words = ("compare", "contact", "--data", "stances.h5", "--quiet", "--repeats", 1, "--max-evaluations", 700, "--out", "study.h5")
        evaluations = []
        for starts in (2, 30):
            self.succeeds(*words, "--solvers", "multistart,lm", "--starts", starts)
            with h5py.File(self.path("study.h5")) as study:
                evaluations.append(study["study/runs/evaluations"][0])
        self.assertLess(2 * evaluations[0], evaluations[1])
        self.refuses("--resume: study.h5 was made with --starts 30, not 20", *words, "--solvers", "multistart,lm", "--resume")
        self.refuses("--starts: they are those of solver multistart, which is not compared", *words, "--solvers", "lm", "--starts", 5)

    def test_only_of_multistart(self):
        self.refuses("--starts: they are those of solver multistart, and not of lm", *self.words, "--out", "run.h5", "--solver", "lm",
                     "--starts", 7)
        self.refuses("--starts", *self.words, "--out", "run.h5", "--solver", "multistart", "--starts", 0)

    def test_a_resumed_run_has_the_same(self):
        words = ("--solver", "multistart", "--starts", 30)
        self.succeeds(*self.words, "--out", "whole.h5", *words, "--max-evaluations", 1000)
        self.succeeds(*self.words, "--out", "parts.h5", *words, "--max-evaluations", 1000)
        self.refuses("--resume: parts.h5 was made with --starts 30, not 20", *self.words, "--out", "parts.h5", "--solver", "multistart",
                     "--max-evaluations", 1000, "--resume")
        self.succeeds(*self.words, "--out", "parts.h5", *words, "--max-evaluations", 1000, "--resume")
        with h5py.File(self.path("whole.h5")) as whole, h5py.File(self.path("parts.h5")) as parts:
            self.assertEqual(differences(whole, parts), [])


class Memory(ProgramTest):
    def peak(self, *words):
        """Of a command and of the processes that it starts, the one that takes most [bytes]."""
        child = subprocess.Popen([PROGRAM, *words], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(child.returncode, 0, words)
        return 1024 * usage.ru_maxrss

    def test_a_run_stops_at_its_budget_and_goes_on_with_more(self):
        self.stances()
        words = ("identify", "contact", "--data", "stances.h5", "--solver", "sa", "--max-evaluations", 300, "--quiet", "--out")
        self.succeeds(*words, "whole.h5")
        done = self.run_program(*words, "parts.h5", "--max-memory", 1)
        self.assertEqual(done.returncode, 1)
        self.assertIn("the process takes the 1 MB of memory that it may; --resume with more goes on", " ".join(done.stderr.split()))
        self.succeeds(*words, "parts.h5", "--max-memory", 100000, "--resume")
        with h5py.File(self.path("whole.h5")) as whole, h5py.File(self.path("parts.h5")) as parts:
            self.assertEqual(differences(whole, parts), [])

    def stop_and_go_on(self, *words):
        """Stopped by its memory, and then resumed without a limit: the same as without a stop."""
        self.succeeds(*words, "whole.h5")
        done = self.run_program(*words, "parts.h5", "--max-memory", 1)
        self.assertEqual(done.returncode, 1)
        said = " ".join(done.stderr.split())
        self.assertIn("stopped by --max-memory 1: the process takes ", said)
        # Where nothing had ended before the stop, a note says that it begins from the start.
        again = self.run_program(*words, "parts.h5", "--max-memory", 100000, "--resume")
        self.assertEqual(again.returncode, 0, again.stderr)
        with h5py.File(self.path("whole.h5")) as whole, h5py.File(self.path("parts.h5")) as parts:
            self.assertEqual(differences(whole, parts), [])

    def test_a_diagnosis_stops_and_goes_on_with_more(self):
        self.succeeds("data", "synthesize", "drive", "--out", "small.h5")
        self.stop_and_go_on("diagnose", "drive", "--data", "small.h5", "--quiet", "--out")

    def test_a_comparison_stops_and_goes_on_with_more(self):
        self.stances()
        self.stop_and_go_on("compare", "contact", "--data", "stances.h5", "--solvers", "lm,sa", "--repeats", 2, "--max-evaluations", 300,
                            "--quiet", "--out")

    def recording(self, trials="abc", names="stuvwxyz", samples=100000):
        """Noise, which nothing compresses, of 8 channels: a hundred thousand samples of 3 trials."""
        rng = np.random.default_rng(1)
        with h5py.File(self.path("long.h5"), "w") as file:
            file.attrs.update(sinew_schema="dataset/1", title="long", synthetic=1)
            for trial in trials:
                group = file.create_group(f"trials/{trial}")
                group.attrs.update(role="train", task="")
                group["sensors/time"] = np.arange(samples) * 1e-3
                for name in names:
                    channel = group.create_dataset(f"sensors/channels/{name}", data=rng.standard_normal(samples))
                    channel.attrs.update(unit="V", kind="measured")
                channel[1000:60000] = channel[1000]  # stuck: a gap with --mask auto
        return self.path("long.h5").stat().st_size

    def test_few_long_channels_are_checked_in_three_times_the_file(self):
        self.succeeds("data", "synthesize", "drive", "--out", "small.h5")
        idle = self.peak("data", "check", "small.h5")
        for trials, names in (("a", "z"), ("ab", "z"), ("a", "yz")):
            size = self.recording(trials, names, 1500000)
            self.assertGreater(size, 20e6)
            self.assertLess(self.peak("data", "check", "long.h5") - idle, 2.6 * size, (trials, names))

    def test_commands_on_data_take_at_most_three_times_the_file(self):
        size = self.recording()
        self.assertGreater(size, 20e6)
        self.succeeds("data", "synthesize", "drive", "--out", "small.h5")
        idle = self.peak("data", "info", "small.h5")
        self.assertLess(self.peak("data", "info", "long.h5") - idle, 1.5 * size)
        self.assertLess(self.peak("data", "cut", "long.h5", "--trial", "a", "--window", "10:200", "--as", "d") - idle, 2.6 * size)
        self.assertLess(self.peak("data", "drop", "long.h5", "--trial", "d") - idle, 2.6 * size)
        self.assertLess(self.peak("data", "check", "long.h5", "--mask", "auto", "--out", "masked.h5") - idle, 2.9 * size)
        with h5py.File(self.path("masked.h5")) as masked, h5py.File(self.path("long.h5")) as long:
            values = masked["trials/a/sensors/channels/z"][:]
            self.assertTrue(np.isnan(values[2000:59000]).all())
            np.testing.assert_array_equal(values[60000:], long["trials/a/sensors/channels/z"][60000:])
            np.testing.assert_array_equal(masked["trials/b/sensors/channels/s"][:], long["trials/b/sensors/channels/s"][:])


if __name__ == "__main__":
    unittest.main()

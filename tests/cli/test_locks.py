"""Two commands at once change the same file: one after the other, or not at all.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_locks.py
"""
import fcntl
import json
import os
import time
import unittest

from laboratory_files import mot
from program import LONGEST, ProgramTest

AT_ONCE = 8


class Locks(ProgramTest):
    def trials(self, name):
        return sorted(json.loads(self.succeeds("data", "info", name, "--json"))["trials"])

    def test_no_trial_is_lost(self):
        self.write("walk.mot", mot())
        names = [f"trial_{i}" for i in range(AT_ONCE)]
        running = [self.start("data", "import", "walk.mot", "--out", "walk.h5", "--append", "--trial", name) for name in names]
        for program in running:
            _, errors = program.communicate(timeout=LONGEST)
            self.assertEqual((program.returncode, errors), (0, ""))
        self.assertEqual(self.trials("walk.h5"), names)
        dropping = [self.start("data", "drop", "walk.h5", "--trial", name) for name in names[1:]]
        for program in dropping:
            _, errors = program.communicate(timeout=LONGEST)
            self.assertEqual((program.returncode, errors), (0, ""))
        self.assertEqual(self.trials("walk.h5"), names[:1])
        self.assertEqual(sorted(os.listdir(self.folder)), ["walk.h5", "walk.mot"], "no lock is left")

    def long_search(self):
        search = self.start("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--solver", "sa", "--quiet")
        self.addCleanup(search.communicate)
        self.addCleanup(lambda: search.poll() is None and search.kill())
        deadline = time.monotonic() + LONGEST
        # Its process stands in it a moment after it is there.
        while not any(lock.stat().st_size for lock in self.folder.glob(".sinew-*.lock")):
            self.assertLess(time.monotonic(), deadline, "no lock")
            time.sleep(0.01)
        return search

    def test_two_searches_into_one_file(self):
        self.stances()
        search = self.long_search()
        done = self.run_program("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--solver", "lm")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, f"^sinew: error: run.h5: is being written by process {search.pid} on .*; wait for it, or "
                                      "write another file\n$")
        search.kill()
        search.wait()
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--solver", "lm", "--quiet",
                      "--intervals", "linear")
        self.assertEqual(sorted(os.listdir(self.folder)), ["run.h5", "stances.h5"], "what the killed one left is gone")

    def test_waiting_is_said(self):
        self.stances()
        search = self.long_search()
        lock = next(iter(self.folder.glob(".sinew-*.lock")))
        search.kill()
        search.wait()
        with lock.open("r+") as file:  # as another machine would hold it
            fcntl.flock(file, fcntl.LOCK_EX)
            waiting = self.start("data", "synthesize", "drive", "--out", "run.h5")
            time.sleep(5)  # two of them until it says so; a busy machine needs a while to begin
            self.assertIsNone(waiting.poll())
        said, errors = waiting.communicate(timeout=LONGEST)
        self.assertEqual(waiting.returncode, 0)
        self.assertIn("run.h5", said)
        self.assertRegex(errors, "^note: waiting for process .*, which is changing run.h5\n$")


if __name__ == "__main__":
    unittest.main()

"""A disk without room: one line says so, the old file stays, nothing half-written is left, and no signal ends anything.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_full_disk.py
"""
import os
import resource
import signal
import subprocess
import unittest

import h5py

from laboratory_files import mot
from program import LONGEST, PROGRAM, ProgramTest, contents

SMALL = 4096  # [bytes] a file of these tests needs more
IDENTIFY = ("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--quiet")


class FullDisk(ProgramTest):
    """The limit of a file's size stands for the disk: writing fails at the same place, for another reason."""

    def setUp(self):
        super().setUp()
        self.stances()

    def run_limited(self, *words, limit=SMALL, disposition=signal.SIG_IGN):
        def restrict():
            signal.signal(signal.SIGXFSZ, disposition)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        return subprocess.run([PROGRAM, *map(str, words)], cwd=self.folder, capture_output=True, text=True, timeout=LONGEST,
                              check=False, restore_signals=False, preexec_fn=restrict)

    def has_no_room(self, name, *words, **how):
        before = contents(self.folder)
        done = self.run_limited(*words, **how)
        self.assertEqual((done.returncode, done.stderr),
                         (2, f"sinew: error: {name}: cannot be written: File too large\n"), words)
        self.assertEqual(contents(self.folder), before, "something was written")

    def test_for_each_kind_of_file(self):
        self.has_no_room("new.h5", "data", "synthesize", "contact", "--out", "new.h5")
        self.has_no_room("sim.h5", "simulate", "contact", "--data", "stances.h5", "--out", "sim.h5")
        self.has_no_room("sim_train_1.sto", "simulate", "contact", "--data", "stances.h5", "--out", "sim.sto")
        self.has_no_room("run.h5", *IDENTIFY)
        self.write("walk.mot", mot(rows=[(0.01 * i, i, 2 * i) for i in range(2000)]))
        self.has_no_room("walk.h5", "data", "import", "walk.mot", "--out", "walk.h5")

    def test_also_where_the_signal_would_end_the_process(self):
        self.has_no_room("new.h5", "data", "synthesize", "contact", "--out", "new.h5", disposition=signal.SIG_DFL)

    def test_the_old_file_stays(self):
        self.succeeds(*IDENTIFY, "--solver", "sa", "--max-evaluations", 100)
        self.has_no_room("run.h5", *IDENTIFY)
        self.has_no_room("stances.h5", "data", "drop", "stances.h5", "--trial", "train_1")

    def test_json_too(self):
        done = self.run_limited(*IDENTIFY, "--json", "run.json", limit=1000)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.write("run.json", "{}")
        done = self.run_limited("mbs", "A01", "--json", "run.json", limit=100)
        self.assertEqual((done.returncode, done.stderr),
                         (2, "sinew: error: run.json: cannot be written: File too large\n"))
        self.assertEqual(self.path("run.json").read_text(), "{}")

    def test_standard_output(self):
        for words in (("mbs", "A01", "--json", "-"), ("list", "solvers"), ("--help",)):
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=LONGEST,
                                      check=False)
            self.assertEqual((done.returncode, done.stderr), (2, "sinew: error: standard output cannot be written: No space left on device\n"))

    def test_closed_standard_output(self):
        """No file that is opened may take its number: what is printed would land in it."""
        done = subprocess.run([PROGRAM, *IDENTIFY, "--solver", "lm", "--intervals", "linear"], cwd=self.folder,
                              stderr=subprocess.PIPE, text=True, timeout=LONGEST, check=False, preexec_fn=lambda: os.close(1))
        self.assertEqual((done.returncode, done.stderr),
                         (2, "sinew: error: standard output cannot be written: Bad file descriptor\n"))
        with h5py.File(self.path("run.h5")) as run:
            self.assertEqual(run["run"].attrs["finished"], 1)

    def test_a_checkpoint_alone(self):
        """The search goes on, says so, and ends as if nothing had been: by its own status, not by a signal."""
        done = self.run_limited(*IDENTIFY, "--solver", "sa", "--max-seconds", 3)
        self.assertEqual(done.returncode, 2, done.stderr)
        lines = " ".join(done.stderr.split())
        self.assertIn("warning: this run continues without checkpoints: run.h5: cannot be written: File too large", lines)
        self.assertTrue(lines.endswith("sinew: error: run.h5: cannot be written: File too large"), lines)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["stances.h5"])


if __name__ == "__main__":
    unittest.main()

"""Several processes with one work: `mpirun -n N sinew ...` finds what one process finds, to the last bit.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_ranks.py
"""
import json
import os
import re
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

import h5py

from program import LONGEST, PROGRAM, ProgramTest, differences

MPIRUN = shutil.which("mpirun")
MODULE = Path(PROGRAM).resolve().parent / "sinew_mpi.so"
# The tests run as root in a container, and machines have fewer cores than ranks.
LAUNCH = ("mpirun", "--allow-run-as-root", "--oversubscribe", "-n")
# Open MPI itself leaks, which a build with the address sanitizer would report.
ENVIRONMENT = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}
MISFIT = ("synthesize", "drive", "--seed", "8", "--set", "train=2", "--set", "validate=1", "--set", "duration=2", "--set", "rate=100",
          "--set", "position_noise=0.0001", "--effect", "coulomb_friction:value=0.2", "--effect", "position.time_offset:value=0.02")


def without_times(text):
    """What is printed, without how long it took, and without the breaks of lines and the widths of columns that depend on it."""
    return " ".join(re.sub(r"\d[\d.]*(e-?\d+)? (us|ms|s|min)\b", "T", text).split())


def rank_of(pid):
    try:
        variables = Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return None
    return next((int(one.split(b"=")[1]) for one in variables if one.startswith(b"OMPI_COMM_WORLD_RANK=")), None)


def children_of(pid):
    return [int(one) for task in Path(f"/proc/{pid}/task").iterdir() for one in (task / "children").read_text().split()]


@unittest.skipUnless(MPIRUN and MODULE.exists(), "no mpirun, or sinew was built without MPI")
class SeveralProcesses(ProgramTest):
    def together(self, ranks, *words):
        return subprocess.run([*LAUNCH, str(ranks), PROGRAM, *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              env=ENVIRONMENT, timeout=LONGEST, check=False)

    def agree(self, out, *words, ranks=(2, 4)):
        """The command alone, with two threads and with several ranks: the same file and the same words."""
        said = self.succeeds(*words, "--quiet", "--threads", 1, "--out", out)
        self.path(out).rename(self.path("alone.h5"))
        for count, threads in [(1, 2)] + [(n, 1) for n in ranks] + [(2, 2)]:
            with self.subTest(ranks=count, threads=threads):
                done = self.together(count, *words, "--quiet", "--threads", threads, "--out", out)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertEqual(without_times(done.stdout), without_times(said))
                with h5py.File(self.path("alone.h5")) as alone, h5py.File(self.path(out)) as here:
                    self.assertEqual(differences(alone, here), [])
                self.path(out).unlink()

    def test_identify(self):
        data = self.stances()
        self.agree("run.h5", "identify", "contact", "--data", data)

    def test_many_starts(self):
        self.succeeds("data", "synthesize", "nms", "--seed", 2, "--set", "cycles=3", "--out", "nms.h5")
        self.agree("run.h5", "identify", "nms", "--data", "nms.h5", "--solver", "multistart", "--max-evaluations", 600, ranks=(3,))

    def test_diagnose(self):
        self.succeeds("data", "synthesize", "drive", "--seed", 7, "--set", "duration=5", "--effect",
                      "asymmetric_friction:forward_friction=0.16,backward_friction=0.08", "--out", "drive.h5")
        self.agree("why.h5", "diagnose", "drive", "--data", "drive.h5", ranks=(2,))

    def test_diagnose_by_left_out_trials(self):
        self.succeeds("data", *MISFIT, "--out", "misfit.h5")
        self.agree("why.h5", "diagnose", "drive", "--data", "misfit.h5", ranks=(4,))

    def test_compare(self):
        data = self.stances()
        self.agree("study.h5", "compare", "contact", "--data", data, "--solvers", "lm,sa,restarts", "--repeats", 2,
                   "--max-evaluations", 300, ranks=(3,))

    def test_a_wrong_word_is_said_once(self):
        done = self.together(3, "identify", "contact", "--data", "no.h5", "--out", "run.h5")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr.count("sinew: error: "), 1, done.stderr)
        self.assertEqual(done.stdout, "")

    def test_what_is_not_shared_is_done_once(self):
        data = self.stances()
        done = self.together(3, "data", "info", data)
        self.assertEqual((done.returncode, done.stdout), (0, self.succeeds("data", "info", data)), done.stderr)

    def test_a_cohort(self):
        self.write("cohort.yaml", """subjects: {anna: {seed: 4}, bert: {seed: 5}, carl: {seed: 6}, dora: {seed: 7}}
out: results
steps:
  data: data synthesize contact --seed {seed} --set encoders=1 --set train=3 --set validate=1 --out {out}/data.h5
  fit: identify contact --data {data} --solver lm --intervals linear --out {out}/run.h5
""")
        done = self.together(3, "run", "cohort.yaml", "--quiet", "--threads", 1, "--json", "all.json")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.count("steps: 8 done"), 1, done.stdout)
        for number, name in ((4, "anna"), (5, "bert"), (6, "carl"), (7, "dora")):
            self.succeeds("data", "synthesize", "contact", "--seed", number, "--set", "encoders=1", "--set", "train=3", "--set",
                          "validate=1", "--out", "alone.h5")
            self.succeeds("identify", "contact", "--data", "alone.h5", "--solver", "lm", "--intervals", "linear", "--quiet", "--out",
                          "run.h5")
            with h5py.File(self.path("run.h5")) as alone, h5py.File(self.path(f"results/{name}/run.h5")) as here:
                self.assertEqual([one for one in differences(alone, here) if not one.endswith("@data_file")], [])
        again = self.together(2, "run", "cohort.yaml", "--quiet", "--threads", 1)
        self.assertIn("0 done, 8 kept", again.stdout)

    def test_a_failure_on_another_rank_stays_with_its_subject(self):
        self.write("cohort.yaml", "subjects: {a: {x: 1}, b: {x: no}, c: {x: 1}}\nout: results\nsteps:\n"
                                  "  data: data synthesize contact --set encoders={x} --out {out}/data.h5\n")
        done = self.together(3, "run", "cohort.yaml", "--quiet", "--threads", 1, "--json", "all.json")
        self.assertEqual(done.returncode, 1)
        outcomes = {one["subject"]: one["outcome"] for one in json.loads(self.path("all.json").read_text())["tasks"]}
        self.assertEqual(outcomes, {"a": "done", "b": "failed", "c": "done"})

    def begin(self, ranks, *words):
        """Starts it, and waits for its first checkpoint. Returns the launcher and {rank: pid}."""
        launcher = subprocess.Popen([*LAUNCH, str(ranks), PROGRAM, *map(str, words)], cwd=self.folder, stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, env=ENVIRONMENT, text=True)
        self.addCleanup(launcher.wait)
        out = self.path(words[-1])
        until = time.monotonic() + 60
        while not out.exists() and launcher.poll() is None and time.monotonic() < until:
            time.sleep(0.02)
        self.assertTrue(out.exists(), "no checkpoint")
        found = {rank_of(pid): pid for pid in children_of(launcher.pid)}
        return launcher, found

    def interrupted(self, ranks, end):
        """A diagnosis that `end` interrupts after its first checkpoint goes on alone, and ends as one that was not interrupted."""
        self.succeeds("data", *MISFIT, "--out", "misfit.h5")
        words = ("diagnose", "drive", "--data", "misfit.h5", "--quiet", "--threads", 1, "--out")
        self.succeeds(*words, "whole.h5")
        launcher, found = self.begin(ranks, *words, "why.h5")
        end(launcher, found)
        launcher.communicate(timeout=30)
        self.assertNotEqual(launcher.returncode, 0)
        with h5py.File(self.path("why.h5")) as file:
            self.assertGreater(len(file), 0)
        done = self.run_program(*words, "why.h5", "--resume")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with h5py.File(self.path("whole.h5")) as whole, h5py.File(self.path("why.h5")) as resumed:
            self.assertEqual(differences(whole, resumed), [])
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["misfit.h5", "whole.h5", "why.h5"])

    def test_a_killed_rank_leaves_a_file_that_goes_on(self):
        self.interrupted(3, lambda launcher, found: os.kill(found[1], signal.SIGKILL))

    def test_a_killed_rank_zero_leaves_a_file_that_goes_on(self):
        self.interrupted(2, lambda launcher, found: os.kill(found[0], signal.SIGKILL))

    def test_sigterm_to_the_launcher_leaves_a_file_that_goes_on(self):
        self.interrupted(2, lambda launcher, found: launcher.send_signal(signal.SIGTERM))

    def test_sigterm_to_another_rank_changes_nothing(self):
        self.succeeds("data", *MISFIT, "--out", "misfit.h5")
        words = ("diagnose", "drive", "--data", "misfit.h5", "--quiet", "--threads", 1, "--out")
        self.succeeds(*words, "whole.h5")
        launcher, found = self.begin(2, *words, "why.h5")
        os.kill(found[1], signal.SIGTERM)
        _, said = launcher.communicate(timeout=LONGEST)
        self.assertEqual((launcher.returncode, said), (0, ""))
        with h5py.File(self.path("whole.h5")) as whole, h5py.File(self.path("why.h5")) as here:
            self.assertEqual(differences(whole, here), [])


class OneProcess(ProgramTest):
    def test_several_processes_without_the_module(self):
        """They would all write the same file."""
        folder = self.path("elsewhere")
        folder.mkdir()
        shutil.copy(PROGRAM, folder / "sinew")
        done = subprocess.run([folder / "sinew", "list", "problems"], capture_output=True, text=True, timeout=LONGEST, check=False,
                              env={**os.environ, "OMPI_COMM_WORLD_SIZE": "2"})
        if "libmpi" in done.stderr or done.returncode == 0:
            self.skipTest("the module is installed on this machine")
        self.assertEqual(done.returncode, 2)
        self.assertIn("sinew: error: started as one of several processes, but it was built without MPI", done.stderr)

    def test_work_times(self):
        data = self.stances()
        self.succeeds("identify", "contact", "--data", data, "--quiet", "--threads", 1, "--out", "run.h5", "--work-times", "times.json")
        times = json.loads(self.path("times.json").read_text())
        self.assertEqual(times["schema"], "sinew.work_times/1")
        pieces = [seconds for loop in times["loops"] for seconds in loop["pieces"]]
        self.assertGreater(len(pieces), 5)
        self.assertTrue(all(seconds > 0 for seconds in pieces))
        self.assertLess(sum(pieces), times["processor_seconds"])
        for loop in times["loops"]:
            self.assertLessEqual(sum(loop["pieces"]), 1.05 * loop["processor_seconds"] + 0.01)

    def test_work_times_are_no_file_of_another_use(self):
        data = self.stances()
        self.refuses("would be written twice", "identify", "contact", "--data", data, "--out", "run.h5", "--work-times", "run.h5")

"""Every write of a command can fail: one true sentence, status 1 or 2, the old files intact, nothing else left, no crash.

    SINEW_PROGRAM=build/release/sinew SINEW_FAULTS=build/release/tests/cli/libfail_call.so \\
      /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_faults.py

Prints a table: for each command and call, at how many places it was made to fail, with each error.
"""
import errno
import json
import os
import re
import shutil
import subprocess
import unittest

import h5py

from laboratory_files import ceinms_project, mot
from program import LONGEST, PROGRAM, ROOT, ProgramTest, contents
from test_envelope import burst, raw_emg
from test_loads import add_centres_of_pressure
from test_muscles import MODEL, motion
from test_steps import add_walk

FAULTS = os.environ.get("SINEW_FAULTS", "")
FULL = {"open": (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.ENAMETOOLONG, errno.EACCES), "write": (errno.ENOSPC, errno.EDQUOT),
        "fsync": (errno.ENOSPC, errno.EDQUOT), "rename": (errno.ENOSPC, errno.EDQUOT, errno.EROFS)}
SPORADIC = (errno.EIO,)  # once only, as a broken sector
FOREVER = 10**9
SIMULATED = tuple(f"out_{trial}.sto" for trial in ("train_1", "train_2", "validate_1"))
COMMANDS = {
    "data synthesize": (("data", "synthesize", "drive", "--out", "out.h5", "--json", "out.json"), ("out.h5", "out.json")),
    "data import": (("data", "import", "walk.mot", "--out", "walk.h5", "--append", "--trial", "again"), ("walk.h5",)),
    "data cut": (("data", "cut", "drive.h5", "--trial", "train_1", "--window", "0.1:0.3", "--as", "new"), ("drive.h5",)),
    "data split": (("data", "split", "drive.h5", "--every", "0.5"), ("drive.h5",)),
    "simulate": (("simulate", "drive", "--data", "short.h5", "--out", "out.sto"), SIMULATED),
    "identify": (("identify", "drive", "--data", "short.h5", "--solver", "lm", "--intervals", "linear", "--out", "out.h5",
                  "--json", "out.json"), ("out.h5", "out.json")),
    "diagnose": (("diagnose", "drive", "--data", "short.h5", "--out", "out.h5", "--quiet"), ("out.h5",)),
    "compare": (("compare", "drive", "--data", "short.h5", "--solvers", "lm", "--repeats", "2", "--out", "out.h5"), ("out.h5",)),
    "mbs": (("mbs", "A01", "--json", "out.json"), ("out.json",)),
    "list": (("list", "solvers", "--json", "out.json"), ("out.json",)),
    "data drop": (("data", "drop", "drive.h5", "--trial", "train_1", "--json", "out.json"), ("drive.h5", "out.json")),
    "data loads": (("data", "loads", "plates.h5", "--trial", "train_1", "--out", "out.mot", "--setup", "loads.xml"),
                   ("out.mot", "loads.xml")),
    "data check": (("data", "check", "spoilt.h5", "--mask", "auto", "--out", "out.h5"), ("out.h5",)),
    "data stances": (("data", "stances", "stances.h5", "--out", "out.h5"), ("out.h5",)),
    "data dynamics": (("data", "dynamics", "stances.h5"), ("stances.h5",)),
    "data steps": (("data", "steps", "walks.h5", "--config", "soles.yaml", "--trial", "walk"), ("walks.h5",)),
    "data soles": (("data", "soles", "stances.h5", "--out", "out.yaml"), ("out.yaml",)),
    "data muscles": (("data", "muscles", "finger.h5", "--joints", "first"), ("finger.h5",)),
    "data envelope": (("data", "envelope", "emg.h5", "--out", "out.h5"), ("out.h5",)),
    "data ceinms": (("data", "ceinms", "setup.xml", "--out", "out.h5"), ("out.h5",)),
    "data subject": (("data", "subject", "nms_run.h5", "--out", "out.xml"), ("out.xml",)),
}
# Commands that take seconds: one error of each call.
SLOW = {"data kinematics": (("data", "kinematics", "stances.h5", "--quiet"), ("stances.h5",))}


@unittest.skipUnless(os.path.exists(FAULTS), "the library that makes calls fail was not built")
class Faults(ProgramTest):
    def setUp(self):
        super().setUp()
        self.folder = self.folder.resolve()
        self.path("files").mkdir()
        self.home, self.folder = self.folder, self.path("files")
        self.succeeds("data", "synthesize", "drive", "--out", "drive.h5", "--seed", 3)
        self.write("walk.mot", mot())
        self.succeeds("data", "import", "walk.mot", "--out", "walk.h5")

    def inputs_of_data_commands(self):
        self.stances()
        # Short: a slow build with a sanitizer, too, shall end before its first checkpoint, which is another write.
        self.succeeds("data", "synthesize", "drive", "--out", "short.h5", "--seed", 3, "--set", "train=2", "--set", "validate=1",
                      "--set", "duration=0.5", "--set", "rate=100")
        with h5py.File(self.path(self.stances("walks.h5")), "r+") as file:
            add_walk(file)
        self.settings(name="soles.yaml")
        with h5py.File(self.path(self.stances("plates.h5")), "r+") as file:
            add_centres_of_pressure(file)
        self.succeeds("data", "synthesize", "drive", "--out", "spoilt.h5", "--seed", 4)
        with h5py.File(self.path("spoilt.h5"), "r+") as file:
            values = next(iter(file["trials/train_1"].values()))["channels/position"]
            values[100:104] = values[100:104] + 3
        self.write("finger.osim", re.sub(r'<Thelen2003Muscle name="odd">.*?</Thelen2003Muscle>', "", MODEL, flags=re.DOTALL))
        self.write("bend.mot", motion(("first", "second"), [(0.1 * i, 5 * i, i) for i in range(9)]))
        self.succeeds("data", "import", "bend.mot", "finger.osim", "--out", "finger.h5")
        with h5py.File(self.path("emg.h5"), "w") as file:
            file.attrs["sinew_schema"] = "dataset/1"
            file["trials/walk/emg/time"], values = raw_emg(burst(2), 1)
            file["trials/walk"].attrs["role"] = "train"
            file["trials/walk/emg/channels/soleus"] = values
            file["trials/walk/emg/channels/soleus"].attrs.update({"unit": "V", "kind": "measured"})
        with h5py.File(self.path("nms_run.h5"), "w") as file:
            file["details/subject"] = "<subject/>"
        for name, text in ceinms_project().items():
            self.write(name, text)

    def run_failing(self, words, call, first, last, number):
        mark = self.home / "mark"
        mark.unlink(missing_ok=True)
        faults = {"LD_PRELOAD": FAULTS, "SINEW_FAULT_CALL": call, "SINEW_FAULT_AT": str(first), "SINEW_FAULT_LAST": str(last),
                  "SINEW_FAULT_ERRNO": str(number), "SINEW_FAULT_FOLDER": str(self.folder), "SINEW_FAULT_MARK": str(mark),
                  "ASAN_OPTIONS": "verify_asan_link_order=0"}  # a build with the address sanitizer
        done = subprocess.run([PROGRAM, *words], cwd=self.folder, env={**os.environ, **faults}, capture_output=True, text=True,
                              timeout=LONGEST, check=False)
        return done, mark.exists()

    def is_whole(self, name):
        if name.endswith(".h5"):
            with h5py.File(self.path(name)) as file:
                self.assertGreater(len(file), 0)
        elif name.endswith(".json"):
            json.loads(self.path(name).read_text())
        elif name.endswith(".yaml"):
            self.assertIn("regions:", self.path(name).read_text())
        elif name.endswith(".xml"):
            self.assertIn(self.path(name).read_text()[-20:].strip(), ("<subject/>", "</OpenSimDocument>"))
        else:
            self.assertIn("endheader", self.path(name).read_text())

    def check(self, done, outputs, changed, number):
        """What a failed command may leave: old files, and files that were whole before the failure."""
        self.assertIn(done.returncode, (1, 2), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("cannot be written", done.stderr.replace("is written, but", "cannot be written"))
        said = os.strerror(number).lower()
        self.assertTrue(said in done.stderr.lower() or number == errno.EACCES and "permission" in done.stderr, done.stderr)
        for path in changed:
            self.assertTrue(self.path(path).exists(), f"{path} is lost")
            self.assertIn(str(path), outputs, "a file of no result is left")
            self.is_whole(str(path))

    def places(self, words, outputs, call, number, once, tried=None):
        """Fails the command at its 1st, 2nd, ... such call, until it makes fewer, or at those tried. Returns how many there were."""
        old = contents(self.folder)
        for place in tried or range(1, 100):
            done, failed = self.run_failing(words, call, place, place if once else FOREVER, number)
            left = contents(self.folder)
            changed = [path for path in {**old, **left} if left.get(path) != old.get(path)]
            with self.subTest(f"{' '.join(words)}: {call} {place} fails with {errno.errorcode[number]}"):
                if not failed:
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                else:
                    self.check(done, outputs, changed, number)
            for path in changed:
                if path in old:
                    self.write(path, old[path])
                else:
                    self.path(path).unlink()
            if not failed:
                return place - 1
        self.assertIsNotNone(tried, "no end")
        return tried[-1]

    def of_command(self, name, words, outputs, slow=False):
        """Lines of the table."""
        lines = []
        sporadic = () if slow else SPORADIC
        made = [output for output in outputs if not self.path(output).exists()]
        for existing in ((False, True) if made and not slow else (True,)):
            for output in made if existing else ():
                self.write(output, "old")
            for call, numbers in FULL.items():
                numbers = numbers if existing and not slow else numbers[:1]
                counts = {self.places(words, outputs, call, numbers[0], False)}
                counts |= {self.places(words, outputs, call, number, True) for number in sporadic}
                self.assertEqual(len(counts), 1)
                last = max(counts)
                self.assertGreater(last, 0, f"{name} never calls {call}")
                # Other errors differ in their words only: at the first and the last such call.
                for number in numbers[1:]:
                    self.assertEqual(self.places(words, outputs, call, number, False, sorted({1, last})), last)
                if existing:
                    said = " ".join(errno.errorcode[number] for number in (*numbers, *sporadic))
                    lines.append(f"{name:16}{call:8}{last:6}  {said}")
        for output in made:
            self.path(output).unlink()
        return lines

    def test_every_write_of_every_command(self):
        self.inputs_of_data_commands()
        lines = [f"{'command':16}{'call':8}places  errors"]
        for name, (words, outputs) in COMMANDS.items():
            lines += self.of_command(name, words, outputs)
        for name, (words, outputs) in SLOW.items():
            lines += self.of_command(name, words, outputs, slow=True)
        print("\n".join(lines), flush=True)

    def test_no_command_that_writes_is_missing(self):
        """The page of the command line lists what commands write; report and run have tests of their own, data info writes to standard output."""
        page = (ROOT / "docs" / "command_line.md").read_text()
        rows = [row for row in page.splitlines() if row.startswith("| `")]
        named = {name for row in rows[:rows.index(next(row for row in rows if row.startswith("| `mbs`"))) + 1]
                 for name in re.findall(r"`([a-z ]+)`", row.split("|")[1])}
        self.assertEqual(named - set(COMMANDS) - set(SLOW), {"data info", "report", "run"})

    def test_one_checkpoint(self):
        """The search goes on and says so, and its answer finds room: nothing else is the matter."""
        words = ("identify", "drive", "--data", "drive.h5", "--solver", "sa", "--max-seconds", "4", "--intervals", "linear",
                 "--out", "out.h5", "--quiet")
        done, failed = self.run_failing(words, "write", 1, 1, errno.ENOSPC)
        self.assertTrue(failed)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(" ".join(done.stderr.split()),
                         "warning: this run continues without checkpoints: out.h5: cannot be written: No space left on device")
        with h5py.File(self.path("out.h5")) as run:
            self.assertEqual(run["run"].attrs["finished"], 1)
        self.assertEqual(sorted(os.listdir(self.folder)), ["drive.h5", "out.h5", "walk.h5", "walk.mot"])

    def test_report(self):
        self.succeeds("identify", "drive", "--data", "drive.h5", "--solver", "lm", "--intervals", "linear", "--out", "run.h5",
                      "--quiet")
        self.path("page").mkdir()
        self.write("page/index.html", "old")
        self.write("page/index.ipynb", "old")
        before = contents(self.folder)
        # One error of each call: a report takes seconds, and other errors differ in their words only.
        for call, number in (("open", errno.EROFS), ("write", errno.ENOSPC), ("fsync", errno.EIO), ("rename", errno.ENAMETOOLONG)):
            done, failed = self.run_failing(("report", "run.h5", "--out-dir", "page"), call, 1, FOREVER, number)
            self.assertTrue(failed)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertIn(f"cannot be written: {os.strerror(number)}", done.stderr)
            self.assertEqual(contents(self.folder), before)

    def test_run_of_a_cohort(self):
        """A step that could not write fails with its reason; a record that could not be written ends the run."""
        self.write("cohort.yaml", "subjects: [anna]\nout: results\nsteps:\n  data: data synthesize drive --out {out}/data.h5\n")
        words = ("run", "cohort.yaml", "--quiet", "--threads", "1")
        lines = []
        for call, numbers in FULL.items():
            for number in (*numbers[:2], *SPORADIC):
                for place in range(1, 100):
                    shutil.rmtree(self.path("results"), ignore_errors=True)
                    done, failed = self.run_failing(words, call, place, FOREVER, number)
                    if not failed:
                        break
                    with self.subTest(f"run: {call} {place} fails with {errno.errorcode[number]}"):
                        self.assertIn(done.returncode, (1, 2), done.stderr)
                        self.assertIn(os.strerror(number), done.stderr + done.stdout)
                        left = [path for path in contents(self.folder) if path.name.startswith(".sinew-")]
                        self.assertEqual(left, [])
                        if self.path("results/anna/data.h5").exists():
                            self.is_whole("results/anna/data.h5")
                        again = self.run_program(*words)
                        self.assertEqual(again.returncode, 0, again.stderr)
                self.assertGreater(place, 1, f"run never calls {call}")
                lines.append(f"{'run':16}{call:8}{place - 1:6}  {errno.errorcode[number]}")
        print("\n".join(lines), flush=True)


if __name__ == "__main__":
    unittest.main()

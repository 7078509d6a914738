"""The program as a user runs it, each test in a folder of its own."""
import functools
import os
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SINEW_PROGRAM", str(ROOT / "build" / "release" / "sinew"))
# [s] of one command: a diagnosis where the misfit is large takes minutes on a busy machine, more with a sanitizer.
LONGEST = 600 * int(os.environ.get("SINEW_TIMES_AS_LONG", "1"))


@functools.lru_cache(maxsize=None)
def _made_once():
    """Five synthetic stances with joint angles; made once per process, because every test copies them."""
    folder = tempfile.TemporaryDirectory()
    path = Path(folder.name) / "stances.h5"
    subprocess.run([PROGRAM, "data", "synthesize", "contact", "--set", "encoders=1", "--out", path], check=True,
                   capture_output=True, timeout=LONGEST)
    return folder, path


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}


class ProgramTest(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="sinew_cli_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return self.folder / name

    def write(self, name, text):
        data = text if isinstance(text, bytes) else text.encode()
        self.path(name).write_bytes(data)

    def stances(self, name="stances.h5"):
        shutil.copy(_made_once()[1], self.path(name))
        return name

    def changed_stances(self, change, name="stances.h5"):
        """A copy of the stances on which change(h5py.File) was done."""
        self.stances(name)
        with h5py.File(self.path(name), "r+") as file:
            change(file)
        return name

    def settings(self, old="", new="", name="settings.yaml"):
        """The settings inside the stances as a file of their own, with one piece of the text replaced."""
        self.stances("settings_source.h5")
        with h5py.File(self.path("settings_source.h5")) as file:
            text = file["files/contact.yaml"][()].decode()
        self.path("settings_source.h5").unlink()
        self.assertIn(old, text)
        self.write(name, text.replace(old, new))
        return name

    def start(self, *words):
        # A shell without job control starts what is in the background, such as these tests, with SIGINT ignored.
        return subprocess.Popen([PROGRAM, *map(str, words)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))

    def run_program(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], cwd=self.folder, capture_output=True, text=True,
                              timeout=LONGEST, check=False)

    def succeeds(self, *words):
        """Runs the program; returns what it wrote to standard output."""
        done = self.run_program(*words)
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return done.stdout

    def fails(self, message, *words):
        """Status 2, one line on standard error, nothing on standard output, no file written or changed."""
        before = contents(self.folder)
        done = self.run_program(*words)
        self.assertEqual(done.stderr, f"sinew: error: {message}\n", words)
        self.assertEqual((done.returncode, done.stdout), (2, ""), words)
        self.assertEqual(contents(self.folder), before, "something was written")

    def refuses(self, part, *words):
        """As fails, of a message that holds these words."""
        before = contents(self.folder)
        done = self.run_program(*words)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertEqual(done.stderr.count("sinew: error: "), 1, done.stderr)
        self.assertIn(part, done.stderr)
        self.assertEqual(contents(self.folder), before, "something was written")


def replace_text(file, path, text):
    del file[path]
    file[path] = text


def differences(a, b, where=""):
    """Where two HDF5 objects differ, bit for bit; NaN equals NaN. Times (`seconds`, `seconds_...`) are not compared."""
    found = [f"{where}@{name}" for name in sorted(set(a.attrs) | set(b.attrs)) if not _is_time(name)
             and not (name in a.attrs and name in b.attrs and _same(a.attrs[name], b.attrs[name]))]
    if type(a) is not type(b):
        return found + [where]
    if isinstance(a, h5py.Dataset):
        return found + ([] if _same(a[()], b[()]) else [where])
    for name in sorted(set(a) | set(b)):
        if _is_time(name):
            continue
        place = f"{where}/{name}"
        found += differences(a[name], b[name], place) if name in a and name in b else [place]
    return found


def _is_time(name):
    return name == "seconds" or name.startswith("seconds_")


def _same(a, b):
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype != b.dtype or a.shape != b.shape:
        return False
    return bool(np.array_equal(a, b, equal_nan=a.dtype.kind == "f"))

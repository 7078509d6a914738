"""Files of somebody else: they read no other file of the user, do not command the terminal, and do not hang the program.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_hostile_files.py
"""
import json
import os
import re
import resource
import unittest

import h5py
import numpy as np

from laboratory_files import mot
from program import ProgramTest

SEARCH = ("--solver", "lm", "--intervals", "linear", "--quiet")
ESCAPE = "\x1b]0;owned\x07\x1b[2J\x7f\u009b31m\u202e"


class OtherFiles(ProgramTest):
    """The user's file is secret.h5; what the stranger's leads to is not opened."""

    def setUp(self):
        super().setUp()
        self.stances()
        with h5py.File(self.path("secret.h5"), "w") as file:
            file["numbers"] = np.arange(5.0)
            file["text"] = "private"
        self.path("secret.bin").write_bytes(np.arange(5.0).tobytes())

    def changed(self, name, change):
        self.changed_stances(change, name)
        return name

    def test_are_not_linked(self):
        def link(file):
            file["files/notes"] = h5py.ExternalLink("secret.h5", "/text")

        self.fails("a.h5: /files: member 'notes' is a link to another file, expected the data themselves", "data", "info",
                   self.changed("a.h5", link))

    def test_are_not_reached_by_a_link_within(self):
        def link(file):
            file["zz"] = h5py.ExternalLink("secret.h5", "/")
            file["files/a"] = h5py.SoftLink("/zz/text")  # comes before it in the order of reading

        self.fails("a.h5: /files: member 'a' cannot be read (truncated file?)", "data", "info", self.changed("a.h5", link))

    def test_do_not_hold_the_numbers(self):
        def outside(file):
            file.create_dataset("constants/mine", shape=(5,), dtype="f8", external=[("secret.bin", 0, 40)])

        def virtual(file):
            layout = h5py.VirtualLayout(shape=(5,), dtype="f8")
            layout[:] = h5py.VirtualSource("secret.h5", "numbers", shape=(5,))
            file.create_virtual_dataset("constants/mine", layout)

        for change in (outside, virtual):
            self.fails("a.h5: /constants/mine: its numbers are in another file, expected them in this one", "data", "info",
                       self.changed("a.h5", change))

    def test_are_not_drawn(self):
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", *SEARCH)
        data = self.path("run.h5").read_bytes()

        def link(file):
            del file["run/findings"]
            file["run/findings"] = h5py.ExternalLink("secret.h5", "/text")

        def outside(file):
            file.create_dataset("mine", shape=(5,), dtype="f8", external=[("secret.bin", 0, 40)])

        for change, message in ((link, "run.h5: /run: member 'findings' is a link, expected the data themselves"),
                                (outside, "run.h5: /mine: its numbers are in another file, expected them in this one")):
            self.path("run.h5").write_bytes(data)
            with h5py.File(self.path("run.h5"), "r+") as file:
                change(file)
            self.fails(message, "report", "run.h5", "--out-dir", "page")


class MuchOfLittle(ProgramTest):
    """Files that are small, and would take all memory if they were believed."""

    def test_texts_that_share_their_characters(self):
        """A text of 1 MB to which 40,000 references lead: 40 GB. The references of an array stand one after the other."""
        count = 40000
        with h5py.File(self.path("a.h5"), "w") as file:
            texts = file.create_dataset("texts", (count,), dtype=h5py.string_dtype())
            texts[0] = "x" * 1000000
            at = texts.id.get_offset()
        data = bytearray(self.path("a.h5").read_bytes())
        data[at:at + 16 * count] = data[at:at + 16] * count
        self.write("a.h5", bytes(data))
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.refuses("a.h5: ", "data", "info", "a.h5")
        after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.assertLess(after - before, 1000000, "kilobytes")

    def test_aliases_of_settings(self):
        laughs = "l0: &l0 lol\n" + "".join(f"l{i}: &l{i} [{', '.join([f'*l{i - 1}'] * 10)}]\n" for i in range(1, 12))
        self.write("laughs.yaml", laughs)
        self.write("walk.mot", mot())
        self.stances()
        said = "laughs.yaml:1: its aliases stand for more than 67108864 characters"
        self.fails(said, "identify", "contact", "--data", "stances.h5", "--config", "laughs.yaml", "--out", "a.h5")
        self.fails(said, "data", "import", "walk.mot", "--map", "laughs.yaml", "--out", "a.h5")
        self.fails(said, "run", "laughs.yaml")

    def test_meshes_of_settings(self):
        """1000 x 1000 strips took 1.3 GB."""
        self.stances()
        with h5py.File(self.path("stances.h5")) as file:
            text = file["files/contact.yaml"][()].decode()
        name = "settings.yaml"
        self.write(name, re.sub(r"strips: \[[0-9, ]*\]", "strips: [1000, 1000]", text))
        self.refuses("1000 x 1000 strips make 1000000 cells, expected at most 50000", "identify", "contact", "--data", "stances.h5",
                     "--config", name, "--out", "a.h5")


class NoRegularFiles(ProgramTest):
    def test_are_refused_at_once(self):
        os.mkfifo(self.path("pipe.mot"))
        self.write("walk.mot", mot())
        self.stances()
        refused = "is a device, a pipe or a socket, expected a regular file"
        self.fails(f"pipe.mot: {refused}", "data", "import", "pipe.mot", "--out", "a.h5")
        for device in ("/dev/zero", "/dev/null"):
            os.symlink(device, self.path("endless.csv"))
            self.fails(f"endless.csv: {refused}", "data", "import", "endless.csv", "--out", "a.h5")
            self.path("endless.csv").unlink()
        for option in ("--map", "--external-loads"):
            self.fails(f"pipe.mot: {refused}", "data", "import", "walk.mot", option, "pipe.mot", "--out", "a.h5")
        self.fails(f"pipe.mot: {refused}", "identify", "contact", "--data", "stances.h5", "--config", "pipe.mot", "--out", "a.h5")
        self.fails("pipe.mot: is a device, a pipe or a socket, expected an HDF5 file", "data", "info", "pipe.mot")
        self.fails("pipe.mot: is a device, a pipe or a socket, expected a file that sinew identify, diagnose or compare wrote",
                   "report", "pipe.mot", "--out-dir", "page")


class ControlCharacters(ProgramTest):
    def is_harmless(self, text):
        bad = [c for c in text if c != "\n" and (ord(c) < 32 or 127 <= ord(c) < 160 or c == "\u202e")]
        self.assertEqual(bad, [], text)

    def test_do_not_reach_the_terminal(self):
        def rename(file):
            file.attrs["title"] = f"title{ESCAPE}"
            file.move("trials/train_1", f"trials/train{ESCAPE}\nsinew: error: forged")

        self.changed_stances(rename)
        commands = (("data", "info", "stances.h5"), ("data", "info", "stances.h5", "--json"), ("data", "check", "stances.h5"),
                    ("data", "drop", "stances.h5", "--trial", "absent"),
                    ("identify", "contact", "--data", "stances.h5", "--out", "run.h5", *SEARCH),
                    ("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--json", "-", *SEARCH),
                    ("simulate", "contact", "--data", "stances.h5", "--out", "sim.h5", "--quiet"),
                    ("diagnose", "contact", "--data", "stances.h5", "--out", "d.h5", "--quiet"),
                    ("compare", "contact", "--data", "stances.h5", "--out", "c.h5", "--solvers", "lm", "--repeats", 1, "--quiet"))
        named = 0
        for words in commands:
            done = self.run_program(*words)
            self.assertLess(done.returncode, 3, done.stderr)
            self.is_harmless(done.stdout)
            self.is_harmless(done.stderr)
            named += "1b]0;owned" in done.stdout + done.stderr
            self.assertNotIn("\nsinew: error: forged", done.stdout)
        self.assertGreater(named, 4)
        found = json.loads(self.succeeds("data", "info", "stances.h5", "--json"))
        self.assertEqual(found["title"], f"title{ESCAPE}", "JSON means the same")

    def test_nor_other_text_files(self):
        def rename(file):
            file.move("trials/train_1", "trials/train\ttab\nline")

        self.changed_stances(rename)
        done = self.run_program("simulate", "contact", "--data", "stances.h5", "--out", "sim.sto", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        written = next(path for path in self.folder.iterdir() if "tab" in path.name)
        self.assertEqual(written.read_text().splitlines()[:2], ["train\\ttab\\nline", "version=1"])

    def test_of_words_of_the_command_line(self):
        done = self.run_program("data", "info", f"no{ESCAPE}.h5")
        self.assertEqual(done.returncode, 2)
        self.is_harmless(done.stderr)

    def test_of_a_report(self):
        self.stances()
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", *SEARCH)
        with h5py.File(self.path("run.h5"), "r+") as file:
            verdicts = file["uncertainty/verdict"]
            verdicts[0] = f"good{ESCAPE}"
        done = self.run_program("report", "run.h5", "--out-dir", "page")
        self.assertEqual(done.returncode, 2)
        self.is_harmless(done.stderr)
        self.assertIn("owned", done.stderr)

    def test_is_text_in_a_page(self):
        """Names and titles are no elements of the page that a report writes."""
        attack = "<img src=x onerror=alert(1)>"

        def rename(file):
            file.attrs["title"] = f"</title><script>alert(1)</script>{attack}"
            file.move("trials/train_1", f"trials/{attack}")

        self.changed_stances(rename)
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", *SEARCH)
        self.succeeds("report", "run.h5", "--out-dir", "page")
        page = self.path("page/index.html").read_text()
        self.assertIn("&lt;script&gt;alert(1)", page)
        for element in (attack, "<script>alert"):
            self.assertNotIn(element, page)


if __name__ == "__main__":
    unittest.main()

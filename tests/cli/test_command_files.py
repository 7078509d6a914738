"""No command overwrites what it reads, writes two results into one file, or takes the place of a device.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_command_files.py
"""
import json
import os
import shutil
import unittest
from pathlib import Path

from laboratory_files import mot
from program import ROOT, ProgramTest, contents

CEINMS = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "ceinms_example"
MOTION = "walk.mot"

# Of every command: its words without outputs, the files that it reads, its options that name an output, and --json.
COMMANDS = (
    (("identify", "contact", "--data", "data.h5", "--config", "c.yaml"), ("data.h5", "c.yaml"), ("--out",), True),
    (("diagnose", "contact", "--data", "data.h5", "--config", "c.yaml", "--from", "run.h5"), ("data.h5", "c.yaml", "run.h5"),
     ("--out",), True),
    (("compare", "contact", "--data", "data.h5", "--config", "c.yaml", "--solvers", "lm"), ("data.h5", "c.yaml"), ("--out",),
     True),
    (("simulate", "nms", "--data", "data.h5", "--config", "c.h5", "--from", "run.h5", "--excitations", "emg.h5"),
     ("data.h5", "c.h5", "run.h5", "emg.h5"), ("--out",), True),
    (("data", "synthesize", "contact"), (), ("--out",), True),
    (("data", "import", "a.mot", "b.trc", "--map", "c.yaml", "--external-loads", "x.xml"), ("a.mot", "b.trc", "c.yaml", "x.xml"),
     ("--out",), True),
    (("data", "ceinms", "setup.xml", "--execution", "x.xml"), ("setup.xml", "x.xml"), ("--out",), True),
    (("data", "subject", "run.h5"), ("run.h5",), ("--out",), False),
    (("data", "muscles", "data.h5", "--model", "m.osim", "--joints", "knee"), ("m.osim",), ("--out",), True),
    (("data", "muscles", "data.h5", "--joints", "knee"), ("data.h5",), (), True),
    (("data", "envelope", "data.h5"), ("data.h5",), (), True),
    (("data", "kinematics", "data.h5", "--model", "m.osim", "--weights", "x.xml"), ("data.h5", "m.osim", "x.xml"), (), True),
    (("data", "cut", "data.h5", "--trial", "a", "--window", "0:1", "--as", "b"), ("data.h5",), (), True),
    (("data", "split", "data.h5", "--every", "1"), ("data.h5",), (), True),
    (("data", "drop", "data.h5", "--trial", "a"), ("data.h5",), (), True),
    (("data", "loads", "data.h5", "sim.h5", "--setup", "x.xml"), ("data.h5", "sim.h5"), ("--out",), True),
    (("mbs", "A01", "--reference", "folder"), ("folder/A01_reference_x.csv",), (), True),
)


class CommandFiles(ProgramTest):
    def setUp(self):
        super().setUp()
        self.path("folder").mkdir()
        for _, inputs, _, _ in COMMANDS:
            for name in inputs:
                self.write(name, "what is lost if it is overwritten")

    def each(self):
        """Every command, and complete words for its outputs other than the one that is asked about."""
        for words, inputs, options, has_json in COMMANDS:
            for option in (*options, *(("--json",) if has_json else ())):
                others = [word for other in options if other != option for word in (other, "other.h5")]
                yield (*words, *others, option), inputs

    def test_no_output_is_an_input(self):
        for words, inputs in self.each():
            for name in inputs:
                self.fails(f"{name}: is read by this command, expected another file to write", *words, name)

    def test_not_even_under_another_name(self):
        os.symlink("run.h5", self.path("link.h5"))
        os.link(self.path("run.h5"), self.path("second.h5"))
        os.symlink(".", self.path("here"))
        words = ("simulate", "contact", "--data", "data.h5", "--from", "run.h5", "--out")
        for name in ("./run.h5", "folder/../run.h5", "here/run.h5", self.path("run.h5"), "link.h5", "second.h5"):
            self.fails(f"{name}: is read by this command, expected another file to write", *words, name)

    def test_two_results_are_two_files(self):
        os.symlink(".", self.path("here"))
        for words, _, options, has_json in COMMANDS:
            if not has_json or not options:
                continue
            for name in ("q.h5", "./q.h5", "here/q.h5", self.path("q.h5")):
                with self.subTest(f"{words[:2]} {name}"):
                    self.fails(f"{name}: would be written twice by this command, expected different files", *words, "--out",
                               "q.h5", "--json", name)

    def test_a_device_or_a_pipe_is_not_replaced(self):
        os.mkfifo(self.path("pipe.h5"))
        for words, _ in self.each():
            names = ("pipe.h5",) if words[0] == "simulate" else ("/dev/null", "/dev/full", "pipe.h5")
            for name in names:
                before = contents(self.folder)
                done = self.run_program(*words, name)
                self.assertEqual((done.returncode, done.stderr), (2, f"sinew: error: {name}: is a device, a pipe or a "
                                                                     "socket, expected a regular file to write\n"))
                self.assertEqual(contents(self.folder), before)
        self.assertTrue(self.path("pipe.h5").is_fifo())
        self.assertTrue(Path("/dev/null").is_char_device())

    def test_an_output_has_a_name(self):
        for words, _ in self.each():
            done = self.run_program(*words, "")
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            if words[-1] == "--out" and words[0] != "simulate":
                self.fails("-: expected the name of a file to write; standard output takes JSON only", *words, "-")
        self.assertFalse(self.path("-").exists())


    def test_a_name_that_no_file_can_have_is_known_before_the_work(self):
        name = "a" * 253 + ".h5"
        for words, _ in self.each():
            self.fails(f"{name}: its name is too long, expected at most 255 bytes", *words, name)


class NamedByInputs(ProgramTest):
    def test_storages_of_a_simulation(self):
        """Their names are made of --out, trial and grid."""
        self.stances("sim_train_1.sto")
        self.fails("sim_train_1.sto: is read by this command, expected another file to write", "simulate", "contact", "--data",
                   "sim_train_1.sto", "--out", "sim.sto")

    @unittest.skipUnless(CEINMS.is_dir(), "no CEINMS example")
    def test_files_that_a_project_names(self):
        folder = self.path("project")
        shutil.copytree(CEINMS, folder)
        before = contents(folder)
        for name in ("start.xml", "cal_stiff.xml", "exc.xml", "trial1/trial1.xml"):
            self.refuses("is read by this command, expected another file to write", "data", "ceinms",
                         folder / "csetup_stiff.xml", "--out", folder / name)
        named = [path for path in before if path.parent == Path("trial1") and path.suffix in (".sto", ".mot")]
        used = 0
        for name in named:
            done = self.run_program("data", "ceinms", folder / "csetup_stiff.xml", "--out", folder / name)
            used += done.returncode == 2
            shutil.copy(CEINMS / name, folder / name)  # those of no trial may be overwritten
        self.assertGreater(used, 2)

    def test_a_page_of_a_report_is_not_its_run(self):
        self.stances()
        self.succeeds("identify", "contact", "--data", "stances.h5", "--out", "run.h5", "--solver", "lm", "--intervals",
                      "linear", "--max-evaluations", 3, "--quiet")
        self.path("run.h5").rename(self.path("index.html"))
        self.fails("index.html: is read by this command and would be overwritten; expected another --out-dir", "report",
                   "index.html", "--out-dir", ".")


class InPlace(ProgramTest):
    def test_what_changes_its_file_by_design(self):
        self.stances()
        cut = ("data", "cut", "stances.h5", "--trial", "train_1", "--window", "0.1:0.3", "--as")
        self.assertIn("trial new is 0.1", self.succeeds(*cut, "new"))
        self.succeeds("data", "drop", "stances.h5", "--trial", "new")
        os.symlink("stances.h5", self.path("link.h5"))
        self.succeeds("data", "drop", "link.h5", "--trial", "train_2")
        self.assertTrue(self.path("link.h5").is_symlink(), "the link stays, its file changes")
        self.assertNotIn("train_2", json.loads(self.succeeds("data", "info", "stances.h5", "--json"))["trials"])

    def test_a_file_imported_into(self):
        self.write(MOTION, mot())
        self.succeeds("data", "import", MOTION, "--out", "walk.h5")
        self.succeeds("data", "import", MOTION, "--out", "walk.h5", "--append", "--trial", "again")
        self.assertEqual(sorted(json.loads(self.succeeds("data", "info", "walk.h5", "--json"))["trials"]), ["again", "walk"])


if __name__ == "__main__":
    unittest.main()

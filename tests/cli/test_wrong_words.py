"""Words on the command line and settings that are wrong: one line says which, and nothing is written.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_wrong_words.py
"""
import unittest

from program import ProgramTest, contents

IDENTIFY = ("identify", "contact", "--data", "stances.h5", "--out", "run.h5")
MANY_FREE = "stiffness,dissipation,static_friction,dynamic_friction,viscous_friction"


class Usage(ProgramTest):
    def test_unknown_commands(self):
        self.fails("A subcommand is required (see sinew --help)")
        self.fails("unknown command 'idntify'; did you mean 'identify'? (see sinew --help)", "idntify", "contact")
        self.fails("unknown command 'imprt'; did you mean 'import'? (see sinew data --help)", "data", "imprt", "a.mot")
        self.fails("list: 'sovers' does not exist; did you mean 'solvers'?", "list", "sovers")
        self.fails("list parameters: expected a problem, such as `sinew list parameters contact`", "list",
                   "parameters")

    def test_unknown_options(self):
        hint = " (see sinew identify --help)"
        self.fails("unknown option '--thrads'; did you mean '--threads'?" + hint, *IDENTIFY, "--thrads", 2)
        self.fails("unknown option '--thrads'; did you mean '--threads'?" + hint, *IDENTIFY, "--thrads=2")
        self.fails("unknown option '--dta'; did you mean '--data'?" + hint, "identify", "contact", "--dta", "a.h5")
        self.fails("unexpected argument 'walk'" + hint, "identify", "contact", "walk", *IDENTIFY[2:])
        self.fails("--out is required" + hint, *IDENTIFY[:-2])

    def test_lists_without_a_name(self):
        for command, option, words in (("compare", "--solvers ,", ("--solvers", ",", "--out", "o.h5")),
                                       ("compare", "--solvers ,,", ("--solvers=,,", "--out", "o.h5")),
                                       ("identify", "--free ,", ("--out", "o.h5", "--free", ",", "--quiet"))):
            self.fails(f"{option}: expected names, separated by commas (see sinew {command} --help)", command,
                       "contact", "--data", "d.h5", *words)

    def test_values_of_another_kind(self):
        hint = " (see sinew identify --help)"
        for option, value, message in (
                ("--max-evaluations", "-1", "--max-evaluations: '-1' is not a number of at least 0"),
                ("--max-seconds", "nan", "--max-seconds: 'nan' is not a number of at least 0"),
                ("--max-evaluations", "1.5", "Could not convert: --max-evaluations = 1.5"),
                ("--threads", "0", "--threads: Value 0 not in range 1 to 1024"),
                ("--seed", "-1", "--seed: Value -1 not in range 0 to 9007199254740992"),
                ("--seed", "one", "--seed: Value one not in range 0 to 9007199254740992")):
            with self.subTest(f"{option} {value}"):
                self.fails(message + hint, *IDENTIFY, option, value)


class Names(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def test_of_problems(self):
        message = "problem 'contct' does not exist; did you mean 'contact'?"
        self.fails(message, "identify", "contct", *IDENTIFY[2:])
        self.fails(message, "list", "parameters", "contct")
        self.fails(message, "data", "synthesize", "contct", "--out", "new.h5")

    def test_of_solvers(self):
        self.fails("solver 'cerez' does not exist; did you mean 'ceres'?", *IDENTIFY, "--solver", "cerez")
        self.fails("solver 'cerez' does not exist; did you mean 'ceres'?", *IDENTIFY, "--solver", "sa+cerez")
        self.fails("solver 'cerez' does not exist; did you mean 'ceres'?", "compare", "contact", "--data",
                   "stances.h5", "--solvers", "ceres,cerez", "--out", "study.h5")

    def test_of_parameters(self):
        message = "parameter 'stifness' does not exist; did you mean 'stiffness'?"
        self.fails(message, *IDENTIFY, "--free", "stifness")
        self.fails(message, *IDENTIFY, "--fix", "stifness=1e6")
        self.fails(message, *IDENTIFY, "--bounds", "stifness=1e5:1e6")
        self.fails(message, *IDENTIFY, "--start", "stifness=1e6")
        self.fails(message, "simulate", "contact", "--data", "stances.h5", "--set", "stifness=1e6", "--out", "sim.h5")
        self.fails("--set: 'stifness' does not exist; did you mean 'stiffness'?", "data", "synthesize", "contact",
                   "--set", "stifness=1e6", "--out", "new.h5")

    def test_of_effects(self):
        self.fails("effect 'right_force_y.offst' does not exist; did you mean 'right_force_y.offset'?", *IDENTIFY,
                   "--release", "right_force_y.offst")
        self.fails("--effect: 'force_y.gian' does not exist; did you mean 'force_y.gain'?", "data", "synthesize",
                   "contact", "--effect", "force_y.gian:factor=1.1", "--out", "new.h5")

    def test_effects_to_hide_need_a_number(self):
        """Without one nothing would be hidden, and no error would say so."""
        expected = {"ankle_on_dynamometer": "axis_offset:axis_offset_x=NUMBER,axis_offset_y=NUMBER",
                    "contact": "tilted_floor:floor_slope_x=NUMBER,floor_slope_z=NUMBER",
                    "drive": "coulomb_friction:coulomb_torque=NUMBER",
                    "emg_shape": "warp_with_speed:warp_sine=NUMBER,warp_cosine=NUMBER",
                    "free_body": "air_drag:air_drag=NUMBER",
                    "nms": "emg_drift:emg_drift=NUMBER"}
        problems = [line.split()[0] for line in self.succeeds("list", "problems").splitlines()]
        self.assertEqual(problems, sorted(expected))
        for problem, numbers in expected.items():
            with self.subTest(problem):
                effect = numbers.split(":")[0]
                words = ("data", "synthesize", problem, "--out", "new.h5", "--effect")
                self.fails(f"--effect {effect}: expected {numbers}", *words, effect)
                self.refuses("expected NAME=VALUE", *words, effect + ":")
        self.fails("--effect air_drag: 'air_drag' is given twice", "data", "synthesize", "free_body", "--effect",
                   "air_drag:air_drag=1,air_drag=0.5", "--out", "new.h5")

    def test_of_trials(self):
        self.fails("stances.h5: trial 'train_9' does not exist; did you mean 'train_1'?", "data", "drop", "stances.h5",
                   "--trial", "train_9")
        self.fails("stances.h5: no trial 'train_9'; did you mean 'train_1'?", "data", "cut", "stances.h5", "--trial",
                   "train_9", "--window", "0:0.3", "--as", "new")


class Values(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def test_bounds(self):
        self.fails("parameter 'stiffness': start 100000 lies outside its bounds 1000000 .. 10000000 [N/m3]",
                   *IDENTIFY, "--bounds", "stiffness=1e6:1e7")
        self.fails("parameter 'stiffness': bounds 1000000 .. 100000 are not a finite interval [N/m3]", *IDENTIFY,
                   "--bounds", "stiffness=1e6:1e5")
        self.fails("--bounds stiffness=1e6: expected NAME=LOW:HIGH", *IDENTIFY, "--bounds", "stiffness=1e6")
        self.fails("parameter 'stiffness': fixed at 1, outside its bounds 10000 .. 10000000 [N/m3]", *IDENTIFY,
                   "--fix", "stiffness=1")
        self.fails("--fix stiffness: expected NAME=VALUE", *IDENTIFY, "--fix", "stiffness")
        self.fails("parameter 'stiffness' is asked to be both free and fixed", *IDENTIFY, "--free", "stiffness",
                   "--fix", "stiffness=1e6")
        self.fails("parameter 'stiffness' = 1000000000000: outside its bounds 10000 .. 10000000 [N/m3]", "simulate",
                   "contact", "--data", "stances.h5", "--set", "stiffness=1e12", "--out", "sim.h5")

    def test_windows(self):
        cut = ("data", "cut", "stances.h5", "--trial", "train_1", "--as", "new")
        self.fails("stances.h5: the window 5:6 s holds no sample of 'coordinates' in trial 'train_1', which covers "
                   "-0.2:0.7333333333333334 s", *cut, "--window", "5:6")
        self.fails("--window 0.3:0.1: expected an end after its start", *cut, "--window", "0.3:0.1")
        self.fails("--window 0.3: expected FROM:TO in seconds, such as 0.6:1.3", *cut, "--window", "0.3")
        self.fails("stances.h5: there is a trial 'train_2' already", *cut[:-1], "train_2", "--window", "0.1:0.3")

    def test_pieces(self):
        for length in ("0", "-1"):
            self.fails(f"--every {length}: expected more than 0 s", "data", "split", "stances.h5", f"--every={length}")

    def test_plates_and_roles(self):
        cut = ("data", "cut", "stances.h5", "--trial", "train_1", "--as", "new", "--window", "0.1:0.3")
        self.fails("--plate: trial 'train_1' has no channel left_force_y", *cut, "--plate", "left")
        self.fails("--role tran: expected train or validate", *cut, "--role", "tran")

    def test_synthesis(self):
        self.fails("--set train=-1: expected 1 to 20", "data", "synthesize", "contact", "--set", "train=-1", "--out",
                   "new.h5")
        self.fails("--noise nan: expected a factor of at least 0", "data", "synthesize", "contact", "--noise", "nan",
                   "--out", "new.h5")


class Outputs(ProgramTest):
    """An output that cannot be written is known before the work begins."""

    def setUp(self):
        super().setUp()
        self.stances()

    def commands(self, out):
        return (("identify", "contact", "--data", "stances.h5", "--out", out),
                ("compare", "contact", "--data", "stances.h5", "--solvers", "ceres", "--out", out),
                ("simulate", "contact", "--data", "stances.h5", "--out", out),
                ("data", "synthesize", "contact", "--out", out))

    def test_into_a_folder_that_is_not_there(self):
        for command in self.commands("none/x.h5"):
            self.fails("none/x.h5: cannot be written: there is no folder 'none'", *command)
        self.fails("none/x.json: cannot be written: there is no folder 'none'", *IDENTIFY, "--json", "none/x.json")
        self.fails("stances.h5/x.h5: cannot be written: there is no folder 'stances.h5'", *IDENTIFY[:-1],
                   "stances.h5/x.h5")

    def test_onto_a_folder(self):
        self.path("x.h5").mkdir()
        for command in self.commands("x.h5"):
            self.fails("x.h5: is a folder, expected a file to write", *command)

    def test_onto_what_is_read(self):
        for command in self.commands("./stances.h5")[:3]:
            self.fails("./stances.h5: is read by this command, expected another file to write", *command)
        self.fails("run.h5: would be written twice by this command, expected different files", *IDENTIFY, "--json", "run.h5")

    def test_of_a_simulation_have_a_known_format(self):
        self.fails("--out sim.csv: expected a name that ends with .h5 or .sto", "simulate", "contact", "--data",
                   "stances.h5", "--out", "sim.csv")


class Settings(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stances()

    def config_fails(self, message, old, new):
        self.settings(old, new, "contact.yaml")
        self.fails(message, *IDENTIFY, "--config", "contact.yaml")

    def test_are_read_strictly(self):
        self.config_fails("contact.yaml:4: unknown key 'flor_height'; did you mean 'floor_height'?", "floor_height",
                          "flor_height")
        self.config_fails("contact.yaml:4: contact.floor_height: expected a number instead of 'low'",
                          "floor_height: 0.0", "floor_height: low")
        self.config_fails("contact.yaml:20: stiffness: expected lower 10000 <= start 1000000000 <= upper 10000000",
                          "start: 1.0e5", "start: 1.0e9")
        self.config_fails("stances.h5: contact region 'right_sole': the model has no body 'calcn_x'; did you mean "
                          "'calcn_r'?", "calcn_r", "calcn_x")

    def test_that_are_no_settings(self):
        self.fails("none.yaml: no such file", *IDENTIFY, "--config", "none.yaml")
        self.write("empty.yaml", "")
        self.fails("empty.yaml:1: the document: expected key 'contact'", *IDENTIFY, "--config", "empty.yaml")
        self.write("torn.yaml", "contact: [\n")
        self.fails("torn.yaml:2: is not YAML: end of sequence flow not found", *IDENTIFY, "--config", "torn.yaml")


class Resume(ProgramTest):
    """A run goes on only with what it was begun with; anything else would mix the answers of two questions."""

    RESUME = ("identify", "contact", "--out", "run.h5", "--max-evaluations", 100, "--resume", "--quiet")

    def setUp(self):
        super().setUp()
        self.stances()
        self.succeeds(*IDENTIFY, "--solver", "sa", "--max-evaluations", 50)

    def test_needs_a_run(self):
        self.write("text.h5", "run")
        self.fails("text.h5: is not an HDF5 file", *IDENTIFY[:-1], "text.h5", "--resume")

    def test_with_other_data(self):
        self.succeeds("data", "synthesize", "contact", "--seed", 2, "--set", "encoders=1", "--out", "other.h5")
        before = contents(self.folder)
        done = self.run_program(*self.RESUME, "--solver", "sa", "--data", "other.h5")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"\Asinew: error: --resume: run\.h5 was made with data [0-9a-f]{16}, not "
                                      r"[0-9a-f]{16}\n\Z")
        self.assertEqual(contents(self.folder), before)

    def test_with_other_words(self):
        self.settings("objective: thesis", "objective: normalised", "other.yaml")
        box = "--resume: run.h5 was made with bounds 10000 .. 10000000 and start 100000 of 'stiffness', not "
        free = f"--resume: run.h5 was made with free parameters {MANY_FREE}, not "
        for words, message in (
                (("--solver", "ceres"), "--resume: run.h5 was made with solver sa, not ceres"),
                (("--seed", 2), "--resume: run.h5 was made with seed 1, not 2"),
                (("--config", "other.yaml"),
                 "--resume: run.h5 was made with other settings (--config); they are in its /run/config"),
                (("--bounds", "stiffness=1e4:1e8"), box + "10000 .. 100000000 and 100000"),
                (("--start", "stiffness=2e5"), box + "10000 .. 10000000 and 200000"),
                (("--free", "stiffness"), free + "stiffness"),
                (("--fix", "static_friction=0.7"), free + MANY_FREE.replace("static_friction,", "")),
                (("--release", "right_force_y.offset"), free + MANY_FREE + ",right_force_y.offset")):
            with self.subTest(words):
                solver = () if words[0] == "--solver" else ("--solver", "sa")
                self.fails(message, *self.RESUME, "--data", "stances.h5", *solver, *words)


class FromRun(ProgramTest):
    def test_needs_a_run_file(self):
        self.stances()
        message = "stances.h5: is not a run file: expected /run with attribute sinew_schema = run/1"
        self.fails(message, "simulate", "contact", "--data", "stances.h5", "--from", "stances.h5", "--out", "sim.h5")
        self.fails("stances.h5: is not a run file (it is a dataset/1 file); expected what sinew identify, diagnose or "
                   "compare writes", "report", "stances.h5", "--out-dir", "report")
        self.fails("none.h5: no such file", "report", "none.h5", "--out-dir", "report")


if __name__ == "__main__":
    unittest.main()

"""Files that are not what they should be: one line says where and what was expected, and nothing is written.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_wrong_files.py
"""
import json
import unittest

import h5py
import numpy as np

from laboratory_files import MOTION_COLUMNS, MOTION_ROWS, mot, replaced, trc
from program import ProgramTest, replace_text

ANGLE = "trials/train_1/coordinates/channels/knee_angle_r"
FORCE = "trials/train_1/forces/channels/right_force_y"
FORCE_TIME = "trials/train_1/forces/time"
KNOWN_UNITS = ("1, %, m, km, cm, mm, um, s, ms, us, min, h, rad, mrad, deg, rev, rpm, Hz, kHz, K, kg, N, mN, kN, Nm, Ncm, "
               "Nmm, mNm, kNm, J, W, kW, Pa, kPa, MPa, V, mV, uV, A, mA, ohm, H, mH, F, uF, degC and their products and "
               "quotients with powers up to 9 (N*m, m/s2)")


class MotionFile(ProgramTest):
    def import_fails(self, message, text):
        self.write("walk.mot", text)
        self.fails(message, "data", "import", "walk.mot", "--out", "walk.h5")

    def test_empty_or_something_else(self):
        self.import_fails("walk.mot: is empty", "")
        self.import_fails("walk.mot: has no line 'endheader'; expected a .sto or .mot file", bytes(range(256)))
        self.import_fails("walk.mot: has no line 'endheader'; expected a .sto or .mot file", "walk\nversion=1\n")

    def test_truncated(self):
        self.import_fails("walk.mot:11: row has 1 values, the header announces 3 columns", mot()[:-5])

    def test_wrong_column_count(self):
        self.import_fails("walk.mot:9: row has 2 values, the header announces 3 columns",
                          mot(rows=replaced(MOTION_ROWS, 1, (0.1, 1))))

    def test_wrong_counts_in_the_header_are_said_and_read(self):
        for text, told in ((mot(announced_rows=9), "walk.mot:11: the file ends after 4 rows, the header announces 9 rows (line 3)"),
                           (mot(announced_columns=4), "walk.mot:7: 3 column names, the header announces 4 columns (line 4)")):
            self.write("walk.mot", text)
            done = self.run_program("data", "import", "walk.mot", "--out", "walk.h5")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("note: " + told + "; all of them were read", done.stderr.replace("\n  ", " "))
            info = json.loads(self.succeeds("data", "info", "walk.h5", "--json"))
            self.assertEqual(info["trials"]["walk"]["grids"]["coordinates"]["samples"], 4)

    def test_text_where_a_number_belongs(self):
        self.import_fails("walk.mot:9: column 'knee_angle_r': 'abc' is not a number",
                          mot(rows=replaced(MOTION_ROWS, 1, (0.1, "abc", 2))))

    def test_time_that_does_not_increase(self):
        self.import_fails("walk.mot:10: time 0.1 s does not increase, the row before is at 0.2 s",
                          mot(rows=[MOTION_ROWS[i] for i in (0, 2, 1, 3)]))

    def test_a_gap_stays_a_gap(self):
        self.write("walk.mot", mot(rows=replaced(MOTION_ROWS, 1, (0.1, "NaN", 2))))
        self.succeeds("data", "import", "walk.mot", "--out", "walk.h5")
        info = json.loads(self.succeeds("data", "info", "walk.h5", "--json"))
        self.assertEqual(info["trials"]["walk"]["grids"]["coordinates"]["gaps"], 1)
        self.assertRegex(self.succeeds("data", "info", "walk.h5"), r"walk +train +coordinates +4 +0 +0\.3000 +10\.00 +1 ")

    def test_the_old_data_set_survives_a_failed_import(self):
        self.write("walk.mot", mot())
        self.succeeds("data", "import", "walk.mot", "--out", "walk.h5")
        self.write("run.mot", mot()[:-5])
        message = "run.mot:11: row has 1 values, the header announces 3 columns"
        self.fails(message, "data", "import", "run.mot", "--out", "walk.h5")
        self.fails(message, "data", "import", "run.mot", "--out", "walk.h5", "--append")


class MarkerFile(ProgramTest):
    def import_fails(self, message, text):
        self.write("walk.trc", text)
        self.fails(message, "data", "import", "walk.trc", "--out", "walk.h5")

    def test_empty_or_truncated(self):
        self.import_fails("walk.trc: is empty", "")
        self.write("walk.trc", trc(announced_frames=7))
        done = self.run_program("data", "import", "walk.trc", "--out", "walk.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("walk.trc:10: the file ends after 4 frames, the header announces 7 (line 3); all of them were read",
                      done.stderr.replace("\n  ", " "))

    def test_wrong_column_count(self):
        self.import_fails("walk.trc:4: 2 marker names, the header announces 3 (NumMarkers, line 3)",
                          trc(announced_markers=3))
        self.import_fails("walk.trc:8: row has 7 cells, expected 8: frame, time and 3 for each of 2 markers",
                          trc(changed={1: "2\t0.01667\t1\t2\t3\t4\t5"}))

    def test_text_where_a_number_belongs(self):
        self.import_fails("walk.trc:8: marker 'RASI': 'x' is not a number",
                          trc(changed={1: "2\t0.01667\t1\t2\tx\t4\t5\t6"}))

    def test_time_that_does_not_increase(self):
        self.import_fails("walk.trc:9: time 0 s does not increase, the row before is at 0.01667 s",
                          trc(changed={2: "3\t0.00000\t1\t2\t3\t4\t5\t6"}))

    def test_unknown_unit(self):
        self.import_fails("walk.trc:3: Units is 'furlong', expected m, cm or mm", trc(units="furlong"))


class ImportMap(ProgramTest):
    MAP = "time: {column: t, unit: s}\nchannels:\n  position: {column: qm, unit: deg}\n"

    def setUp(self):
        super().setUp()
        self.write("bench.csv", "t,qm,tau\n0,1,2\n0.1,2,3\n0.2,3,4\n")

    def import_fails(self, message, text):
        self.write("map.yaml", text)
        self.fails(message, "data", "import", "bench.csv", "--map", "map.yaml", "--out", "bench.h5")

    def test_a_csv_needs_one(self):
        self.fails("bench.csv: needs a map that assigns its columns to channels (they are t, qm, tau)", "data", "import",
                   "bench.csv", "--out", "bench.h5")

    def test_is_read_strictly(self):
        self.import_fails("map.yaml: is empty", "")
        self.import_fails("map.yaml:2: not valid YAML: end of map flow not found", "time: {column: t\nchannels:\n")
        self.import_fails("map.yaml:2: unknown key 'chanels' in the map; did you mean 'channels'?",
                          self.MAP.replace("channels", "chanels"))
        self.import_fails("map.yaml:3: bench.csv has no column 'qn'; did you mean 'qm'?",
                          self.MAP.replace("qm", "qn"))

    def test_unknown_unit(self):
        self.write("map.yaml", self.MAP.replace("deg", "degr"))
        done = self.run_program("data", "import", "bench.csv", "--map", "map.yaml", "--out", "bench.h5")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"\Asinew: error: map\.yaml:3: unknown unit 'degr'; did you mean 'deg'\?.*\n\Z")
        self.assertFalse(self.path("bench.h5").exists())

    def test_wrong_column_count(self):
        self.write("bench.csv", "t,qm,tau\n0,1,2\n0.1,2\n")
        self.import_fails("bench.csv:3: row has 2 cells, the header (line 1) names 3 columns", self.MAP)


class Import(ProgramTest):
    def test_files_that_are_not_there_or_not_known(self):
        self.fails("walk.mot: no such file", "data", "import", "walk.mot", "--out", "walk.h5")
        self.write("walk.pdf", "%PDF")
        self.fails("walk.pdf: cannot be imported, expected .trc, .mot, .sto, .csv, .txt, .mat, .osim, .xml, .yaml or .obj",
                   "data", "import", "walk.pdf", "--out", "walk.h5")

    def test_plates_that_the_file_lacks(self):
        self.write("walk.mot", mot())
        self.fails("plate 'right': no file has columns ground_force_vx; expected one of knee_angle_r, hip_flexion_r",
                   "data", "import", "walk.mot", "--plates", "right=ground_", "--out", "walk.h5")
        self.fails("plates: 'right' is not PLATE=PREFIX; expected for example right=ground_,left=1_ground_",
                   "data", "import", "walk.mot", "--plates", "right", "--out", "walk.h5")

    def test_does_not_write_over_what_it_reads(self):
        self.write("walk.mot", mot())
        self.fails("walk.mot: is read by this command, expected another file to write", "data", "import", "walk.mot",
                   "--out", "walk.mot")

    def test_a_model_with_an_unsupported_part(self):
        with h5py.File(self.path(self.stances())) as file:
            model = file["files/model.osim"][()].decode()
        self.write("robot.osim", model.replace("CustomJoint", "EllipsoidJoint"))
        line = model[:model.index("<CustomJoint")].count("\n") + 1
        self.fails(f"robot.osim:{line}: EllipsoidJoint 'ground_pelvis' is not supported; supported are CustomJoint, "
                   "WeldJoint, PinJoint, SliderJoint, UniversalJoint, BallJoint, GimbalJoint, PlanarJoint, FreeJoint",
                   "data", "import", "robot.osim", "--out", "robot.h5")
        self.write("robot.osim", model[:model.index("</Body>")])
        self.fails(f"robot.osim:{model[:model.index('</Body>')].count(chr(10)) + 1}: not well-formed XML: "
                   "start-end tags mismatch", "data", "import", "robot.osim", "--out", "robot.h5")


class DataSet(ProgramTest):
    def identify_fails(self, message, change):
        """change: of a copy of the stances, through h5py."""
        name = self.changed_stances(change)
        self.fails(f"{name}: {message}", "identify", "contact", "--data", name, "--out", "run.h5")

    def test_not_there_truncated_or_something_else(self):
        whole = self.path(self.stances()).read_bytes()
        for name, content, message in (
                ("empty.h5", b"", "is not an HDF5 file"),
                ("text.h5", b"time,force\n", "is not an HDF5 file"),
                ("short.h5", whole[:5000], "cannot be opened as HDF5 (truncated or damaged)"),
                ("cut.h5", whole[:-1], "cannot be opened as HDF5 (truncated or damaged)")):
            with self.subTest(name):
                self.write(name, content)
                self.fails(f"{name}: {message}", "data", "info", name)
                self.fails(f"{name}: {message}", "identify", "contact", "--data", name, "--out", "run.h5")
        self.fails("none.h5: no such file", "data", "info", "none.h5")
        self.fails(".: is a folder, expected an HDF5 file", "data", "info", ".")

    def test_damaged_bytes_never_end_the_program_by_a_signal(self):
        whole = bytearray(self.path(self.stances()).read_bytes())
        random = np.random.default_rng(1)
        for _ in range(40):
            bytes_ = whole.copy()
            for at in random.integers(0, 20000, 20):  # the headers
                bytes_[at] = random.integers(0, 256)
            self.write("damaged.h5", bytes(bytes_))
            done = self.run_program("data", "info", "damaged.h5")
            self.assertIn(done.returncode, (0, 2))
            if done.returncode == 2:
                self.assertRegex(done.stderr, r"\Asinew: error: damaged\.h5: [^\n]+\n\Z")

    def test_another_schema(self):
        self.identify_fails('/: has no attr \'sinew_schema\', expected "dataset/1": is it a dataset?',
                            lambda file: file.attrs.__delitem__("sinew_schema"))

    def test_wrong_attributes(self):
        self.identify_fails("/trials/train_1: role is 'test', expected train or validate",
                            lambda file: file["trials/train_1"].attrs.__setitem__("role", "test"))
        self.identify_fails(f"/{FORCE}: unknown unit 'Newtons'; known are {KNOWN_UNITS}",
                            lambda file: file[FORCE].attrs.__setitem__("unit", "Newtons"))

    def test_time_that_does_not_increase(self):
        def repeat(file):
            file[FORCE_TIME][4] = file[FORCE_TIME][3]

        def leave_out(file):
            file[FORCE_TIME][4] = np.nan

        name = self.changed_stances(repeat)
        at = h5py.File(self.path(name))[FORCE_TIME][3]
        self.fails(f"{name}: /{FORCE_TIME}: time does not increase: sample 3 is at {at} s, sample 4 at {at} s",
                   "identify", "contact", "--data", name, "--out", "run.h5")
        self.identify_fails(f"/{FORCE_TIME}: time 4 is not a number", leave_out)

    def test_a_channel_shorter_than_its_time(self):
        def shorten(file):
            values, attributes = file[FORCE][:-1], dict(file[FORCE].attrs)
            del file[FORCE]
            file.create_dataset(FORCE, data=values).attrs.update(attributes)

        self.identify_fails(f"/{FORCE}: has 31 values, its time has 32", shorten)

    def test_an_infinite_value(self):
        self.identify_fails(f"/{ANGLE}: value 20 is infinite; a gap is written as NaN",
                            lambda file: file[ANGLE].__setitem__(20, np.inf))

    def test_gaps_in_forces_are_skipped(self):
        def leave_out(file):
            file[FORCE][5:8] = np.nan

        name = self.changed_stances(leave_out)
        info = json.loads(self.succeeds("data", "info", name, "--json"))
        self.assertEqual(info["trials"]["train_1"]["grids"]["forces"]["gaps"], 3)
        result = json.loads(self.succeeds("identify", "contact", "--data", name, "--out", "run.h5", "--json", "-"))
        samples = {entry["trial"]: entry["n"] for entry in result["fit"] if entry["channel"] == "right_force_y"}
        self.assertEqual(samples["train_3"] - samples["train_1"], 3)
        with h5py.File(self.path("run.h5")) as run:
            prediction = run["prediction/train_1/right_force_y"]
            self.assertEqual(np.isnan(prediction["measured"]).sum(), 3)
            self.assertTrue(np.isfinite(prediction["simulated"]).all())

    def test_only_gaps(self):
        self.identify_fails("trial 'train_1': right_force_y has no value: a step without a plate can only be predicted (role "
                            "validate)", lambda file: file[FORCE].__setitem__(slice(None), np.nan))

    def test_a_gap_of_the_motion_inside_a_stance(self):
        self.identify_fails("trial 'train_1': the motion has a gap at t = 0.1333 s; cut the trial so that it lies "
                            "outside", lambda file: file[ANGLE].__setitem__(20, np.nan))

    def test_forces_and_motion_that_do_not_overlap(self):
        def shift(file):
            file[FORCE_TIME][...] = file[FORCE_TIME][...] + 100

        self.identify_fails("trial 'train_1': forces (100 .. 100.5 s) and motion (-0.2 .. 0.7333 s) do not overlap in "
                            "time", shift)

    def test_missing_parts(self):
        self.identify_fails("the data set holds no file 'model.osim' (its files: contact.yaml); import the .osim that "
                            "the motion belongs to", lambda file: file.__delitem__("files/model.osim"))
        self.identify_fails("holds no settings 'contact.yaml'; give --config, or import the file into the data set",
                            lambda file: file.__delitem__("files/contact.yaml"))
        self.identify_fails("trial 'train_1': has no coordinate of the model (pelvis_tilt, ...); run `sinew data "
                            "kinematics` on its markers first",
                            lambda file: file.__delitem__("trials/train_1/coordinates"))

        def only_validate(file):
            for trial in file["trials"].values():
                trial.attrs["role"] = "validate"

        self.identify_fails("no trial with the role train has a channel that is compared: nothing to fit", only_validate)

    def test_a_model_with_an_unsupported_part(self):
        with h5py.File(self.path(self.stances())) as file:
            model = file["files/model.osim"][()].decode()
        line = model[:model.index("<CustomJoint")].count("\n") + 1
        self.identify_fails(
            f"model.osim:{line}: EllipsoidJoint 'ground_pelvis' is not supported; supported are CustomJoint, "
            "WeldJoint, PinJoint, SliderJoint, UniversalJoint, BallJoint, GimbalJoint, PlanarJoint, FreeJoint",
            lambda file: replace_text(file, "files/model.osim", model.replace("CustomJoint", "EllipsoidJoint")))


class Markers(ProgramTest):
    def test_names_that_the_model_lacks(self):
        self.stances()
        self.write("walk.trc", trc(markers=("R.ASIS", "L.ASIS")))
        imported = self.run_program("data", "import", "walk.trc", "--out", "stances.h5", "--append")
        self.assertEqual(imported.returncode, 0)
        message = ("stances.h5: trial 'walk': marker set and motion share no marker: the model has {}, ... (38), the "
                   "motion has L.ASIS, R.ASIS (2); rename with a map: sinew data import --map (see docs/import.md#markers)")
        with h5py.File(self.path("stances.h5")) as file:
            model = file["files/model.osim"][()].decode()
        first = ", ".join(piece.split('"')[1] for piece in model.split("<Marker ")[1:4])
        self.fails(message.format(first), "data", "kinematics", "stances.h5")

    def test_no_model_and_no_markers(self):
        name = self.changed_stances(lambda file: file.__delitem__("files/model.osim"))
        self.fails(f"{name}: holds no model.osim: expected --model M.osim", "data", "kinematics", name)
        self.fails("none.osim: no such file", "data", "kinematics", name, "--model", "none.osim")

        def drop_markers(file):
            for trial in file["trials"].values():
                del trial["markers"]

        name = self.changed_stances(drop_markers)
        self.fails(f"{name}: no trial has a grid 'markers'", "data", "kinematics", name)


if __name__ == "__main__":
    unittest.main()

"""Lengths and moment arms of a model's muscles along joint angles.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_muscles.py
"""
import os
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import ROOT, ProgramTest

WALKING = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "walking_emg"

# Two hinges about z, one behind the other; `bend` wraps over a drum round the first one, `long` crosses both.
MODEL = """<OpenSimDocument Version="30000"><Model name="finger"><BodySet><objects>
<Body name="ground"><WrapObjectSet><objects>
  <WrapCylinder name="drum"><radius>0.05</radius><length>1</length></WrapCylinder>
  <WrapTorus name="ring"/></objects></WrapObjectSet></Body>
<Body name="near"><mass>1</mass><inertia>1 1 1 0 0 0</inertia><Joint><PinJoint name="j1"><parent_body>ground</parent_body>
  <CoordinateSet><objects><Coordinate name="first"/></objects></CoordinateSet></PinJoint></Joint></Body>
<Body name="far"><mass>1</mass><inertia>1 1 1 0 0 0</inertia><Joint><PinJoint name="j2"><parent_body>near</parent_body>
  <location_in_parent>0.3 0 0</location_in_parent>
  <CoordinateSet><objects><Coordinate name="second"><default_value>0.5</default_value></Coordinate></objects></CoordinateSet>
  </PinJoint></Joint></Body></objects></BodySet><ForceSet><objects>
<Thelen2003Muscle name="bend"><GeometryPath><PathPointSet><objects>
  <PathPoint><body>ground</body><location>0.2 0 0</location></PathPoint>
  <PathPoint><body>near</body><location>0.3 0 0</location></PathPoint></objects></PathPointSet>
  <PathWrapSet><objects><PathWrap><wrap_object>drum</wrap_object></PathWrap></objects></PathWrapSet>
</GeometryPath></Thelen2003Muscle>
<Thelen2003Muscle name="long"><GeometryPath><PathPointSet><objects>
  <PathPoint><body>ground</body><location>0 0 0</location></PathPoint>
  <PathPoint><body>far</body><location>0.4 0 0</location></PathPoint></objects></PathPointSet></GeometryPath></Thelen2003Muscle>
<Thelen2003Muscle name="odd"><GeometryPath><PathPointSet><objects>
  <PathPoint><body>ground</body><location>0 0 0</location></PathPoint>
  <PathPoint><body>far</body><location>0.4 0 0</location></PathPoint></objects></PathPointSet>
  <PathWrapSet><objects><PathWrap><wrap_object>ring</wrap_object></PathWrap></objects></PathWrapSet>
</GeometryPath></Thelen2003Muscle></objects></ForceSet></Model></OpenSimDocument>
"""


def motion(names, rows):
    text = f"Coordinates\nversion=1\nnRows={len(rows)}\nnColumns={len(names) + 1}\ninDegrees=yes\nendheader\n"
    text += "\t".join(["time", *names]) + "\n"
    return text + "".join("\t".join(repr(float(x)) for x in row) + "\n" for row in rows)


class Muscles(ProgramTest):
    def table(self, trial, grid, muscles, name="finger.h5"):
        with h5py.File(self.path(name)) as file:
            stored = file["trials"][trial][grid]
            self.assertEqual(sorted(stored["channels"]), sorted(muscles))
            units = {np.asarray(stored["channels"][m].attrs["unit"]).item() for m in muscles}
            self.assertIn(units, ({"m"}, {b"m"}))
            return stored["time"][()], np.array([stored["channels"][m][()] for m in muscles]).T


class SmallModel(Muscles):
    def setUp(self):
        super().setUp()
        self.angles = np.linspace(30, 170, 15)
        self.write("finger.osim", MODEL)
        self.write("bent.mot", motion(["first"], np.column_stack([0.1 * np.arange(15), self.angles])))
        self.succeeds("data", "import", "bent.mot", "finger.osim", "--out", "finger.h5")

    def test_closed_form(self):
        said = self.succeeds("data", "muscles", "finger.h5", "--muscles", "long,bend", "--joints", "first,second")
        self.assertEqual(said, "bent: 15 frames: lengths of 2 muscles, moment arms about first, second\n"
                               "  not in the data, kept at the model's default: second\n")
        time, lengths = self.table("bent", "lengths", ["bend", "long"])
        same, arms = self.table("bent", "moment_arms.first", ["bend", "long"])
        _, second = self.table("bent", "moment_arms.second", ["bend", "long"])
        np.testing.assert_array_equal(time, same)
        angle = np.radians(self.angles)
        straight = np.sqrt(0.13 - 0.12 * np.cos(angle))
        openings = np.arccos(0.05 / 0.2) + np.arccos(0.05 / 0.3)
        wrapped = np.sqrt(0.04 - 0.0025) + np.sqrt(0.09 - 0.0025) + 0.05 * (angle - openings)
        np.testing.assert_allclose(lengths[:, 0], np.where(angle > openings, wrapped, straight), rtol=1e-14)
        np.testing.assert_allclose(arms[:, 0], np.where(angle > openings, -0.05, -0.06 * np.sin(angle) / straight),
                                   rtol=1e-13)
        whole = np.sqrt(0.09 + 0.16 + 0.24 * np.cos(0.5))
        np.testing.assert_allclose(lengths[:, 1], whole, rtol=1e-14)
        np.testing.assert_allclose(arms[:, 1], 0, atol=1e-14)
        np.testing.assert_allclose(second[:, 1], 0.12 * np.sin(0.5) / whole, rtol=1e-13)

    def test_every_joint_without_what_is_not_supported(self):
        said = self.succeeds("data", "muscles", "finger.h5", "--joints", "all", "--skip-unsupported")
        self.assertEqual(said, "left out: odd, for WrapTorus 'ring' is not supported\n"
                               "bent: 15 frames: lengths of 2 muscles, moment arms about first, second\n"
                               "  not in the data, kept at the model's default: second\n")
        self.table("bent", "moment_arms.second", ["bend", "long"])
        # `bend` ends before the second joint.
        said = self.succeeds("data", "muscles", "finger.h5", "--joints", "all", "--muscles", "bend", "--out", "one.h5")
        self.assertIn("moment arms about first\n", said)
        self.fails("finger.h5/files/model.osim: none of the muscles is supported, such as 'odd' with WrapTorus 'ring'",
                   "data", "muscles", "finger.h5", "--joints", "all", "--muscles", "odd", "--skip-unsupported")

    def test_lengths_that_differ_from_opensims_are_explained(self):
        self.write("two.osim", MODEL.replace("<WrapTorus name=\"ring\"/>", "<WrapSphere name=\"ring\"><radius>0.01</radius></WrapSphere>")
                   .replace("<PathWrap><wrap_object>drum</wrap_object></PathWrap>",
                            "<PathWrap><wrap_object>drum</wrap_object></PathWrap><PathWrap><wrap_object>ring</wrap_object></PathWrap>"))
        said = self.succeeds("data", "muscles", "finger.h5", "--model", "two.osim", "--muscles", "bend,long", "--joints", "first")
        self.assertIn("bend: where such a path touches two wrap objects at once, OpenSim's own length is too short", said)

    def test_another_file_and_another_model(self):
        before = self.path("finger.h5").read_bytes()
        self.write("short.osim", MODEL.replace("0.3 0 0</location_in_parent>", "0.2 0 0</location_in_parent>"))
        self.succeeds("data", "muscles", "finger.h5", "--model", "short.osim", "--muscles", "long", "--joints", "first",
                      "--out", "other.h5")
        self.assertEqual(self.path("finger.h5").read_bytes(), before)
        _, lengths = self.table("bent", "lengths", ["long"], "other.h5")
        np.testing.assert_allclose(lengths[:, 0], np.sqrt(0.04 + 0.16 + 0.16 * np.cos(0.5)), rtol=1e-14)

    def test_wrong_words(self):
        data = ("data", "muscles", "finger.h5")
        self.fails("--joints is required (see sinew data muscles --help)", *data)
        self.fails("finger.h5/files/model.osim: there is no muscle 'bent'; did you mean 'bend'?", *data, "--muscles",
                   "bent", "--joints", "first")
        self.fails("--joints: the model has no coordinate 'frist'; expected one of first, second", *data, "--joints", "frist")
        self.fails("finger.h5/files/model.osim:4: muscle 'odd' wraps over WrapTorus 'ring', which is not supported; "
                   "supported are WrapCylinder, WrapSphere; --skip-unsupported leaves them out", *data, "--joints", "first")
        self.fails("--joints: coordinate 'first' is given twice", *data, "--muscles", "long", "--joints", "first,first")

    def test_wrong_data(self):
        gap = motion(["first"], [[0, 1], [0.1, 2], [0.2, float("nan")], [0.3, 2]])
        self.write("gap.mot", gap)
        self.succeeds("data", "import", "gap.mot", "finger.osim", "--out", "gap.h5")
        self.fails("gap.h5: trial 'gap': coordinate 'first' has a gap at t = 0.2 s; cut the trial to a window without "
                   "gaps", "data", "muscles", "gap.h5", "--muscles", "long", "--joints", "first")
        self.assertEqual(self.run_program("data", "import", "bent.mot", "--out", "bare.h5").returncode, 0)
        data = ("data", "muscles", "bare.h5", "--muscles", "long", "--joints", "first")
        self.fails("bare.h5: holds no model.osim: expected --model M.osim", *data)
        self.fails("bare.h5: trial 'bent': channel 'first' has the unit 1, expected rad; import the file together with "
                   "the model, which knows its angles", *data, "--model", "finger.osim")


@unittest.skipUnless(WALKING.is_dir(), f"{WALKING} is not there")
class Walking(Muscles):
    """gait2392 along measured angles: no wrapping, but conditional and moving points."""
    MUSCLES = ["soleus_r", "med_gas_r", "lat_gas_r", "tib_ant_r", "per_long_r", "per_brev_r", "per_tert_r", "rect_fem_r",
               "vas_int_r", "bifemsh_r", "semimem_r"]
    STEP = 0.01  # [deg]

    def test_moment_arms_are_differences_of_lengths(self):
        head, _, table = (WALKING / "walk36" / "ik.sto").read_text().partition("endheader\n")
        self.assertIn("inDegrees=yes", head)
        lines = table.splitlines()
        names = lines[0].split()[1:]
        rows = np.array([line.split() for line in lines[1::40]], dtype=float)
        words = ["--muscles", ",".join(self.MUSCLES), "--joints", "ankle_angle_r,knee_angle_r,subtalar_angle_r"]
        trials = {"at": rows}
        for joint in ("ankle_angle_r", "knee_angle_r", "subtalar_angle_r"):
            for side, step in (("back", -self.STEP), ("ahead", self.STEP)):
                moved = rows.copy()
                moved[:, 1 + names.index(joint)] += step
                trials[f"{joint}_{side}"] = moved
        for name, values in trials.items():
            self.write(f"{name}.mot", motion(names, values))
            done = self.run_program("data", "import", f"{name}.mot", WALKING / "gait2392.osim", "--append", "--out", "walk.h5")
            self.assertEqual(done.returncode, 0, done.stderr)
        said = self.succeeds("data", "muscles", "walk.h5", *words)
        self.assertIn(f"at: {len(rows)} frames: lengths of 11 muscles, moment arms about ankle_angle_r, ", said)
        self.assertNotIn("not in the data", said)
        _, here = self.table("at", "lengths", self.MUSCLES, "walk.h5")
        step = np.radians(self.STEP)
        for joint in ("ankle_angle_r", "knee_angle_r", "subtalar_angle_r"):
            _, arms = self.table("at", f"moment_arms.{joint}", self.MUSCLES, "walk.h5")
            _, back = self.table(f"{joint}_back", "lengths", self.MUSCLES, "walk.h5")
            _, ahead = self.table(f"{joint}_ahead", "lengths", self.MUSCLES, "walk.h5")
            left, right = (here - back) / step, (ahead - here) / step
            # Where a conditional point comes or goes within the step a difference says nothing.
            smooth = np.abs(right - left) < 1e-3
            self.assertGreater(smooth.mean(), 0.998)
            worst = np.abs(arms + (left + right) / 2)[smooth].max()
            self.assertLess(worst, 1e-7, joint)


if __name__ == "__main__":
    unittest.main()

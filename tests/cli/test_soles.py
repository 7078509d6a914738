"""Settings of the contact problem that `sinew data soles` proposes, from stances to a fit.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_soles.py
"""
import json
import re
import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np

from program import ProgramTest, replace_text

REGIONS = ["calcn_r_rearfoot", "calcn_r_forefoot", "calcn_r_toes", "calcn_l_rearfoot", "calcn_l_forefoot", "calcn_l_toes"]
NOT_MEASURED = "  # Not measured by every plate, or constant: cop_x, cop_z, moment_y.\n"


def turned_about_x(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def with_inverted_foot(text, body, angle):
    """The same robot, whose foot body has its axes turned about x."""
    root = ElementTree.fromstring(text)
    back = turned_about_x(angle).T

    def numbers(element):
        return np.array([float(word) for word in element.text.split()])

    def write(element, values):
        element.text = " ".join(f"{value:.15g}" for value in values)

    for frame in root.iter("PhysicalOffsetFrame"):
        if frame.findtext("socket_parent") == f"/bodyset/{body}":
            assert not numbers(frame.find("orientation")).any()
            write(frame.find("orientation"), [-angle, 0, 0])
            write(frame.find("translation"), back @ numbers(frame.find("translation")))
    for element in root.iter("Body"):
        if element.get("name") == body:
            write(element.find("mass_center"), back @ numbers(element.find("mass_center")))
    for marker in root.iter("Marker"):
        if marker.findtext("socket_parent_frame") == f"/bodyset/{body}":
            write(marker.find("location"), back @ numbers(marker.find("location")))
    return ElementTree.tostring(root, encoding="unicode")


class Soles(ProgramTest):
    def proposed(self, data, *words):
        return json.loads(self.succeeds("data", "soles", data, "--out", "contact.yaml", "--json", "-", *words))

    def test_a_proposal_is_fitted_as_it_is(self):
        self.stances()
        said = self.succeeds("data", "soles", "stances.h5", "--out", "contact.yaml")
        self.assertEqual(said.splitlines()[0], "contact.yaml")
        text = self.path("contact.yaml").read_text()
        self.assertEqual(re.findall(r'- name: "(.*)"', text), REGIONS)
        self.assertIn(NOT_MEASURED, text)
        self.assertIn("  fit: [force_x, force_y, force_z]\n", text)
        self.assertIn("  floor_velocity: [0.000, 0.000]  # [m/s]\n", text)
        for line in text.splitlines():
            if re.search(r"\d", line) and not line.lstrip().startswith("#") and "- name" not in line:
                self.assertTrue("#" in line or "dissipation" in line, f"no comment: {line}")
        done = self.run_program("identify", "contact", "--data", "stances.h5", "--config", "contact.yaml", "--solver", "lm",
                                "--intervals", "linear", "--out", "run.h5", "--json", "result.json", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        fit = json.loads(self.path("result.json").read_text())["fit"]
        # A twentieth of the robot's weight of 57 N: its true sole is a box of another size.
        vertical = [entry["rmse"] for entry in fit if entry["channel"].endswith("force_y")]
        self.assertEqual(len(vertical), 5)
        self.assertLess(max(vertical), 3)

    def test_the_soles_of_the_robot(self):
        result = self.proposed(self.stances())
        self.assertEqual([region["name"] for region in result["regions"]], REGIONS)
        self.assertEqual(result["findings"], [])
        self.assertEqual([foot["source"] for foot in result["feet"]], ["both", "both"])
        for region in result["regions"]:
            self.assertAlmostEqual(region["position_m"][1], -0.0425, delta=0.003)

    def test_a_foot_body_that_is_inverted(self):
        """Twenty degrees, as in some models: the same place on the floor, in other axes."""
        angle = np.radians(20)
        before = self.proposed(self.stances())

        def invert(file):
            text = file["files/model.osim"][()].decode()
            text = with_inverted_foot(with_inverted_foot(text, "calcn_r", angle), "calcn_l", -angle)
            replace_text(file, "files/model.osim", text)

        self.path("contact.yaml").unlink()
        after = self.proposed(self.changed_stances(invert, "inverted.h5"))
        self.assertEqual(after["findings"], [])
        for old, new in zip(before["regions"], after["regions"]):
            turn = turned_about_x(angle if "_r_" in new["name"] else -angle)
            np.testing.assert_allclose(turn @ new["position_m"], old["position_m"], atol=5e-4)
            np.testing.assert_allclose(new["size_m"], old["size_m"], atol=5e-4)
            tilt = -angle if "_r_" in new["name"] else angle
            np.testing.assert_allclose(np.subtract(new["orientation_rad"], old["orientation_rad"]), [tilt, 0, 0], atol=2e-3)

    def test_axes_of_one_foot_body_are_no_difference_of_the_feet(self):
        angle = np.radians(20)

        def invert(file):
            text = file["files/model.osim"][()].decode()
            replace_text(file, "files/model.osim", with_inverted_foot(text, "calcn_r", angle))

        result = self.proposed(self.changed_stances(invert))
        self.assertEqual([foot["source"] for foot in result["feet"]], ["both", "both"])
        for region in result["regions"]:
            tilt = -angle if "_r_" in region["name"] else 0
            np.testing.assert_allclose(region["orientation_rad"], [tilt, 0, 0], atol=0.02)

    def test_a_plate_that_is_upside_down_is_left_out(self):
        def turn(file):
            for trial in file["trials"].values():
                for name, channel in trial["forces/channels"].items():
                    if name == "right_force_y":
                        channel[...] = -channel[()]

        done = self.run_program("data", "soles", self.changed_stances(turn), "--out", "contact.yaml")
        self.assertEqual(done.returncode, 0, done.stderr)
        notes = " ".join(done.stderr.split())
        self.assertIn("note: trial 'train_1', plate 'right': its vertical force points down", notes)
        self.assertEqual(notes.count("note: "), 3)
        self.assertNotIn('plate: "right"', self.path("contact.yaml").read_text())

    def test_bad_input(self):
        def upside_down(file):
            for trial in file["trials"].values():
                for name, channel in trial["forces/channels"].items():
                    if name.endswith("force_y"):
                        channel[...] = -channel[()]

        def without_coordinates(file):
            for trial in file["trials"].values():
                del trial["coordinates"]

        def without_model(file):
            del file["files/model.osim"]

        def one_plate(file):
            for trial in file["trials"].values():
                channels = trial["forces/channels"]
                for name in list(channels):
                    if name.startswith("left_"):
                        channels.move(name, name.replace("left_", "right_"))

        words = ("data", "soles")
        self.stances()
        self.refuses("--out is required", *words, "stances.h5")
        self.refuses("--floor-height", *words, "stances.h5", "--out", "c.yaml", "--floor-height", "low")
        self.refuses("is read by this command", *words, "stances.h5", "--out", "stances.h5")
        self.refuses("absent.h5", *words, "absent.h5", "--out", "c.yaml")
        for change, part in ((upside_down, "no sole can be proposed: trial 'train_1', plate 'right': its vertical force"),
                             (without_coordinates, "run `sinew data kinematics` on its markers first"),
                             (without_model, "holds no file 'model.osim'"),
                             (one_plate, "plate 'right' carries 'calcn_r' in trial 'train_1' and 'calcn_l' in trial")):
            name = self.changed_stances(change, "changed.h5")
            self.refuses(part, *words, name, "--out", "c.yaml")


if __name__ == "__main__":
    unittest.main()

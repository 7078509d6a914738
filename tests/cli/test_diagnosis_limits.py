"""Data from which little or nothing can be concluded: a clear statement, never a crash or a confident wrong name.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_diagnosis_limits.py
"""
import json
import shutil
import unittest

import h5py
import numpy as np

from program import ProgramTest, ROOT

DRIVE = ROOT / "datasets" / "data" / "knee_drive.h5"  # dry friction is hidden in it, see knee_drive.truth.json
FRICTION = {"asymmetric_friction", "coulomb_friction", "stribeck_friction"}


class Limits(ProgramTest):
    def data(self, change):
        """A copy of the knee drive's data on which change(h5py.File) was done."""
        shutil.copy(DRIVE, self.path("drive.h5"))
        with h5py.File(self.path("drive.h5"), "r+") as file:
            change(file)
        return "drive.h5"

    def diagnose(self, data):
        said = self.succeeds("diagnose", "drive", "--data", data, "--out", "why.h5", "--json", "why.json", "--quiet")
        return json.loads(self.path("why.json").read_text()), said

    @staticmethod
    def each_position(change):
        def of(file):
            for trial in file["trials"].values():
                channel = trial["joint/channels/position"]
                values = channel["values"] if isinstance(channel, h5py.Group) else channel
                values[...] = change(values[...])
        return of

    @staticmethod
    def kinds(result):
        return [fact["kind"] for fact in result["sentence_facts"]]

    @staticmethod
    def without(names):
        def of(file):
            for name in list(file["trials"]):
                if names(name, file["trials"][name]):
                    del file["trials"][name]
        return of

    def test_without_validation_trial_no_gain_is_claimed(self):
        result, _ = self.diagnose(self.data(self.without(
            lambda _, trial: trial.attrs["role"] in ("validate", b"validate"))))
        self.assertIn(result["causes"][0]["effect"], FRICTION)
        self.assertFalse(result["gain"])
        self.assertIn("no_held_out_trial", self.kinds(result))

    def test_a_channel_without_variation(self):
        data = self.data(self.each_position(lambda q: 0 * q + 0.3))
        self.fails(f"{data}: channel 'position' does not vary: nothing to fit", "diagnose", "drive", "--data", data,
                   "--out", "why.h5")

    def test_a_filtered_channel_without_stated_noise_is_said_to_have_no_scale(self):
        def smooth(q):
            slow = np.fft.rfft(q - np.linspace(q[0], q[-1], len(q)))
            slow[len(slow) // 8:] = 0
            return np.fft.irfft(slow, len(q)) + np.linspace(q[0], q[-1], len(q))

        def filtered(file):
            self.each_position(smooth)(file)
            for trial in file["trials"].values():
                trial["joint/channels/position"].attrs.pop("sigma", None)
        result, said = self.diagnose(self.data(filtered))
        known, known_said = self.diagnose(self.data(lambda file: None))
        facts = [fact for fact in result["warning_facts"] if fact["kind"] == "noise_level_unknown"]
        self.assertEqual([fact["names"] for fact in facts], [["position", "smooth"]])
        self.assertIn("the noise level of position (filtered, interpolated or computed: no noise is visible)",
                      " ".join(said.split()))
        self.assertNotIn("noise_level_unknown", [fact["kind"] for fact in known["warning_facts"]])
        self.assertNotIn("noise level", known_said)

    def test_gaps_change_nothing_that_matters(self):
        rng = np.random.default_rng(1)

        def gaps(q):
            q[100:180] = np.nan
            q[rng.integers(0, len(q), 40)] = np.nan
            return q
        result, _ = self.diagnose(self.data(self.each_position(gaps)))
        self.assertIn(result["causes"][0]["effect"], FRICTION)

    def test_noise_larger_than_the_signal_names_nothing(self):
        rng = np.random.default_rng(1)
        data = self.data(self.each_position(lambda q: q + rng.normal(size=len(q)) * 5 * np.ptp(q)))
        done = self.run_program("diagnose", "drive", "--data", data, "--out", "why.h5", "--json", "why.json", "--quiet")
        self.assertEqual((done.returncode, done.stderr), (1, "sinew: no usable answer: the noise is too large to name a cause\n"))
        result = json.loads(self.path("why.json").read_text())
        self.assertEqual((result["verdict"], result["concluded"], result["causes"]), ("unexplained", False, []))
        self.assertEqual(result["inconclusive_kind"], "noise_too_large")
        self.assertEqual(self.kinds(result), ["inconclusive", "advice"])

    def test_a_single_short_trial(self):
        def change(file):
            self.without(lambda name, _: name != "train_1")(file)
        self.data(change)
        self.succeeds("data", "cut", "drive.h5", "--trial", "train_1", "--window", "0:0.4", "--as", "short")
        self.succeeds("data", "drop", "drive.h5", "--trial", "train_1")
        result, said = self.diagnose("drive.h5")
        self.assertNotEqual(result["verdict"], "explained", said)
        self.assertIn("no_held_out_trial", self.kinds(result))


if __name__ == "__main__":
    unittest.main()

"""Raw EMG to excitations, as a laboratory has it: sinew data envelope.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_envelope.py
"""
import unittest

import h5py
import numpy as np

from program import ProgramTest, differences

RATE = 2048
MUSCLES = ("soleus_r", "tib_ant_r")
SUMMARY = ("{}: {} muscles in {} trials: high-pass 30 Hz, rectified, low-pass 6 Hz, both of order 4 without lag (order 2 "
           "forward and backward), 200 Hz\n")


def raw_emg(amplitude, seed, start=0.0, seconds=4.0):
    """Times, and noise of 0.1 mV whose strength follows amplitude(t), on an offset of the electrode."""
    time = start + np.arange(int(seconds * RATE) + 1) / RATE
    noise = np.random.default_rng(seed).standard_normal(len(time))
    return time, 1e-4 * amplitude(time) * noise + 3e-5


def burst(at):
    return lambda time: 0.02 + np.exp(-((time - at) / 0.4) ** 2)


class Envelope(ProgramTest):
    def setUp(self):
        super().setUp()
        self.recordings = {"mvc": [2 * v for v in (1, 1)], "walk": [1, 1]}
        with h5py.File(self.path("emg.h5"), "w") as file:
            file.attrs["sinew_schema"] = "dataset/1"
            for t, (trial, strengths) in enumerate(self.recordings.items()):
                group = file.create_group(f"trials/{trial}")
                group.attrs["role"] = "train"
                for m, (muscle, strength) in enumerate(zip(MUSCLES, strengths)):
                    at = 11 + m
                    time, values = raw_emg(lambda t, at=at, s=strength: s * burst(at)(t), 10 * t + m, start=10)
                    channel = group.create_dataset(f"emg/channels/{muscle}", data=values)
                    channel.attrs.update({"unit": "V", "kind": "measured"})
                group["emg/time"] = time

    def envelope(self, *words):
        done = self.run_program("data", "envelope", "emg.h5", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout, " ".join(done.stderr.split())

    def excitation(self, trial, muscle, name="emg.h5"):
        with h5py.File(self.path(name)) as file:
            grid = file[f"trials/{trial}/excitations"]
            channel = grid[f"channels/{muscle}"]
            return grid["time"][()], channel[()], dict(channel.attrs)

    def change(self, muscle, change, trial="walk"):
        with h5py.File(self.path("emg.h5"), "r+") as file:
            channel = file[f"trials/{trial}/emg/channels/{muscle}"]
            values = channel[()]
            change(values)
            channel[...] = values

    def envelope_fails(self, message, *words):
        self.fails(message, "data", "envelope", "emg.h5", *words)

    def test_is_what_nms_reads(self):
        said, noted = self.envelope()
        self.assertTrue(said.startswith(SUMMARY.format("emg.h5", 2, 2)), said)
        for muscle in MUSCLES:
            self.assertRegex(said, rf"  {muscle}: maximum 0\.0001\d+ V in trial 'mvc' at t = 1\d\.\d+ s, divided by it")
        self.assertEqual(noted, "")
        for m, muscle in enumerate(MUSCLES):
            time, values, attributes = self.excitation("walk", muscle)
            self.assertEqual((attributes["unit"], attributes["kind"]), ("1", "input"))
            np.testing.assert_allclose(time, 10 + np.arange(801) / 200, atol=1e-12)
            self.assertGreaterEqual(values.min(), 0)
            self.assertLess(values.max(), 0.8)  # half of the contraction, and chance
            # The burst's shape: envelopes of noise are uncertain to some 20 % at their height.
            self.assertLess(np.abs(values / values.max() - burst(11 + m)(time)).max(), 0.35)
            self.assertLess(abs(time[values.argmax()] - 11 - m), 0.3)
            self.assertAlmostEqual(self.excitation("mvc", muscle)[1].max(), 1, delta=1e-3)

    def test_the_raw_signal_stays_and_again_is_the_same(self):
        with h5py.File(self.path("emg.h5")) as file:
            before = file["trials/walk/emg/channels/soleus_r"][()]
        self.envelope("--out", "once.h5")
        self.envelope()
        said, noted = self.envelope()
        self.assertIn("trial 'walk': its grid 'excitations' was replaced", noted)
        with h5py.File(self.path("emg.h5")) as file, h5py.File(self.path("once.h5")) as once:
            np.testing.assert_array_equal(file["trials/walk/emg/channels/soleus_r"][()], before)
            self.assertEqual(differences(file, once), [])

    def test_by_named_trials_given_values_or_not_at_all(self):
        said, noted = self.envelope("--normalise", "trials:walk", "--out", "walk.h5")
        self.assertRegex(said, r"soleus_r: maximum \S+ V in trial 'walk' .* divided by it; over all trials at most [12]\.\d")
        self.assertRegex(noted, r"soleus_r: \d+ samples lie above 1, at most [12]\.\d+ in trial 'mvc': the maximum that it "
                                "was divided by was not its largest effort")
        self.envelope("--normalise", "none", "--out", "none.h5")
        raw = self.excitation("walk", "soleus_r", "none.h5")
        self.assertEqual(raw[2]["unit"], "V")
        self.envelope("--normalise", "walk", "--out", "short.h5")
        self.assertEqual(self.path("short.h5").read_bytes(), self.path("walk.h5").read_bytes())
        self.assertAlmostEqual(self.excitation("walk", "soleus_r", "walk.h5")[1].max(), 1, delta=1e-3)
        said, _ = self.envelope("--normalize", "values:soleus_r=2e-4,tib_ant_r=3e-4", "--out", "given.h5")
        self.assertIn("divided by 0.0002000 V: at most", said)
        np.testing.assert_allclose(self.excitation("walk", "soleus_r", "given.h5")[1], raw[1] / 2e-4, rtol=1e-12)

    def test_channels_become_muscles(self):
        said, _ = self.envelope("--channels", "soleus_r=soleus", "--out", "one.h5")
        self.assertIn("  soleus (soleus_r): maximum", said)
        with h5py.File(self.path("one.h5")) as file:
            self.assertEqual(list(file["trials/walk/excitations/channels"]), ["soleus"])

    def test_other_filters_and_rates(self):
        said, _ = self.envelope("--high-pass", 300, "--low-pass", 8, "--order", 8, "--rate", 0)
        self.assertIn("high-pass 300 Hz, rectified, low-pass 8 Hz, both of order 8 without lag (order 4 forward and "
                      "backward), at the recording's rate", said)
        with h5py.File(self.path("emg.h5")) as file:
            trial = file["trials/walk"]
            np.testing.assert_array_equal(trial["excitations/time"], trial["emg/time"])

    def test_recordings_with_faults_are_described(self):
        self.change("soleus_r", lambda v: np.clip(v, -6e-5, 6e-5, out=v))
        self.change("soleus_r", lambda v: v.__setitem__(slice(2048, 2058), 6e-5))
        self.change("tib_ant_r", lambda v: v.__setitem__(slice(100, 120), np.nan))
        self.change("tib_ant_r", lambda v: v.__setitem__(slice(4096, 4300), 0))
        _, noted = self.envelope()
        self.assertRegex(noted, r"trial 'walk', soleus_r: clipped: the raw signal stays at its extreme value for \d+ samples "
                                r"in \d+ places, the longest [4-9]\.\d+ ms at t = 1[01][\d.]* s; the envelope is too low there")
        self.assertIn("trial 'walk', tib_ant_r: gaps were bridged: 20 samples in 1 places, the longest 9.77 ms at t = 10.05 s",
                      noted)
        self.assertIn("trial 'walk', tib_ant_r: dropouts: the raw signal is constant for 204 samples in 1 places, the "
                      "longest 99.6 ms at t = 12 s", noted)
        self.assertTrue(np.isfinite(self.excitation("walk", "tib_ant_r")[1]).all())

    def test_a_muscle_without_signal(self):
        self.change("soleus_r", lambda v: v.fill(0))
        _, noted = self.envelope("--out", "ok.h5")
        self.assertIn("trial 'walk', soleus_r: no signal: the raw values never change", noted)
        self.envelope_fails("emg.h5: muscle 'soleus_r' has no signal in trial walk: nothing to divide by; leave it out with "
                            "--channels", "--normalise", "walk")
        self.change("soleus_r", lambda v: v.fill(0), trial="mvc")
        self.envelope_fails("emg.h5: muscle 'soleus_r' has no signal in any trial: nothing to divide by; leave it out with "
                            "--channels")
        self.envelope("--channels", "tib_ant_r")

    def test_a_maximum_at_the_end_of_a_trial(self):
        self.change("soleus_r", lambda v: v[:100].__imul__(500))
        _, noted = self.envelope()
        self.assertIn("soleus_r: its maximum lies at an end of trial 'walk', where the filter depends on a single sample; cut "
                      "that end off, or normalise by other trials", noted)

    def test_recordings_that_cannot_be_filtered(self):
        self.change("tib_ant_r", lambda v: v.__setitem__(slice(2048, 2304), np.nan))
        self.envelope_fails("emg.h5: trial 'walk': channel 'tib_ant_r': a gap of 256 samples (0.125 s) begins 1.000 s after the "
                            "start, longer than the 0.0500 s that are bridged; cut the trial around it")
        self.envelope("--longest-gap", 0.2, "--out", "bridged.h5")
        self.envelope_fails("emg.h5: trial 'mvc': channel 'soleus_r': cut-off 1024 Hz at a sampling rate of 2048 Hz: expected at "
                            "least 0.02048 Hz and less than half of the rate, 1024 Hz", "--high-pass", 1024)
        self.envelope_fails("emg.h5: trial 'mvc': channel 'soleus_r': 8193 samples (4.00 s) are too short for a cut-off of "
                            "0.100 Hz, expected at least 10.0 s", "--low-pass", 0.1)
        with h5py.File(self.path("emg.h5"), "r+") as file:
            file["trials/mvc/emg/time"][500:] += 0.1
        self.envelope_fails("emg.h5: trial 'mvc': the samples are not evenly spaced: a step of 0.1 s after t = 10.24 s, "
                            "0.000488 s elsewhere")

    def test_wrong_words(self):
        hint = "expected all, none, a trial, trials:NAME,... or values:MUSCLE=VALUE,..."
        self.envelope_fails("emg.h5: no trial 'mcv' to normalise by; the trials are mvc, walk",
                            "--normalise", "trials:mcv")
        self.envelope_fails("--normalise trials:: " + hint, "--normalise", "trials:")
        self.envelope_fails("--normalise values: 'soleus_r' is no MUSCLE=VALUE above 0", "--normalise", "values:soleus_r")
        self.envelope_fails("emg.h5: no maximum is given for the muscle 'tib_ant_r'", "--normalise", "values:soleus_r=1")
        self.envelope_fails("emg.h5: channel 'soleus' does not exist; did you mean 'soleus_r'?", "--channels", "soleus")
        self.envelope_fails("emg.h5: channels 'soleus_r' and 'tib_ant_r' would both become 'x'", "--channels",
                            "soleus_r=x,tib_ant_r=x")
        self.envelope_fails("order 3: expected an even number from 2 to 16; half of it "
                            "is run forward and half of it backward", "--order", 3)
        self.envelope_fails("emg.h5: a rate of 30 Hz is too low for an envelope low-passed at 6 Hz, expected at least 38 Hz",
                            "--rate", 30)
        self.envelope_fails("emg.h5: no trial has a grid 'analog'; its grids are emg", "--grid", "analog")
        self.fails("none.h5: no such file", "data", "envelope", "none.h5")
        self.stances()
        done = self.run_program("data", "envelope", "stances.h5")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"\Asinew: error: stances\.h5: no trial has a grid of raw EMG \(named emg, or with "
                                      r"channels in V\); its grids are .*\n\Z")

    def test_a_trial_to_normalise_by_needs_raw_emg(self):
        with h5py.File(self.path("emg.h5"), "r+") as file:
            file.move("trials/mvc/emg", "trials/mvc/other")
            for channel in file["trials/mvc/other/channels"].values():
                channel.attrs["unit"] = "N"
        self.envelope_fails("emg.h5: trial 'mvc', to normalise by, has no raw EMG; trials with raw EMG are walk", "--normalise",
                            "mvc")
        _, noted = self.envelope()
        self.assertIn("no raw EMG in mvc: left as they are", noted)

    def test_a_table_of_millivolts(self):
        time, values = raw_emg(burst(1), 5, seconds=2)
        rows = [f"{t:.6f},{1e3 * v:.9f},{k % 7}" for k, (t, v) in enumerate(zip(time, values))]
        self.write("step.csv", "t,ch1,trigger\n" + "\n".join(rows) + "\n")
        self.write("map.yaml", "time: {column: t, unit: s}\nchannels:\n  soleus_r: {column: ch1, unit: mV}\n"
                               "  trigger: {column: trigger, unit: \"1\"}\n")
        self.assertEqual(self.run_program("data", "import", "step.csv", "--map", "map.yaml", "--out", "emg.h5").returncode, 0)
        said, noted = self.envelope()
        self.assertIn("emg.h5: 1 muscles in 1 trials", said)
        self.assertIn("not in V, so no raw EMG: trigger", noted)
        self.assertAlmostEqual(self.excitation("step", "soleus_r")[1].max(), 1, delta=1e-3)


if __name__ == "__main__":
    unittest.main()

"""A drive whose gain is not what it was: simulated here, without any code of sinew, and diagnosed.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_drive_gain.py
"""
import json
import unittest

import h5py
import numpy as np

from program import ProgramTest

INERTIA, VISCOUS, GRAVITY = 0.04, 0.05, 0.6
DURATION, RATE, NOISE, GROWTH = 10.0, 100, 0.003, 0.06
TRAIN, TRIALS = 3, 5


def swing(torque, gain, begin):
    """Positions [rad] under a torque that is straight between its samples; classical Runge-Kutta."""
    step = 1 / RATE / 4

    def slope(t, q, v):
        return v, (gain(t) * np.interp(t * RATE, np.arange(len(torque)), torque) - VISCOUS * v - GRAVITY * np.sin(q)) / INERTIA

    q, v, seen = begin, 0.0, []
    for i in range(4 * (len(torque) - 1) + 1):
        if i % 4 == 0:
            seen.append(q)
        t = i * step
        a = slope(t, q, v)
        b = slope(t + step / 2, q + step / 2 * a[0], v + step / 2 * a[1])
        c = slope(t + step / 2, q + step / 2 * b[0], v + step / 2 * b[1])
        d = slope(t + step, q + step * c[0], v + step * c[1])
        q += step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        v += step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
    return np.array(seen)


class DriveGain(ProgramTest):
    def record(self, gain, session=False):
        """@param gain of trial i at t"""
        draw = np.random.default_rng(7)
        time = np.arange(int(DURATION * RATE) + 1) / RATE
        with h5py.File(self.path("gain.h5"), "w") as file:
            file.attrs.update(sinew_schema="dataset/1", title="gain", subject="", source="test", licence="", synthetic=1)
            for i in range(TRIALS):
                torque = sum(draw.uniform(0.3, 1) * np.sin(2 * np.pi * 0.1 * 30**draw.uniform() * time + draw.uniform(0, 6.3))
                             for _ in range(6)) * np.minimum(1, 2 * np.minimum(time, DURATION - time))
                torque *= 0.45 / np.abs(torque).max()
                trial = file.create_group(f"trials/trial_{i + 1}")
                trial.attrs.update(role="train" if i < TRAIN else "validate", task="sines")
                if session:
                    trial.attrs["session_time_s"] = i * DURATION
                grid = trial.create_group("joint")
                grid["time"] = time
                position = swing(torque, lambda t, i=i: gain(i, t), draw.uniform(-0.3, 0.3))
                for name, values, unit, kind in (("torque", torque, "N*m", "input"),
                                                 ("position", position + NOISE * draw.standard_normal(len(time)), "rad",
                                                  "measured")):
                    channel = grid.create_dataset("channels/" + name, data=values)
                    channel.attrs.update(unit=unit, kind=kind)

    def diagnose(self):
        self.succeeds("diagnose", "drive", "--data", "gain.h5", "--out", "why.h5", "--json", "why.json", "--quiet")
        found = json.loads(self.path("why.json").read_text())
        self.assertIn(found["verdict"], ("explained", "ambiguous"))
        self.assertGreater(found["gain"]["reduction"], 0.4)
        return {c["effect"]: {p["name"]: p["value"] for p in c["parameters"]} for c in found["causes"]}

    def test_a_gain_that_grows_within_each_trial(self):
        self.record(lambda i, t: 1 + GROWTH * t / DURATION)
        causes = self.diagnose()
        self.assertEqual(set(causes), {"supply_sag"})
        self.assertAlmostEqual(causes["supply_sag"]["thermal_rate"], -GROWTH / DURATION, delta=0.05 * GROWTH / DURATION)

    def test_a_gain_that_settles(self):
        self.record(lambda i, t: 1 + GROWTH * (1 - np.exp(-t / 2)))
        causes = self.diagnose()
        self.assertEqual(set(causes), {"gain_warm_up"})
        self.assertAlmostEqual(causes["gain_warm_up"]["warm_up_gain"], GROWTH, delta=0.1 * GROWTH)
        self.assertAlmostEqual(causes["gain_warm_up"]["warm_up_time"], 2, delta=0.3)

    def test_a_gain_that_grows_over_the_session(self):
        rate = GROWTH / (TRIALS * DURATION)
        self.record(lambda i, t: 1 + rate * (i * DURATION + t), session=True)
        causes = self.diagnose()
        self.assertEqual(set(causes), {"gain_over_session"})
        self.assertAlmostEqual(causes["gain_over_session"]["session_rate"], rate, delta=0.1 * rate)


if __name__ == "__main__":
    unittest.main()

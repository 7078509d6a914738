"""A joint under a cascade of position and speed controller: simulated here, without any code of sinew, and identified.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_drive_cascade.py
"""
import json
import unittest

import h5py
import numpy as np

from program import ProgramTest

TRUE = {"inertia": 0.04, "viscous_friction": 0.05, "gravity_torque": 0.6}
DURATION, RATE, NOISE = 6.0, 200, 1e-4
TICK = 0.005  # [s] one per sample
GAINS = {"position_gain": 9.0, "velocity_gain": 1.4, "velocity_integral": 12.0, "velocity_filter": 0.004,
         "velocity_feedforward": 0.8, "acceleration_feedforward": 0.03, "output_limit": 1.5}


def swing(reference, disturbance, motor_on, begin, substeps=5):
    """Positions [rad] at the ticks. The joint is held at `begin` before the record: the integral carries its weight."""
    step = TICK / substeps

    def slope(q, v, torque):
        return v, (torque - TRUE["viscous_friction"] * v - TRUE["gravity_torque"] * np.sin(q)) / TRUE["inertia"]

    q, v, speed, held = begin, 0.0, 0.0, TRUE["gravity_torque"] * np.sin(begin)
    positions, outputs, paces = [], [], [0.0]
    for k, on in enumerate(motor_on):
        pace = (reference[k] - reference[k - 1]) / TICK if k else 0.0
        if k:
            speed += TICK / (TICK + GAINS["velocity_filter"]) * ((q - positions[-1]) / TICK - speed)
        error = GAINS["position_gain"] * (reference[k] - q) + GAINS["velocity_feedforward"] * pace - speed
        more = GAINS["velocity_integral"] * error * TICK
        torque = GAINS["velocity_gain"] * error + held + more + disturbance[k]
        if k > 1:
            torque += GAINS["acceleration_feedforward"] * (pace - paces[-1]) / TICK
        limit = GAINS["output_limit"]
        if not on:
            held = torque = 0.0
        elif abs(torque) <= limit or torque * error <= 0:
            held += more
        torque = min(max(torque, -limit), limit)
        positions.append(q)
        outputs.append(torque)
        paces.append(pace)
        for _ in range(substeps):
            a = slope(q, v, torque)
            b = slope(q + step / 2 * a[0], v + step / 2 * a[1], torque)
            c = slope(q + step / 2 * b[0], v + step / 2 * b[1], torque)
            d = slope(q + step * c[0], v + step * c[1], torque)
            q += step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
            v += step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
    return np.array(positions), np.array(outputs)


class DriveCascade(ProgramTest):
    def setUp(self):
        super().setUp()
        draw = np.random.default_rng(3)
        time = np.arange(int(DURATION * RATE) + 1) / RATE
        with h5py.File(self.path("cascade.h5"), "w") as file:
            file.attrs.update(sinew_schema="dataset/1", title="cascade", subject="", source="test", licence="", synthetic=1)
            for i in range(3):
                begin = draw.uniform(0.4, 0.8)
                fade = np.minimum(1, time)
                reference = begin + fade * sum(draw.uniform(0.1, 0.4) * np.sin(w * time) for w in draw.uniform(1, 9, 4))
                disturbance = 0.1 * fade * np.sin(draw.uniform(10, 20) * time)
                motor_on = np.where((time >= 4) & (time < 4.5), 0.0, 1.0)
                position, self.outputs = swing(reference, disturbance, motor_on, begin)
                trial = file.create_group(f"trials/trial_{i + 1}")
                trial.attrs.update(role="train" if i < 2 else "validate", task="moves")
                grid = trial.create_group("joint")
                grid["time"] = time
                for name, values, unit, kind in (("reference", reference, "rad", "input"),
                                                 ("disturbance", disturbance, "N*m", "input"),
                                                 ("motor_on", motor_on, "1", "input"),
                                                 ("position", position + NOISE * draw.standard_normal(len(time)), "rad",
                                                  "measured")):
                    channel = grid.create_dataset("channels/" + name, data=values)
                    channel.attrs.update(unit=unit, kind=kind)

    def identify(self, *words, **more):
        lines = {"kind": "cascade", "control_period": TICK, "initial_integral": "fitted", **GAINS, **more}
        self.path("drive.yaml").write_text("drive:\n  controller:\n" + "".join(f"    {k}: {v}\n" for k, v in lines.items()))
        self.succeeds("identify", "drive", "--data", "cascade.h5", "--config", "drive.yaml", "--out", "run.h5", "--json",
                      "run.json", "--quiet", *words)
        found = json.loads(self.path("run.json").read_text())
        return ({p["name"]: p["value"] for p in found["parameters"]},
                max(fit["rmse"] for fit in found["fit"] if fit["channel"] == "position"))

    def test_finds_the_joint_behind_its_controller(self):
        self.assertEqual(np.abs(self.outputs).max(), GAINS["output_limit"])  # the limit is reached
        values, rmse = self.identify()
        self.assertLess(rmse, 1.2 * NOISE)
        for name, true in TRUE.items():
            self.assertAlmostEqual(values[name], true, delta=0.01 * true)

    def test_every_part_of_the_controller_counts(self):
        known = [word for name, true in TRUE.items() for word in ("--fix", f"{name}={true}")]
        _, rmse = self.identify(*known)
        self.assertLess(rmse, 1.2 * NOISE)
        for name in GAINS:
            _, rmse = self.identify(*known, **{name: 1.1 * GAINS[name]})
            self.assertGreater(rmse, 2 * NOISE, name)


if __name__ == "__main__":
    unittest.main()

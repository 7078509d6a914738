#!/usr/bin/python3
"""Recordings of a tank that overflows, as another laboratory would deliver them: made-up, marked synthetic, and made
without any of sinew's code. usage: make_tank_data.py OUT.h5 [SEED]

Truth: outflow area 1e-4 m2, pump gain 2e-5 m3/s/V, and a rim at 0.2 m over which water leaves with 0.08 1/s.
"""
import sys

import h5py
import numpy

CROSS_SECTION, GRAVITY = 0.01, 9.81  # m2, m/s2
AREA, GAIN, RIM, RATE = 1e-4, 2e-5, 0.2, 0.08
SAMPLE, FINE, NOISE = 0.5, 0.005, 0.001  # s, s, m
# Volts at corners that are 50 s apart.
TRIALS = {"fill": ("train", [6, 12, 12, 8, 4]), "high": ("train", [11, 11, 6, 12, 5]),
          "low": ("train", [5, 9, 4, 10, 3]), "check": ("validate", [8, 12, 9, 12, 2])}


def level_of(time, volts, start):
    """Explicit midpoint rule in steps of FINE."""
    def rate(t, level):
        inflow = GAIN * numpy.interp(t, time, volts)
        outflow = AREA * (2 * GRAVITY * max(level, 0)) ** 0.5
        return (inflow - outflow) / CROSS_SECTION - RATE * max(level - RIM, 0)
    levels, level = [], start
    for t in time:
        levels.append(level)
        for i in range(round(SAMPLE / FINE)):
            now = t + i * FINE
            level += FINE * rate(now + FINE / 2, level + FINE / 2 * rate(now, level))
    return numpy.array(levels)


def main(path, seed=1):
    random = numpy.random.default_rng(seed)
    with h5py.File(path, "w") as out:
        out.attrs.update(sinew_schema="dataset/1", title="a tank that overflows", subject="", licence="CC0",
                         source="docs/examples/outside/make_tank_data.py", synthetic=1)
        for number, (name, (role, corners)) in enumerate(TRIALS.items()):
            time = numpy.arange(0, 200, SAMPLE)
            volts = numpy.interp(time, 50.0 * numpy.arange(5), corners)
            level = level_of(time, volts, 0.05 + 0.04 * number) + NOISE * random.standard_normal(len(time))
            trial = out.create_group("trials/" + name)
            trial.attrs.update(role=role, task="pump")
            grid = trial.create_group("logger")
            grid["time"] = time
            for channel, values, unit, kind in (("pump", volts, "V", "input"), ("level", level, "m", "measured")):
                grid["channels/" + channel] = values
                grid["channels/" + channel].attrs.update(unit=unit, kind=kind)


if __name__ == "__main__":
    main(sys.argv[1], *(int(word) for word in sys.argv[2:]))

"""Two tanks, drawn by seed: pump voltage in, level of the lower tank out, sampled every few seconds. The simulator shares no code with
the fitted model (two_tanks.cpp); the data file holds measurements only.

usage: tanks.py SEED OUT.h5
"""
import math
import random
import sys
from dataclasses import dataclass, field

import h5py
import numpy

FINE = 0.1  # [s] of the integrator, classical Runge-Kutta


@dataclass
class Tanks:
    seed: int
    pump_gain: float
    upper_outflow: float
    lower_outflow: float
    effects: dict = field(default_factory=dict)   # name -> {parameter: value}
    outsider: dict = field(default_factory=dict)  # the same; in no library
    noise: float = 0.03       # [V]
    resolution: float = 0.0   # [V]
    interval: float = 4.0     # [s] between samples
    samples: int = 1024
    records: int = 1          # that are fitted

    def truth(self):
        return self.effects

    def base(self):
        return {"pump_gain": self.pump_gain, "upper_outflow": self.upper_outflow, "lower_outflow": self.lower_outflow}


def draw_tanks(seed):
    draw = random.Random(f"long records, tanks {seed}")
    u = draw.uniform
    tanks = Tanks(seed, pump_gain=u(0.028, 0.045), upper_outflow=u(0.035, 0.06), lower_outflow=u(0.035, 0.06))
    possible = {
        "upper_overflow": lambda: {"upper_rate": u(0.05, 0.3), "upper_rim": u(5, 7), "caught_share": draw.choice((0.0, u(0.3, 0.8)))},
        "lower_overflow": lambda: {"lower_rate": u(0.05, 0.3), "lower_rim": u(5, 7)},
        "pump_curve": lambda: {"pump_curve": u(0.03, 0.08)},
        "upper_exponent": lambda: {"upper_exponent": u(-0.15, 0.2)},
        "lower_exponent": lambda: {"lower_exponent": u(-0.15, 0.2)}}
    names = list(possible)
    draw.shuffle(names)
    for name in names[:draw.choice((1, 2, 2))]:
        tanks.effects[name] = possible[name]()
    if draw.random() < 1 / 3:
        tanks.outsider = draw.choice(({"pump_lag": {"pump_time": u(10, 40)}}, {"leaking_base": {"leak": u(0.02, 0.06)}},
                                      {"worn_pump": {"worn": u(0.05, 0.15)}}))
    tanks.noise = u(0.01, 0.05)
    tanks.resolution = draw.choice((0.0, 10 / 4096))
    tanks.interval = draw.choice((1.0, 2.0, 4.0))
    tanks.samples = draw.choice((512, 1024))
    tanks.records = draw.choice((1, 1, 2))
    return tanks


def voltage(tanks, draw):
    """A sum of sines below 0.0144 Hz about a mean, straight between samples [V]."""
    time = tanks.interval * numpy.arange(tanks.samples)
    wave = sum(math.exp(-f / 0.006) * numpy.sin(2 * math.pi * f * time + draw.uniform(0, 2 * math.pi))
               for f in numpy.arange(1, 60) * 2.44e-4)
    return numpy.clip(3 + 1.4 * wave / numpy.std(wave), 0, 8)


def record(tanks, number):
    """One record: time, voltage, level as read."""
    draw = random.Random(f"long records, tanks {tanks.seed}, record {number}")
    volts = voltage(tanks, draw)
    effects = {key: value for effect in (*tanks.effects.values(), *tanks.outsider.values()) for key, value in effect.items()}
    get = effects.get
    length = tanks.interval * tanks.samples

    def rate(t, state, pump):
        upper, lower, delayed = state
        if get("pump_time"):
            lag, pump = (pump - delayed) / get("pump_time"), delayed
        else:
            lag = 0.0
        gain = tanks.pump_gain * (1 - get("worn", 0) * t / length)
        inflow = gain * pump * (1 - get("pump_curve", 0) * pump)
        through = tanks.upper_outflow * max(upper, 0) ** (0.5 + get("upper_exponent", 0))
        over = get("upper_rate", 0) * max(upper - get("upper_rim", 0), 0)
        out = tanks.lower_outflow * max(lower, 0) ** (0.5 + get("lower_exponent", 0))
        over_lower = get("lower_rate", 0) * max(lower - get("lower_rim", 0), 0)
        return numpy.array((inflow - through - over - get("leak", 0) * max(upper - 2, 0) ** 0.5,
                            through + get("caught_share", 0) * over - out - over_lower, lag))

    state = numpy.array((draw.uniform(2, 6), draw.uniform(2, 6), volts[0]))
    levels = []
    steps = round(tanks.interval / FINE)
    for k in range(tanks.samples):
        levels.append(state[1])
        after = volts[min(k + 1, tanks.samples - 1)]
        for i in range(steps):
            t = k * tanks.interval + i * FINE
            at = [volts[k] + (after - volts[k]) * (i + part) / steps for part in (0, 0.5, 1)]
            a = rate(t, state, at[0])
            b = rate(t + FINE / 2, state + FINE / 2 * a, at[1])
            c = rate(t + FINE / 2, state + FINE / 2 * b, at[1])
            d = rate(t + FINE, state + FINE * c, at[2])
            state = state + FINE / 6 * (a + 2 * b + 2 * c + d)
    read = numpy.array([level + draw.gauss(0, tanks.noise) for level in levels])
    if tanks.resolution:
        read = tanks.resolution * numpy.round(read / tanks.resolution)
    return tanks.interval * numpy.arange(tanks.samples), volts, read


def write(tanks, path):
    with h5py.File(path, "w") as out:
        out.attrs.update(sinew_schema="dataset/1", title="two tanks", subject="", licence="CC0", source="benchmarks/long_records/tanks.py",
                         synthetic=1)
        for number in range(tanks.records + 1):
            held_out = number == tanks.records
            time, volts, level = record(tanks, number)
            trial = out.create_group("trials/" + ("held_out" if held_out else f"record_{number + 1}"))
            trial.attrs.update(role="validate" if held_out else "train", task="pump")
            grid = trial.create_group("logger")
            grid["time"] = time
            for channel, values, kind in (("pump", volts, "input"), ("level", level, "measured")):
                grid["channels/" + channel] = values
                grid["channels/" + channel].attrs.update(unit="V", kind=kind)


if __name__ == "__main__":
    TANKS = draw_tanks(int(sys.argv[1]))
    write(TANKS, sys.argv[2])
    print(TANKS)

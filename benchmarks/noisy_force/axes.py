"""Axes driven by a force that is recorded with noise, drawn by seed; nothing feeds the position back. The simulator shares no code with
the fitted model; the data file holds measurements only.

usage: axes.py SEED OUT.h5 [--friction]
"""
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import drive_file  # noqa: E402

SUBSTEPS = 50  # between samples, where there is dry friction


@dataclass
class Axis:
    """Units SI."""
    seed: int
    mass: float
    viscous: float
    coulomb: float         # 0: none
    rate: float            # [Hz]
    duration: float
    trials: int            # that are fitted; one more is held out
    position_noise: float
    force_noise: float
    force: float           # root mean square of the first trial
    records: list          # per trial: times, recorded force, read position


def propagator(mass, viscous, interval):
    """Exact step of position, speed, force and its change over the step, for a force that is straight between samples."""
    rates = numpy.array([[0, interval, 0, 0], [0, -viscous / mass * interval, interval / mass, 0], [0, 0, 0, 1.0], [0, 0, 0, 0]])
    halvings = 16
    small = rates / 2**halvings
    step = numpy.eye(4) + small + small @ small / 2 + small @ small @ small / 6
    for _ in range(halvings):
        step = step @ step
    return step


def without_friction(mass, viscous, interval, force, speed):
    step = propagator(mass, viscous, interval)
    position = numpy.empty(len(force))
    state = numpy.array([0.0, speed])
    for i, now in enumerate(force):
        position[i] = state[0]
        if i + 1 < len(force):
            state = (step @ numpy.array([state[0], state[1], now, force[i + 1] - now]))[:2]
    return position


def with_friction(axis, interval, force, speed):
    """Small steps, each exact for a constant force; a mass that comes to rest stays while the force is below the friction."""
    h = interval / SUBSTEPS
    decay = numpy.exp(-axis.viscous * h / axis.mass)
    position = numpy.empty(len(force))
    x, v = 0.0, speed
    for i, now in enumerate(force):
        position[i] = x
        if i + 1 == len(force):
            break
        for k in range(SUBSTEPS):
            drive = now + (force[i + 1] - now) * (k + 0.5) / SUBSTEPS
            if v == 0.0:
                if abs(drive) <= axis.coulomb:
                    continue
                side = numpy.sign(drive)
            else:
                side = numpy.sign(v)
            steady = (drive - side * axis.coulomb) / axis.viscous
            then = steady + (v - steady) * decay
            if v != 0.0 and then * side < 0:
                then = 0.0
            x += steady * h + (v - steady) * (1 - decay) * axis.mass / axis.viscous if then != 0.0 else 0.5 * v * h
            v = then
    return position


def draw_axis(seed, friction=False):
    draw = numpy.random.default_rng(90000 + seed)
    mass = draw.uniform(1, 10)
    viscous = mass * draw.uniform(1, 6)
    axis = Axis(seed, mass, viscous, 0.0, float(draw.choice([250, 500])), int(draw.choice([8, 12, 16])), int(draw.integers(1, 4)),
                10**draw.uniform(-5.3, -4), 0.0, 0.0, [])
    interval = 1 / axis.rate
    time = numpy.arange(int(axis.duration * axis.rate)) * interval
    for _ in range(axis.trials + 1):
        frequency, share, phase = draw.uniform(.15, 2.5, 6), draw.uniform(.3, 1, 6) * 0.1 / 6, draw.uniform(0, 6.28, 6)
        waves = [(a, 2 * numpy.pi * f, p) for a, f, p in zip(share, frequency, phase)]
        acceleration = sum(-a * w**2 * numpy.sin(w * time + p) for a, w, p in waves)
        speed = sum(a * w * numpy.cos(w * time + p) for a, w, p in waves)
        force = mass * acceleration + viscous * speed
        if not axis.records:
            axis.force = float(numpy.std(force))
            axis.force_noise = axis.force * 10**draw.uniform(-2.3, -1)
            axis.coulomb = 0.3 * axis.force if friction else 0.0
        if friction:
            force = force + axis.coulomb * numpy.sign(speed)
            position = with_friction(axis, interval, force, speed[0])
        else:
            position = without_friction(mass, viscous, interval, force, speed[0])
        axis.records.append((time, force + draw.normal(0, axis.force_noise, len(time)),
                             position + draw.normal(0, axis.position_noise, len(time))))
    return axis


def write(axis, path):
    drive_file.write(path, "a linear axis", "benchmarks/noisy_force/axes.py", axis.records, ("force", "N", axis.force_noise), "m")


if __name__ == "__main__":
    write(draw_axis(int(sys.argv[1]), "--friction" in sys.argv), sys.argv[2])

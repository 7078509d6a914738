"""A forearm of known weight in an exoskeleton, on it the arm of a person: a spring about an angle of rest, and a damper. Drawn by seed. The
simulator shares no code with the fitted model; the data file holds measurements only.

usage: arms.py SEED OUT.h5 [--without-spring]
"""
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import drive_file  # noqa: E402

GRAVITY = 9.80665
TICK = 0.002      # [s] of the controller, and of the records
SUBSTEPS = 2
DURATION = 12.0   # [s]
TRIALS = 3        # that are fitted; one more is held out
LOAD_MASS, LOAD_LENGTH = 1.4, 0.16
POSITION_NOISE, TORQUE_NOISE = 5e-4, 0.01  # [rad], [N*m]


@dataclass
class Arm:
    """Units SI; angles from hanging straight down."""
    seed: int
    inertia: float      # of the joint, beside the known load
    viscous: float
    gain: float         # true torque over the recorded one
    stiffness: float    # of the person; 0: no spring
    rest: float
    records: list       # per trial: times, recorded torque, read position


def reference(draw, number):
    """Sines, or moves with pauses: angle at a time."""
    if number % 2 == 0:
        waves = [(draw.uniform(.3, 1), 2 * math.pi * f, draw.uniform(0, 6.28)) for f in numpy.exp(draw.uniform(math.log(.1), math.log(1.2), 5))]
        most = sum(a for a, _, _ in waves)
        return lambda t: 0.9 + 0.75 * sum(a * math.sin(w * t + p) for a, w, p in waves) / most
    times, angles = [0.0], [draw.uniform(.1, 1.7)]
    while times[-1] < DURATION:
        target = draw.uniform(.1, 1.7)
        times += [times[-1] + draw.uniform(.3, 1), 0.0]
        times[-1] = times[-2] + max(0.2, 1.9 * abs(target - angles[-1]) / draw.uniform(1, 2.5))
        angles += [angles[-1], target]

    def moves(t):
        i = min(int(numpy.searchsorted(times, t, side="right")), len(times) - 1)
        r = min(max((t - times[i - 1]) / (times[i] - times[i - 1]), 0.0), 1.0)
        return angles[i - 1] + (angles[i] - angles[i - 1]) * r**3 * (10 - 15 * r + 6 * r * r)
    return moves


def simulate(arm, wanted):
    """Torque and position at the ticks. What the controller computes at a tick is reached, on a straight line, at the next."""
    mass = arm.inertia + LOAD_MASS * LOAD_LENGTH**2
    weight = LOAD_MASS * GRAVITY * LOAD_LENGTH

    def acceleration(torque, q, v):
        return (torque - arm.viscous * v - weight * math.sin(q) - arm.stiffness * (q - arm.rest)) / mass

    count = round(DURATION / TICK)
    torque, position = numpy.empty(count), numpy.empty(count)
    q, v = wanted(0.0), 0.0
    now = weight * math.sin(q) + arm.stiffness * (q - arm.rest)
    seen, speed = q, 0.0
    h = TICK / SUBSTEPS
    for i in range(count):
        torque[i], position[i] = now, q
        reading = round(q / 4e-4) * 4e-4
        speed += .12 * ((reading - seen) / TICK - speed)
        seen = reading
        target = wanted(i * TICK)
        rate = (wanted((i + 1) * TICK) - wanted(max(i - 1, 0) * TICK)) / (2 * TICK)
        then = 25 * (target - reading) + 1.5 * (rate - speed) + weight * math.sin(reading)
        for k in range(SUBSTEPS):
            a, b, c = (now + (then - now) * (k + s) / SUBSTEPS for s in (0.0, 0.5, 1.0))
            a1 = acceleration(a, q, v)
            a2 = acceleration(b, q + h / 2 * v, v + h / 2 * a1)
            a3 = acceleration(b, q + h / 2 * (v + h / 2 * a1), v + h / 2 * a2)
            a4 = acceleration(c, q + h * (v + h / 2 * a2), v + h * a3)
            q, v = q + h * (v + h / 6 * (a1 + a2 + a3)), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        now = then
    return torque, position


def draw_arm(seed, without_spring=False):
    draw = numpy.random.default_rng(40000 + seed)
    arm = Arm(seed, draw.uniform(.015, .03), draw.uniform(.2, .6), 1 / draw.uniform(.9, 1.1), draw.uniform(1.5, 4), draw.uniform(.9, 1.5), [])
    if without_spring:
        arm.stiffness = 0.0
    time = numpy.arange(round(DURATION / TICK)) * TICK
    for number in range(TRIALS + 1):
        torque, position = simulate(arm, reference(draw, number))
        arm.records.append((time, torque / arm.gain + draw.normal(0, TORQUE_NOISE, len(time)), position + draw.normal(0, POSITION_NOISE, len(time))))
    return arm


def write(arm, path):
    drive_file.write(path, "an elbow exoskeleton", "benchmarks/elastic_arm/arms.py", arm.records, ("torque", "N*m", TORQUE_NOISE), "rad",
                     [("load_mass", LOAD_MASS, "kg"), ("load_length", LOAD_LENGTH, "m")])


if __name__ == "__main__":
    write(draw_arm(int(sys.argv[1]), "--without-spring" in sys.argv), sys.argv[2])

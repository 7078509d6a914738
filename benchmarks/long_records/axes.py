"""Linear axes, drawn by seed: force in, position out, recorded under a controller. The simulator shares no code with the fitted model;
the data file holds measurements only, the truth stays here.

usage: axes.py SEED OUT.h5 [CONFIG.yaml]
"""
import math
import random
import sys
from dataclasses import dataclass, replace

import h5py
import numpy

STEP = 2.5e-4  # [s] of the integrator, at most
STILL = 1e-9   # [m/s] below which a speed counts as zero


@dataclass
class Axis:
    """Everything about one axis and its records; units SI."""
    seed: int
    mass: float
    coulomb: float
    offset: float
    forward: float        # [N s/m] viscous friction of forward motion
    backward: float
    cogging: float        # [N] amplitude of a ripple; 0: none
    cogging_period: float
    cogging_phase: float
    noise: float          # [m] deviation, white
    resolution: float     # [m] of the encoder; 0: continuous
    rate: float           # [Hz] of controller and record, which are one
    closed: bool          # fitted from the reference through the controller, not from the force
    held_stated: bool     # the settings say that the force is held between samples (it is)
    trials: int           # that are fitted; one more is held out
    duration: float
    stroke: float
    position_gain: float
    velocity_gain: float
    velocity_filter: float
    disturbance: float = 0.0  # [N] amplitude of a slow force that no record holds ...
    slowness: float = 5.0     # [s] ... and its period

    def truth(self):
        """Effects of the library that are hidden, with their values."""
        effects = {"coulomb_friction": {"coulomb_torque": self.coulomb}, "torque_offset": {"offset_torque": -self.offset},
                   "asymmetric_viscous_friction": {"viscous_asymmetry": (self.forward - self.backward) / 2}}
        if self.cogging:
            effects["cogging"] = {"cogging_period": self.cogging_period}
        if not self.closed and not self.held_stated:
            effects["hold"] = {"hold_fraction": 1.0}
        return effects

    def base(self):
        return {"inertia": self.mass, "viscous_friction": (self.forward + self.backward) / 2}

    def settings(self):
        if self.closed:
            return ("drive:\n  hold: zero\n  controller:\n    kind: cascade\n"
                    f"    position_gain: {self.position_gain!r}\n    velocity_gain: {self.velocity_gain!r}\n"
                    f"    velocity_filter: {self.velocity_filter!r}\n    control_period: {1 / self.rate!r}\n    output: torque\n")
        return f"drive:\n  hold: {'zero' if self.held_stated else 'linear'}\n"


def draw_axis(seed):
    draw = random.Random(f"long records, axis {seed}")
    u = draw.uniform
    closed = draw.random() < 0.5
    rate = draw.choice((250.0, 500.0, 1000.0))
    trials = draw.choice((1, 1, 2))
    mass = u(20, 150)
    viscous = mass * u(1.2, 4)
    asymmetry = draw.choice((-1, 1)) * u(0.06, 0.2)
    coulomb = mass * u(0.1, 0.3)
    stroke = u(0.1, 0.25)
    return Axis(seed=seed, mass=mass, coulomb=coulomb, offset=draw.choice((-1, 1)) * u(0.1, 0.4) * coulomb,
                forward=viscous * (1 + asymmetry), backward=viscous * (1 - asymmetry),
                cogging=coulomb * u(0.1, 0.3) if draw.random() < 0.4 else 0.0, cogging_period=stroke / u(3, 9), cogging_phase=u(0, 2 * math.pi),
                noise=(u(0.5e-6, 3e-6) if closed else u(1e-6, 2e-5)), resolution=draw.choice((0.0, 1e-6)), rate=rate, closed=closed,
                held_stated=draw.random() < 0.6, trials=trials, duration=24.0 if trials == 1 else 12.0, stroke=stroke,
                position_gain=u(8, 20), velocity_gain=mass * u(20, 40), velocity_filter=u(0.002, 0.006))


def draw_rippled_axis(seed):
    """An axis whose force ripples 12 to 28 times along the stroke, as with the pitch of a screw; two short records, force in."""
    draw = random.Random(f"ripple {seed}")
    axis = draw_axis(seed)
    ripples = draw.uniform(12, 28)
    return replace(axis, cogging=axis.coulomb * draw.uniform(0.15, 0.3), cogging_period=axis.stroke / ripples, trials=2, duration=8.0, rate=250,
                   closed=False, resolution=0.0)


def reference(axis, draw):
    """Moves between random places with a trapezoidal speed, or a sum of sines [m], at every sample."""
    time = numpy.arange(round(axis.duration * axis.rate)) / axis.rate
    if draw.random() < 0.5:
        wave = sum(share * numpy.sin(2 * math.pi * f * draw.uniform(0.9, 1.1) * time + draw.uniform(0, 6))
                   for share, f in ((0.5, 0.15), (0.35, 0.4), (0.15, 1.3)))
        return axis.stroke / 2 * wave * numpy.minimum(1, time / 1.5)
    place = numpy.zeros(len(time))
    at, now = 0.0, 0.5
    while now < axis.duration:
        to = draw.uniform(-0.5, 0.5) * axis.stroke
        speed, acceleration = draw.uniform(0.5, 1.5) * axis.stroke, draw.uniform(3, 10) * axis.stroke
        far = abs(to - at)
        speed = min(speed, math.sqrt(far * acceleration))
        ramp = speed / acceleration
        lasts = far / speed + ramp
        s = numpy.clip(time - now, 0, lasts)
        done = (numpy.minimum(s, ramp) ** 2 / 2 * acceleration + numpy.clip(s - ramp, 0, lasts - 2 * ramp) * speed)
        late = numpy.clip(s - (lasts - ramp), 0, ramp)
        done += late * speed - late ** 2 / 2 * acceleration
        place += math.copysign(1, to - at) * done
        at, now = to, now + lasts + draw.uniform(0.1, 0.8)
    return place


class Body:
    """The moving mass: classical Runge-Kutta steps, reversals located by bisection, sticking while friction can hold it."""

    def __init__(self, axis):
        self.axis, self.x, self.v = axis, 0.0, 0.0

    def push(self, x, force):
        a = self.axis
        if a.cogging:
            force -= a.cogging * math.sin(2 * math.pi * x / a.cogging_period + a.cogging_phase)
        return force - a.offset

    def accelerate(self, x, v, force, way):
        a = self.axis
        viscous = a.forward if way > 0 else a.backward
        return (self.push(x, force) - way * a.coulomb - viscous * v) / a.mass

    def step(self, h, force, way):
        x, v = self.x, self.v
        f = self.accelerate
        a1 = f(x, v, force, way)
        a2 = f(x + h / 2 * v, v + h / 2 * a1, force, way)
        a3 = f(x + h / 2 * (v + h / 2 * a1), v + h / 2 * a2, force, way)
        a4 = f(x + h * (v + h / 2 * a2), v + h * a3, force, way)
        return (x + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4))

    def move(self, duration, force):
        left = duration
        while left > 1e-12:
            if abs(self.v) < STILL:
                self.v = 0.0
                push = self.push(self.x, force)
                if abs(push) <= self.axis.coulomb:
                    return  # sticks until the force changes
                way = math.copysign(1, push)
            else:
                way = math.copysign(1, self.v)
            h = min(left, STEP)
            x, v = self.step(h, force, way)
            if v * way < 0:
                low, high = 0.0, h
                for _ in range(50):
                    middle = (low + high) / 2
                    if self.step(middle, force, way)[1] * way < 0:
                        high = middle
                    else:
                        low = middle
                x, _ = self.step(low, force, way)
                v, h = 0.0, max(low, 1e-12)
            self.x, self.v = x, v
            left -= h


def record(axis, number):
    """One record: time, reference, force (held over the following sample), position as read."""
    draw = random.Random(f"long records, axis {axis.seed}, record {number}")
    wanted = reference(axis, draw)
    period = 1 / axis.rate
    body = Body(axis)
    position, force = [], []
    before, velocity = None, 0.0
    for k, goal in enumerate(wanted):
        read = body.x + draw.gauss(0, axis.noise)
        if axis.resolution:
            read = axis.resolution * round(read / axis.resolution)
        if before is not None:
            velocity += period / (axis.velocity_filter + period) * ((read - before) / period - velocity)
        before = read
        push = axis.velocity_gain * (axis.position_gain * (goal - read) - velocity)
        position.append(read)
        force.append(push)
        body.move(period, push + axis.disturbance * math.sin(2 * math.pi * k * period / axis.slowness + axis.cogging_phase))
    return numpy.arange(len(wanted)) * period, wanted, numpy.array(force), numpy.array(position)


def write(axis, path):
    with h5py.File(path, "w") as out:
        out.attrs.update(sinew_schema="dataset/1", title="a linear axis", subject="", licence="CC0", source="benchmarks/long_records/axes.py",
                         synthetic=1)
        for number in range(axis.trials + 1):
            time, wanted, force, position = record(axis, number)
            held_out = number == axis.trials
            trial = out.create_group("trials/" + ("held_out" if held_out else f"record_{number + 1}"))
            trial.attrs.update(role="validate" if held_out else "train", task="moves")
            grid = trial.create_group("controller")
            grid["time"] = time
            given = ("reference", wanted, "m", "input") if axis.closed else ("force", force, "N", "input")
            for channel, values, unit, kind in (given, ("position", position, "m", "measured")):
                grid["channels/" + channel] = values
                grid["channels/" + channel].attrs.update(unit=unit, kind=kind)


if __name__ == "__main__":
    AXIS = draw_axis(int(sys.argv[1]))
    write(AXIS, sys.argv[2])
    if len(sys.argv) > 3:
        with open(sys.argv[3], "w", encoding="utf-8") as text:
            text.write(AXIS.settings())
    print(AXIS)

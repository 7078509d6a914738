"""Single recordings whose model lacks something, drawn by seed: joints and tanks, simulated here without any of sinew's code."""
import math
import random
from dataclasses import dataclass, field

import h5py
import numpy

GRAVITY = 9.81       # m/s2
CROSS_SECTION = 0.01  # m2 of the tank of docs/examples/outside/tank.cpp


@dataclass
class Case:
    seed: int
    problem: str          # "drive" or "tank"
    lacks: str            # what the model lacks; "" for nothing
    noise: str            # "white", "rounded", "filtered" or "ar"
    ratio: float          # deviation of what the model cannot follow over that of the noise
    stated: bool          # does the file state the noise level?
    time: numpy.ndarray   # [s]
    command: numpy.ndarray
    clean: numpy.ndarray  # the reading without noise
    signal: float = 0     # [unit] its deviation
    values: dict = field(default_factory=dict)


def _multisine(draw, time, lowest, highest, count=6):
    """Frequencies equally apart in the logarithm, random phases, deviation 1."""
    sum_of = numpy.zeros(len(time))
    for k in range(count):
        frequency = lowest * (highest / lowest) ** ((k + draw.random()) / count)
        sum_of += numpy.sin(2 * math.pi * frequency * time + draw.uniform(0, 2 * math.pi))
    return sum_of / sum_of.std()


def _integrate(rate, state, time, command, other, largest_step):
    """Fourth-order Runge-Kutta; the inputs run straight from sample to sample."""
    states = [state]
    for i in range(len(time) - 1):
        steps = max(1, math.ceil((time[i + 1] - time[i]) / largest_step))
        h = (time[i + 1] - time[i]) / steps
        for k in range(steps):
            at = lambda f: (command[i] + (command[i + 1] - command[i]) * (k + f) / steps,  # noqa: B023,E731
                            other[i] + (other[i + 1] - other[i]) * (k + f) / steps)  # noqa: B023
            t = time[i] + k * h
            k1 = rate(t, state, *at(0))
            k2 = rate(t + h / 2, [x + h / 2 * d for x, d in zip(state, k1)], *at(0.5))
            k3 = rate(t + h / 2, [x + h / 2 * d for x, d in zip(state, k2)], *at(0.5))
            k4 = rate(t + h, [x + h * d for x, d in zip(state, k3)], *at(1))
            state = [x + h / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(state, k1, k2, k3, k4)]
        states.append(state)
    return numpy.array(states)


def _joint(case, draw):
    """A joint with gravity, driven by a multisine; base model: inertia, viscous friction, gravity."""
    u = draw.uniform
    inertia, damping, gravity = u(0.02, 0.08), u(0.02, 0.1), u(0.3, 1.2)
    rate = draw.choice((20, 50, 100, 250))
    duration = min(u(5, 20), 2000 / rate)
    time = numpy.arange(round(duration * rate)) / rate
    command = u(0.2, 0.5) * gravity * _multisine(draw, time, 0.15, u(0.8, 2))
    other = numpy.zeros(len(time))
    lacks = {"flexible": u(2, 6), "pushed": u(0.05, 0.2), "stiffening": u(0.1, 0.6), "dahl": u(0.03, 0.15), "hanging": u(0.05, 0.2),
             "swaying": u(0.02, 0.1)}
    size = lacks.get(case.lacks, 0.0)
    phase, wave = u(0, 2 * math.pi), u(0.2, 1.5)
    if case.lacks == "pushed":  # a slow torque from outside that was not measured
        other = size * gravity * _multisine(draw, time, 0.05, u(0.2, 1.0))
    load = 0.5 * inertia
    stiffness = load * (2 * math.pi * size) ** 2  # flexible: the second mass, at `size` Hz
    hung = 0.3 * inertia
    hung_rate = 2 * math.pi * u(0.5, 2)

    def derivative(t, x, torque, push):
        q, v = x[0], x[1]
        net = torque + push - damping * v - gravity * math.sin(q)
        if case.lacks == "flexible":
            spring = stiffness * (q - x[2]) + 0.02 * stiffness / (2 * math.pi * size) * (v - x[3])
            return [v, (net - spring) / (inertia - load), x[3], spring / load]
        if case.lacks == "hanging":  # a weight that swings along, like a liquid
            spring = hung * hung_rate ** 2 * (q - x[2]) + 0.1 * hung * hung_rate * (v - x[3])
            return [v, (net - spring) / (inertia - hung), x[3], spring / hung]
        if case.lacks == "stiffening":
            net -= size * gravity * q ** 3
        if case.lacks == "swaying":
            net += size * gravity * math.sin(2 * math.pi * wave * t + phase)
        if case.lacks == "dahl":  # Dahl (1968): rubbing that remembers the last turn
            force = x[2]
            return [v, (net - force) / inertia, size * gravity / 0.1 * (v - abs(v) * force / (size * gravity))]
        return [v, net / inertia]

    state = {"flexible": [0.0] * 4, "hanging": [0.0] * 4, "dahl": [0.0] * 3}.get(case.lacks, [0.0, 0.0])
    start = u(-0.3, 0.3)
    state[0] = start
    if len(state) == 4:
        state[2] = start
    case.time, case.command = time, command
    case.clean = _integrate(derivative, state, time, command, other, 0.002)[:, 0]
    case.values = {"rate": rate, "duration": duration}


def _tank(case, draw):
    """A tank that a pump fills; base model: outflow through a hole, gain of the pump."""
    u = draw.uniform
    area, gain = u(5e-5, 2e-4), u(1e-5, 3e-5)
    step = draw.choice((0.1, 0.5, 1, 4))
    duration = min(u(300, 1500), 2000 * step)
    time = numpy.arange(0, duration, step)
    level = u(0.1, 0.3)  # about which it works
    command = area * math.sqrt(2 * GRAVITY * level) / gain * (1 + u(0.15, 0.3) * _multisine(draw, time, 1 / 400, 1 / u(50, 120)))
    command = numpy.maximum(command, 0)
    other = numpy.zeros(len(time))
    if case.lacks == "rain":
        other = u(0.05, 0.2) * area * math.sqrt(2 * GRAVITY * level) * _multisine(draw, time, 1 / 600, 1 / 100)
    size = {"lag": u(5, 40), "cone": u(0.5, 3), "leak": u(0.1, 0.5), "clogs": u(0.1, 0.4), "laminar": u(0.3, 0.8), "upper": u(0.3, 1)}.get(
        case.lacks, 0.0)

    def derivative(t, x, volts, rain):
        height = max(x[0], 0.0)
        outflow = area * math.sqrt(2 * GRAVITY * height)
        inflow = gain * volts
        section = CROSS_SECTION
        if case.lacks == "lag":
            return [(x[1] - outflow) / section, (inflow - x[1]) / size]
        if case.lacks == "upper":  # a tank in between
            upper = area * math.sqrt(2 * GRAVITY * max(x[1], 0.0))
            return [(upper - outflow) / section, (inflow - upper) / (size * section)]
        if case.lacks == "cone":
            section *= 1 + size * (height - level)
        if case.lacks == "clogs":
            outflow *= 1 - size * t / duration
        if case.lacks == "laminar":
            outflow = area * math.sqrt(2 * GRAVITY * level) * ((1 - size) * math.sqrt(height / level) + size * height / level)
        if case.lacks == "leak":  # a second hole, at the level about which it works
            outflow += size * area * math.sqrt(2 * GRAVITY * max(height - level, 0.0))
        return [(inflow + rain - outflow) / section]

    state = {"lag": [level, gain * float(command[0])], "upper": [level, level]}.get(case.lacks, [level])
    case.time, case.command = time, command
    case.clean = _integrate(derivative, state, time, command, other, 0.5)[:, 0]
    case.values = {"rate": 1 / step, "duration": duration}


LACKS = {"drive": ("flexible", "pushed", "stiffening", "dahl", "hanging", "swaying"),
         "tank": ("lag", "cone", "leak", "clogs", "laminar", "upper", "rain")}


def draw_case(seed, nothing=False):
    draw = random.Random(f"undermodelled {seed}")
    problem = draw.choice(("drive", "tank"))
    lacks = draw.choice(LACKS[problem])
    noise = draw.choice(("white", "white", "white", "rounded", "filtered", "ar"))
    case = Case(seed, problem, "" if nothing else lacks, noise, math.exp(draw.uniform(0, math.log(20))), draw.random() < 0.5,
                numpy.empty(0), numpy.empty(0), numpy.empty(0))
    (_joint if problem == "drive" else _tank)(case, draw)
    case.signal = float(case.clean.std())
    return case


def reading(case, deviation):
    """The clean reading with noise of this deviation."""
    noise = numpy.random.default_rng([case.seed, 7]).standard_normal(len(case.time))
    if case.noise == "rounded":
        step = deviation * math.sqrt(12)
        return step * numpy.round(case.clean / step)
    if case.noise == "filtered":  # Butterworth of second order, forwards and backwards, at a tenth of the sampling rate
        share = numpy.fft.rfftfreq(2 * len(noise)) / 0.1
        both = numpy.fft.irfft(numpy.fft.rfft(noise, 2 * len(noise)) / (1 + share ** 4))[:len(noise)]
        return case.clean + deviation * both / both.std()
    if case.noise == "ar":
        rho = random.Random(f"noise {case.seed}").choice((0.5, 0.8, 0.9))
        for i in range(1, len(noise)):
            noise[i] = rho * noise[i - 1] + math.sqrt(1 - rho ** 2) * noise[i]
    return case.clean + deviation * noise


def write(case, path, values, sigma):
    """@param sigma [unit] stated noise level; None for none"""
    channel, unit, command, command_unit = {"drive": ("position", "rad", "torque", "N*m"), "tank": ("level", "m", "pump", "V")}[case.problem]
    with h5py.File(path, "w") as out:
        out.attrs.update(sinew_schema="dataset/1", title="a recording", subject="", licence="CC0", source="benchmarks/undermodelled",
                         synthetic=1)
        trial = out.create_group("trials/only")
        trial.attrs.update(role="train", task="multisine")
        grid = trial.create_group("logger")
        grid["time"] = case.time
        for name, series, of, kind in ((command, case.command, command_unit, "input"), (channel, values, unit, "measured")):
            grid["channels/" + name] = series
            grid["channels/" + name].attrs.update(unit=of, kind=kind)
        if sigma is not None:
            grid["channels/" + channel].attrs["sigma"] = sigma
        if case.problem == "drive":
            out["files/drive.yaml"] = "drive:\n  fit: [position]\n"

#!/usr/bin/python3
"""Hides effects of all levels in made-up experiments of ankle_on_dynamometer, runs `sinew diagnose` on the files, and counts.

Each case: a person, a machine, an effect and its sign are drawn by seed; the data file holds no label. A size is in units of what an
oracle just detects: the change of torque and ankle angle by the effect, without noise and divided by the noise, taken off the span of the
base parameters, has norm 3.605 (see ../hidden_effects/README.md, whose counts these are). Results are kept in --out case by case;
the same command goes on where it was stopped.

usage: counting.py --sinew PATH [--kind none,single,outsider] [--cases 100] [--sizes 2] [--jobs 2] [--first-seed 1] --out results.jsonl
       counting.py --report results.jsonl...
"""
import argparse
import json
import math
import os
import random
import shutil
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "hidden_effects"))
import counting  # noqa: E402
from counting import run  # noqa: E402
from studies import diagnose, numbers, words  # noqa: E402

UNIT = 3.605
NOISE = {"machine_torque": 0.3, "ankle_angle": 3e-3}  # the laboratory's default
SMALL = {"duration": 3, "speeds": 2, "rate": 100}
SPREAD = 0.15  # of the persons and machines about the laboratory's own: standard deviation of the logarithm
TRUTH = {"attachment_inertia": 0.083, "attachment_gravity": 3.4, "attachment_gravity_angle": 0.12, "attachment_friction": 0.21,
         "sole_stiffness": 8.5e6, "sole_friction": 0.15, "strap_stiffness": 6600, "strap_exponent": 105, "strap_pretension": 29,
         "passive_stiffness": 11.5, "passive_exponent": 5.2, "passive_linear_stiffness": 3.8, "passive_damping": 0.42, "shape": -1.1,
         "filter_time": 0.026, "delay": 0.042, "strength.triceps": 1.22, "strength.dorsiflexors": 0.84}
SLACK = {"tendon_slack_length.triceps": 1.008, "tendon_slack_length.dorsiflexors": 0.991}
SLACK_SPREAD = 0.003
# Level: effect: its parameters with a small amplitude, and whether it has two signs.
EFFECTS = {
    "robot": {"dry_friction": ({"dry_friction": 0.05}, False),
              "directional_friction": ({"directional_friction": 0.05}, True),
              "friction_with_load": ({"friction_with_load": 0.005}, False),
              "attachment_stiffness": ({"attachment_stiffness": 0.2}, True)},
    "boundary": {"axis_offset": ({"axis_offset_x": 0.001, "axis_offset_y": 0.001}, True),
                 "strap_loosening": ({"strap_loosening": 1e-4}, True),
                 "sole_exponent": ({"sole_exponent": 0.03}, True),
                 "boundary_relaxation": ({"boundary_relaxation_stiffness": 5}, False)},
    "human": {"passive_hysteresis": ({"passive_hysteresis": 0.05}, False),
              "passive_relaxation": ({"passive_relaxation_stiffness": 1}, False),
              "fatigue": ({"fatigue": 0.003}, True),
              "unseen_drive": ({"unseen_drive": 0.003}, False),
              "emg_crosstalk": ({"emg_crosstalk": 0.01}, False),
              "antagonist": ({"antagonist": 0.5}, False),
              "force_enhancement": ({"force_enhancement": 0.02}, True),
              "force_depression": ({"force_depression": 0.02}, True)},
    "sensor": {"machine_torque.offset": ({"machine_torque.offset": 0.1}, True),
               "machine_torque.drift": ({"machine_torque.drift": 0.05}, True),
               "machine_torque.time_offset": ({"machine_torque.time_offset": 5e-4}, True),
               "ankle_angle.offset": ({"ankle_angle.offset": 5e-4}, True),
               "ankle_angle.drift": ({"ankle_angle.drift": 5e-4}, True)}}
LEVEL = {name: level for level, effects in EFFECTS.items() for name in effects}
TIMES = {"boundary_relaxation": "boundary_relaxation_time", "passive_relaxation": "passive_relaxation_time"}  # 0.2 to 1 s, drawn
OUTSIDERS = {"torque_ripple": 0.1, "turning_column": 2e-4, "tremor": 0.005, "soleus_fades": 0.005, "loose_electrode": 0.02, "bent_arms": 0.003}


class Experiment:
    """A person and a machine, and how an effect changes what is measured there."""

    def __init__(self, sinew, folder, seed):
        self.sinew, self.folder, self.seed = sinew, folder, seed
        own = np.random.default_rng([23, seed])
        self.base = {name: float(value * np.exp(SPREAD * own.standard_normal())) for name, value in TRUTH.items()}
        self.base.update({name: float(value + SLACK_SPREAD * own.standard_normal()) for name, value in SLACK.items()})

    def prepare(self):
        self.clean = self.synthesize("clean", {}, noise=False)
        with h5py.File(self.clean) as file:
            self.fitted = sorted(name for name, trial in file["trials"].items() if trial.attrs["role"] == "train")
        at = self.model(self.clean, self.base)
        columns = []
        for name, value in self.base.items():
            step = 1e-4 * abs(value)
            columns.append((self.model(self.clean, {**self.base, name: value + step}) - at) / step * abs(value))
        self.directions, _ = np.linalg.qr(np.array(columns).T)
        self.left = self.measured(self.clean) - at

    def synthesize(self, name, hidden, noise):
        """A data set; what `hidden` names is its effect and parameters."""
        data = self.folder / f"{name}.h5"
        data.unlink(missing_ok=True)
        words = [f"--set={n}={v!r}" for n, v in {**SMALL, **self.base}.items()]
        if not noise:
            words += ["--set=torque_noise=0", "--set=angle_noise=0", "--set=ankle_noise=0"]
        if hidden and hidden["level"] != "sensor":
            words += ["--effect", hidden["name"] + ":" + ",".join(f"{n}={v!r}" for n, v in hidden["parameters"].items())]
        status, _, message = run(self.sinew, "data", "synthesize", "ankle_on_dynamometer", "--seed", self.seed, *words, "--out", data)
        if status != 0:
            raise ValueError(message)
        return data

    def distort(self, data, hidden):
        """Makes an ideal recording what a sensor with this error would have written; noise comes after it."""
        channel, kind = hidden["name"].split(".")
        amount = hidden["parameters"][hidden["name"]]
        with h5py.File(data, "r+") as file, h5py.File(self.clean) as clean:
            for name, trial in file["trials"].items():
                if channel not in trial["machine/channels"]:
                    continue
                ideal, time = clean[f"trials/{name}/machine/channels/{channel}"][:], clean[f"trials/{name}/machine/time"][:]
                if kind == "offset":
                    change = np.full(ideal.size, amount)
                elif kind == "drift":
                    change = amount * (time - (time[0] + time[-1]) / 2)
                else:
                    change = np.interp(time - amount, time, ideal) - ideal
                trial[f"machine/channels/{channel}"][...] += change

    def measured(self, data):
        with h5py.File(data) as file:
            return np.concatenate([file[f"trials/{trial}/machine/channels/{channel}"][:] / noise for channel, noise in NOISE.items()
                                   for trial in self.fitted if channel in file[f"trials/{trial}/machine/channels"]])

    def model(self, data, base):
        out = self.folder / "model.h5"
        out.unlink(missing_ok=True)
        status, _, message = run(self.sinew, "simulate", "ankle_on_dynamometer", "--data", data, "--threads", 1, "--out", out,
                                 *[w for n, v in base.items() for w in ("--set", f"{n}={v!r}")])
        if status != 0:
            raise ValueError(message)
        with h5py.File(out) as file:
            return np.concatenate([file[f"trials/{trial}/simulated/channels/{channel}"][:] / noise for channel, noise in NOISE.items()
                                   for trial in self.fitted if channel in file[f"trials/{trial}/simulated/channels"]])

    def size(self, hidden):
        """In units of what an oracle just detects."""
        if hidden["level"] == "sensor":
            data = self.folder / "sized.h5"
            shutil.copy(self.clean, data)
            self.distort(data, hidden)
            change = self.measured(data) - self.measured(self.clean)
        else:
            data = self.synthesize("sized", hidden, noise=False)
            change = self.measured(data) - self.model(data, self.base) - self.left
        change -= self.directions @ (self.directions.T @ change)
        return float(np.linalg.norm(change)) / UNIT


def parameters_of(name, amplitude, own):
    if name in OUTSIDERS:
        return {name: amplitude * OUTSIDERS[name]}
    units, _ = EFFECTS[LEVEL[name]][name]
    found = {n: amplitude * unit for n, unit in units.items()}
    if name in TIMES:
        found[TIMES[name]] = own["time"]
    if name == "axis_offset":
        found = {"axis_offset_x": found["axis_offset_x"] * math.cos(own["direction"]),
                 "axis_offset_y": found["axis_offset_y"] * math.sin(own["direction"])}
    return found


def sized(experiment, name, level, size, sign, own):
    """The effect at the wanted size: secants on a curve that is nearly a straight line."""
    amplitude = float(sign)
    for _ in range(8):
        hidden = {"name": name, "level": level, "parameters": parameters_of(name, amplitude, own)}
        got = experiment.size(hidden)
        if got == 0:
            raise ValueError(f"{name} does not show")
        if abs(got / size - 1) < 0.03:
            return {**hidden, "statistic": UNIT * got}
        amplitude *= min(10.0, max(0.1, size / got))
    raise ValueError(f"{name} does not reach the size {size}")


def study(options, kind, size, seed):
    case = {"kind": kind, "size": size, "noise": "white", "seed": seed}
    own = random.Random(1000003 * seed + int(100 * size) + {"none": 0, "single": 1, "outsider": 2}[kind])
    with tempfile.TemporaryDirectory(prefix="hidden_ankle_") as folder:
        experiment = Experiment(options.sinew, Path(folder), seed)
        hidden = None
        if kind != "none":
            experiment.prepare()
        while kind != "none" and hidden is None:
            level = "outside" if kind == "outsider" else own.choice(sorted(EFFECTS))
            name = own.choice(sorted(OUTSIDERS if kind == "outsider" else EFFECTS[level]))
            sign = own.choice([-1, 1]) if kind == "single" and EFFECTS[level][name][1] else 1
            drawn = {"time": math.exp(own.uniform(math.log(0.2), 0)), "direction": own.uniform(0, 2 * math.pi)}
            try:
                hidden = sized(experiment, name, level, size, sign, drawn)
            except ValueError as error:  # a size that sensible values cannot reach: another effect
                case.setdefault("drawn_again", []).append(f"{name}: {error}"[:200])
        data = experiment.synthesize("case", hidden, noise=True)
        if hidden and hidden["level"] == "sensor":
            experiment.distort(data, hidden)
        case["truth"] = truth = {"base": experiment.base, "effects": [hidden] if hidden else []}
        try:
            found, case["seconds"] = diagnose(options, "ankle_on_dynamometer", data, Path(folder), "--solver", options.solver)
        except ValueError as error:
            case["failure"] = str(error)
            return case
    counting.compare(case, truth, found)
    case["levels"] = [[one["level"], one["standing"]] for one in found["levels"]]
    case["concluded"] = found["concluded"]
    known = counting.intervals(found["extended_parameters"] or [])
    case["base_covers"] = counting.base_covered(truth, known)
    return case


def report(cases):
    counting.summarise(cases)
    counting.summarise_by_name(cases)
    done = [c for c in cases if c["kind"] == "single" and "failure" not in c]

    def show(text, hits):
        share = counting.counted(sum(hits), len(hits))
        if share:
            low, high = share["ci95"]
            print(f"{text}: {share['hits']} of {share['of']} ({100 * share['share']:.1f} %; {100 * low:.1f} to {100 * high:.1f} %)")

    def stands(case, *standings):
        return {level for level, standing in case["levels"] if standing in standings}

    for size in sorted({c["size"] for c in done}):
        print(f"\nsize {size:g}")
        at = [c for c in done if c["size"] == size]
        named = [c for c in at if c["detected"]]
        for level in (*EFFECTS, None):
            of = [c for c in named if level in (None, c["truth"]["effects"][0]["level"])]
            every = [c for c in at if level in (None, c["truth"]["effects"][0]["level"])]
            text = level or "all levels"
            right = [c["truth"]["effects"][0]["level"] for c in of]
            show(f"  {text}: detected", [c["detected"] for c in every])
            show(f"  {text}: its level alone to blame, of those detected", [stands(c, "blamed") == {r} for c, r in zip(of, right)])
            show(f"  {text}: its level to blame or possible", [r in stands(c, "blamed", "possible") for c, r in zip(of, right)])
            show(f"  {text}: the effect in the stated set", [c["in_set"] for c in of])
    for kind in ("none", "single"):
        own = [c for c in cases if c["kind"] == kind and "failure" not in c]
        show(f"\n{kind}: base parameters in their 95 % intervals", [hit for c in own for hit in c["base_covers"].values()])
    outside = [c for c in cases if c["kind"] == "outsider" and "failure" not in c]
    show("outsiders put down to known effects", [c["verdict"] in ("explained", "ambiguous") for c in outside])
    for kind in ("none", "single", "outsider"):
        seconds = [c["seconds"] for c in cases if c["kind"] == kind]
        if seconds:
            print(f"{kind}: a diagnosis takes {np.median(seconds):.1f} s in the median, {max(seconds):.1f} at most")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--kind", type=words, default=["none", "single", "outsider"])
    parser.add_argument("--cases", type=int, default=100, help="per kind and size")
    parser.add_argument("--sizes", type=numbers, default=[2.0])
    parser.add_argument("--solver", default="lm")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="one JSON object a line")
    parser.add_argument("--report", type=Path, nargs="+")
    options = parser.parse_args()
    if options.report:
        report([json.loads(line) for path in options.report for line in path.read_text().splitlines()])
        return
    if not options.sinew or not options.out:
        parser.error("--sinew and --out are needed")
    os.environ["OMP_NUM_THREADS"] = "1"
    options.sinew = options.sinew.resolve()
    cases = [json.loads(line) for line in options.out.read_text().splitlines()] if options.out.exists() else []
    done = {(c["kind"], c["size"], c["seed"]) for c in cases}
    plan = [(kind, size, options.first_seed + i) for kind in options.kind for size in (options.sizes if kind != "none" else [0.0])
            for i in range(options.cases)]
    lock = threading.Lock()

    def one(what):
        case = study(options, *what)
        with lock, options.out.open("a") as file:
            file.write(json.dumps(case) + "\n")
        return case

    with ThreadPoolExecutor(options.jobs) as pool:
        cases += list(pool.map(one, [what for what in plan if what not in done]))
    report(cases)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""How much of an outsider's change known effects could take: the bound for any diagnosis that does not have it in its library.

For cases that hidden_effects.py kept (--kind outsider): the change of torque and ankle angle by the outsider, without noise and taken off the span of the
base parameters, against the changes by each known effect, to first order. Prints the share of its squared norm that the nearest effect takes, and what that
leaves (a known effect is detected from 13 on).

usage: nearest_effects.py --sinew PATH [--each 3] outsider.jsonl
"""
import argparse
import json
import os
import tempfile
from pathlib import Path

import h5py
import numpy as np

from hidden_effects import EFFECTS, NOISE, TIMES, Experiment

RELAXATION_TIMES = (0.1, 0.5, 2)  # [s]
SENSOR = {"offset": lambda time, values, noise: np.ones(values.size) / noise, "drift": lambda time, values, noise: (time - time.mean()) / noise,
          "gain": lambda time, values, noise: values, "time_offset": lambda time, values, noise: -np.gradient(values, time)}


def columns_of_model(experiment):
    """Name, changes: of effects within the simulation, a small one of each."""
    at = experiment.model(experiment.clean, experiment.base)
    for level in ("robot", "boundary", "human"):
        for name, (units, _) in EFFECTS[level].items():
            more = [{TIMES[name]: time} for time in RELAXATION_TIMES] if name in TIMES else [{}]
            for rest in more:
                yield name, [experiment.model(experiment.clean, {**experiment.base, **rest, one: unit}) - at for one, unit in units.items()]


def columns_of_sensors(experiment):
    """Of all trials together, and of each alone."""
    rows = []
    with h5py.File(experiment.clean) as file:
        for channel, noise in NOISE.items():
            for trial in experiment.fitted:
                grid = file[f"trials/{trial}/machine"]
                if channel in grid["channels"]:
                    rows.append((channel, trial, grid["time"][:], grid["channels"][channel][:] / noise, noise))
    for channel in NOISE:
        for kind, change in SENSOR.items():
            for alone in (None, *(trial for name, trial, *_ in rows if name == channel)):
                column = [change(time, values, noise) if name == channel and alone in (None, trial) else np.zeros(values.size)
                          for name, trial, time, values, noise in rows]
                yield f"{channel}.{kind}" + (f"@{alone}" if alone else ""), [np.concatenate(column)]


def nearest(sinew, case):
    hidden = case["truth"]["effects"][0]
    with tempfile.TemporaryDirectory() as folder:
        experiment = Experiment(sinew, Path(folder), case["seed"])
        experiment.base = case["truth"]["base"]
        experiment.prepare()

        def left(change):
            return change - experiment.directions @ (experiment.directions.T @ change)

        data = experiment.synthesize("sized", hidden, noise=False)
        change = left(experiment.measured(data) - experiment.model(data, experiment.base) - experiment.left)
        shares = {}
        for name, columns in (*columns_of_model(experiment), *columns_of_sensors(experiment)):
            directions, _ = np.linalg.qr(np.array([left(column) for column in columns]).T)
            share = float(np.sum((directions.T @ change) ** 2) / (change @ change))
            shares[name] = max(share, shares.get(name, 0))
        best = max(shares, key=shares.get)
        return best, shares[best], float((1 - shares[best]) * (change @ change))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", type=Path)
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--each", type=int, default=3, help="cases per outsider")
    options = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    seen = {}
    for case in map(json.loads, options.cases.read_text().splitlines()):
        if "failure" in case:
            continue
        name = case["truth"]["effects"][0]["name"]
        seen[name] = seen.get(name, 0) + 1
        if seen[name] > options.each:
            continue
        best, share, rest = nearest(options.sinew.resolve(), case)
        print(f"{case['seed']} {name}: {best} takes {100 * share:.0f} %, {rest:.1f} left", flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""The thesis's motorised ankle-foot orthosis: errors that grow with speed, their causes, and the errors after.

A laboratory that shares no code with the fitted model drives the orthosis through the thesis's five trials; a late
command and dry friction are hidden in it. The program sees the data file only. README.md describes the comparison and the
roles of the trials.

usage: run.py --sinew PATH [--seed 1] [--delay 0.18] [--friction 1.5] [--work DIR] [--json FILE]
"""
import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

LONGEST = 600  # [s] of one command
DEGREE = math.pi / 180
ROLES = {"train": "fitted", "validate": "held out"}

# Trial: name in the data, what the thesis's Table 10 asks for, its Table 11: position RMSE [deg] and R2, speed RMSE
# [deg/s] and R2 of its simulation against its measurement.
TRIALS = [("speed_05", "5", (1.09, 0.98, 2.10, 0.82)),
          ("speed_10", "10", (1.98, 0.96, 4.25, 0.80)),
          ("speed_20", "20", (2.96, 0.91, 9.82, 0.73)),
          ("speed_10_20", "10, 20", (2.14, 0.95, 6.20, 0.83)),
          ("speed_20_10", "20, 10", (2.23, 0.94, 7.27, 0.76))]
CONSTANT = {"speed_05": 5, "speed_10": 10, "speed_20": 20}  # [deg/s]

# A model from the data sheets, as in the thesis: a rotor of 0.0135 g m2 behind a gear of
# 300, a foot plate of 1.5 kg at 0.1 m, starting at rest at 0. The truth lies near it, not on it.
DATA_SHEET = {"inertia": 1.215, "viscous_friction": 2.5, "gravity_torque": 1.47}
BASE = {"inertia": 1.25, "viscous_friction": 3.0, "gravity_torque": 1.5}  # the truth

# Effects that no such trial can separate from a late command, whatever the method: docs/diagnosis.md.
LATE = {"command_delay", "position.time_offset", "reference.time_offset", "position.low_pass", "reference.low_pass"}
# Laws of dry friction that are one law while the joint turns at few speeds.
DRY = {"coulomb_friction", "asymmetric_friction", "stribeck_friction"}


def sinew(options, *words):
    """Runs the program; a failure ends the study with its message."""
    done = subprocess.run([options.sinew, *map(str, words)], capture_output=True, text=True, timeout=LONGEST, check=False)
    if done.returncode != 0:
        raise SystemExit(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done.stdout


def assignments(values):
    return [word for name, value in values.items() for word in ("--set", f"{name}={value}")]


def channel(file, trial, name):
    """Times and values of a channel, in whichever grid of the trial it is."""
    for grid in file[f"trials/{trial}"].values():
        if name in grid["channels"]:
            return grid["time"][()], grid[f"channels/{name}"][()]
    raise SystemExit(f"{file.filename}: trial {trial} has no channel {name}")


def errors(measured_path, simulated_path):
    """The thesis's measure: by trial, RMSE [deg, deg/s] and R2 of simulated against measured position and speed."""
    found = {}
    with h5py.File(measured_path) as measured, h5py.File(simulated_path) as simulated:
        for trial, _, _ in TRIALS:
            row = []
            for name in ("position", "speed"):
                time, truth = channel(measured, trial, name)
                at, values = channel(simulated, trial, name)
                error = np.interp(time, at, values) - truth
                row += [math.sqrt(np.mean(error**2)) / DEGREE,
                        1 - np.sum(error**2) / np.sum((truth - truth.mean())**2)]
            found[trial] = tuple(row)
    return found


def study(options, folder):
    """Makes the data, runs the program on them; returns everything that is printed."""
    data = folder / "mafo.h5"
    sinew(options, "data", "synthesize", "drive", "--set", "mafo=1", *assignments(BASE), "--set", "known_noise=0",
          "--set", "noise_rho=0.8", "--set", "noise_slow=0.5", "--seed", options.seed, "--out", data,
          "--effect", f"command_delay:command_delay={options.delay}",
          "--effect", f"coulomb_friction:coulomb_torque={options.friction}")
    truth = {"base": BASE, "effects": {"command_delay": {"command_delay": options.delay},
                                       "coulomb_friction": {"coulomb_torque": options.friction}}}
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")  # no command below reads it

    at_rest = {f"initial_{what}@{trial}": 0 for trial, _, _ in TRIALS for what in ("position", "speed")}
    sinew(options, "simulate", "drive", "--data", data, *assignments({**DATA_SHEET, **at_rest}), "--out",
          folder / "data_sheet.h5")
    base = folder / "base_run.h5"
    sinew(options, "identify", "drive", "--data", data, "--out", base, "--quiet")
    sinew(options, "simulate", "drive", "--data", data, "--from", base, "--out", folder / "base.h5")
    said = sinew(options, "diagnose", "drive", "--data", data, "--from", base, "--out", folder / "diagnosis.h5", "--json",
                 folder / "diagnosis.json", "--quiet")
    sinew(options, "simulate", "drive", "--data", data, "--from", folder / "diagnosis.h5", "--out", folder / "after.h5")
    with h5py.File(data) as file:
        roles = {trial: file[f"trials/{trial}"].attrs["role"] for trial, _, _ in TRIALS}
        roles = {trial: role.decode() if isinstance(role, bytes) else role for trial, role in roles.items()}
    return {"seed": options.seed, "truth": truth, "roles": roles, "said": said,
            "diagnosis": json.loads((folder / "diagnosis.json").read_text()),
            "data_sheet": errors(data, folder / "data_sheet.h5"), "base": errors(data, folder / "base.h5"),
            "after": errors(data, folder / "after.h5")}


def stated(diagnosis):
    """Name of every stated cause with the names of its alternatives."""
    return [(cause["effect"], [a["effect"] for a in diagnosis["alternatives"] if a["instead_of"] == cause["effect"]])
            for cause in diagnosis["causes"]]


def named(diagnosis, effect, family):
    """Is the hidden effect stated, as a cause or as an alternative of one, by name or by another of its class?"""
    names = [name for cause, others in stated(diagnosis) for name in (cause, *others)]
    return "by name" if effect in names else "by its class" if family & set(names) else "NOT"


def interval(parameter, digits):
    """Its 95 % interval in words."""
    ends = parameter["ci95"] or [None]
    return "not determined" if None in ends else f"{ends[0]:.{digits}g} to {ends[1]:.{digits}g}"


def row_of(numbers):
    return "{:8.2f} {:6.3f} {:8.2f} {:6.3f}".format(*numbers)


def show(found):
    print(f"MAFO, seed {found['seed']}: RMSE and R2 of the simulation against the measurement, position [deg] and speed [deg/s]\n")
    group = "{:^31}"
    head = f"{'position':>8} {'R2':>6} {'speed':>8} {'R2':>6}"
    print(f"{'trial':>7} {'':9}| {group.format('thesis, Table 11')} | {group.format('model from data sheets')} | "
          f"{group.format('base model, fitted')} | {group.format('with the named causes')}")
    print(f"{'deg/s':>7} {'':9}| {head} | {head} | {head} | {head}")
    for trial, speed, thesis in TRIALS:
        print(f"{speed:>7} {ROLES[found['roles'][trial]]:9}| {row_of(thesis)} | {row_of(found['data_sheet'][trial])} | "
              f"{row_of(found['base'][trial])} | {row_of(found['after'][trial])}")
    print("\nposition error / speed [s], constant speeds:")
    for name, by_trial in (("thesis", {t: r for t, _, r in TRIALS}), ("model from data sheets", found["data_sheet"]),
                           ("with the named causes", found["after"])):
        print(f"  {name:24}" + "  ".join(f"{by_trial[trial][0] / speed:.3f}" for trial, speed in CONSTANT.items()))
    print("\nwhat `sinew diagnose` says:")
    diagnosis = found["diagnosis"]
    print(f"  verdict: {diagnosis['verdict']}")
    hidden = {name: value for effect in found["truth"]["effects"].values() for name, value in effect.items()}
    for cause in diagnosis["causes"]:
        for p in cause["parameters"]:
            print(f"  {cause['effect']}: {p['name']} = {p['value']:.4g} {p['unit']} (95 % interval {interval(p, 4)})"
                  + (f"; hidden: {hidden[p['name']]:g}" if p["name"] in hidden else "; nothing of that name was hidden"))
        others = dict(stated(diagnosis))[cause["effect"]]
        if others:
            print(f"    could also be: {', '.join(others)}")
    before = {p["name"]: p for p in diagnosis["base"]["parameters"]}
    for p in diagnosis["extended_parameters"]:
        if p["name"] in BASE:
            print(f"  {p['name']}: {before[p['name']]['value']:.3g} without the causes, {p['value']:.3g} "
                  f"({interval(p, 3)}) with them {p['unit']}; true: {BASE[p['name']]:g}")
    for effect, family in (("command_delay", LATE), ("coulomb_friction", DRY)):
        print(f"  hidden {effect}: stated {named(diagnosis, effect, family)}")


def main():
    parser = argparse.ArgumentParser(description="The thesis's orthosis: its errors, their causes, the errors after.")
    parser.add_argument("--sinew", required=True, help="the program")
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    parser.add_argument("--delay", type=float, default=0.18, help="hidden delay of the command [s]")
    parser.add_argument("--friction", type=float, default=1.5, help="hidden Coulomb friction [N m]")
    parser.add_argument("--work", help="folder that keeps the files; default: none is kept")
    parser.add_argument("--json", help="everything that is printed, for machines")
    options = parser.parse_args()
    if options.work:
        Path(options.work).mkdir(parents=True, exist_ok=True)
        found = study(options, Path(options.work))
    else:
        with tempfile.TemporaryDirectory(prefix="mafo_") as folder:
            found = study(options, Path(folder))
    show(found)
    if options.json:
        Path(options.json).write_text(json.dumps(found, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

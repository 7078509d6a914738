#!/usr/bin/python3
"""An ankle on a dynamometer: levels fitted in sequence against all at once. Many made-up persons, through the program.

README.md describes truths, fits and counts.

usage: run.py --sinew PATH --seeds 2101:2130 [--jobs 2] --out RESULTS.json
       run.py --steps PATH --seeds 2101:2130 [--jobs 2] --out STEPS.json
       run.py --report RESULTS.json STEPS.json...
"""
import argparse
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "coverage"))
import report  # noqa: E402
from wilson import wilson  # noqa: E402

LONGEST = 900  # [s] of one command
MOST = 500    # evaluations of one fit; 30 to 60 are usual
SMALL = {"duration": 4, "speeds": 3}
FACTOR = 1.4

# What the laboratory takes to be true unless it is told otherwise; truths are drawn about it.
CENTRE = {
    "attachment_inertia": 0.083, "attachment_gravity": 3.4, "attachment_gravity_angle": 0.12, "attachment_friction": 0.21,
    "sole_stiffness": 8.5e6, "strap_stiffness": 6600, "strap_exponent": 105, "strap_pretension": 29, "sole_friction": 0.15,
    "passive_stiffness": 11.5, "passive_exponent": 5.2, "passive_linear_stiffness": 3.8, "passive_damping": 0.42,
    "shape": -1.1, "filter_time": 0.026, "delay": 0.042, "strength.triceps": 1.22, "strength.dorsiflexors": 0.84,
}
SLACK = {"tendon_slack_length.triceps": 1.008, "tendon_slack_length.dorsiflexors": 0.991}
SLACK_REACH = 0.005  # a factor of 1.4 is no muscle

ROBOT = [n for n in CENTRE if n.startswith("attachment_")]
PASSIVE = [n for n in CENTRE if n.startswith(("sole_", "strap_", "passive_"))] + list(SLACK)
ACTIVE = ["shape", "filter_time", "delay", "strength.triceps", "strength.dorsiflexors"] + list(SLACK)
# Name, parameters, and how the names of its trials begin.
SEQUENCE = [("attachment alone", ROBOT, "attachment"), ("passive", PASSIVE, "passive"), ("active", ACTIVE, ("active", "isometric"))]
LEVELS = {"robot": ROBOT, "boundary": [n for n in CENTRE if n.startswith(("sole_", "strap_"))],
          "human": [n for n in [*CENTRE, *SLACK] if not n.startswith(("attachment_", "sole_", "strap_"))]}


def draw(seed):
    random = np.random.default_rng([23, seed])
    truth = {name: value * FACTOR ** random.uniform(-1, 1) for name, value in CENTRE.items()}
    truth.update({name: value + random.uniform(-SLACK_REACH, SLACK_REACH) for name, value in SLACK.items()})
    return truth


def sinew(program, *words):
    """Seconds of one core that a command took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, timeout=LONGEST, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def identify(program, data, folder, name, *words):
    found = folder / f"{name}.json"
    seconds = sinew(program, "identify", "ankle_on_dynamometer", "--data", data, "--solver", "lm", "--intervals", "linear", "--threads", 1,
                    "--max-evaluations", MOST, "--quiet", "--out", folder / f"{name}.h5", "--json", found, *words)
    result = json.loads(found.read_text())
    result["core_seconds"] = seconds
    return result


def estimates(fit, truth, names=None):
    kept = {}
    for p in fit["parameters"]:
        if p["name"] in truth and p["ci95"] is not None and (names is None or p["name"] in names):
            kept[p["name"]] = {k: p[k] for k in ("value", "lower", "upper", "std_error", "std_error_robust", "ci95", "verdict")}
            kept[p["name"]]["truth"] = truth[p["name"]]
    return kept


def torque(fit):
    """RMSE of the torque over the trials that were not fitted [N m]."""
    rows = [f for f in fit["fit"] if f["channel"] == "machine_torque" and f["role"] == "validate"]
    return math.sqrt(sum(f["rmse"] ** 2 * f["n"] for f in rows) / sum(f["n"] for f in rows))


def only(data, begin, path):
    """A copy in which the other trials are not fitted."""
    shutil.copy(data, path)
    with h5py.File(path, "r+") as file:
        for name, trial in file["trials"].items():
            if not name.startswith(begin) and trial.attrs["role"] == "train":
                trial.attrs["role"] = "validate"
    return path


def in_sequence(program, data, folder, truth):
    """One level after the other; what was found is then held as if it were known. The tendons, which two steps fit, are the last one's."""
    found, seconds, last = {}, 0, None
    for name, parameters, begin in SEQUENCE:
        words = ["--free", ",".join(parameters)]
        for other, estimate in found.items():
            words += ["--start" if other in parameters else "--fix", f"{other}={estimate['value']:.17g}"]
        last = identify(program, only(data, begin, folder / "step.h5"), folder, name.replace(" ", "_"), *words)
        found.update(estimates(last, truth, parameters))
        seconds += last["core_seconds"]
    with h5py.File(data) as file:
        held_out = {n for n, t in file["trials"].items() if t.attrs["role"] == "validate"}
    rows = [f for f in last["fit"] if f["channel"] == "machine_torque" and f["trial"] in held_out]
    error = math.sqrt(sum(f["rmse"] ** 2 * f["n"] for f in rows) / sum(f["n"] for f in rows))
    return {"parameters": found, "core_seconds": seconds, "torque": error}


def study(program, seed):
    truth = draw(seed)
    with tempfile.TemporaryDirectory(prefix="ankle_") as folder:
        folder = Path(folder)
        data = folder / "data.h5"
        numbers = {**SMALL, **truth}
        sinew(program, "data", "synthesize", "ankle_on_dynamometer", "--seed", seed, "--out", data, "--quiet",
              *[word for name, value in numbers.items() for word in ("--set", f"{name}={value!r}")])
        one = {"seed": seed, "fits": {"sequence": in_sequence(program, data, folder, truth)}}
        starts = [word for name, value in truth.items() for word in ("--start", f"{name}={value:.17g}")]
        for name, words in (("stepwise", ["--stepwise"]), ("joint", []), ("from_truth", starts)):
            fit = identify(program, data, folder, name, *words)
            one["fits"][name] = {"parameters": estimates(fit, truth), "core_seconds": fit["core_seconds"], "cost": fit["cost"],
                                 "torque": torque(fit), "converged": fit["converged"]}
        return one


def in_steps(program, seed):
    """What the steps of `identify --stepwise` find, with the errors of what they hold (benchmarks/ankle_on_dynamometer/steps.cpp)."""
    truth = draw(seed)
    words = [str(program), str(seed), *(f"{name}={value!r}" for name, value in {**SMALL, **truth}.items())]
    done = subprocess.run(words, capture_output=True, text=True, timeout=LONGEST, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(words)}\n{done.stdout}{done.stderr}")
    result = json.loads(done.stdout)
    found = {}
    for step in result["steps"][:-1]:
        for name, estimate in step["parameters"].items():
            found[name] = {**estimate, "truth": truth[name]}
    return {"seed": seed, "fits": {"carried": {"parameters": found, "core_seconds": result["core_seconds"]}}}


def attempt(what):
    make, program, seed = what
    try:
        return make(program, seed)
    except (RuntimeError, subprocess.TimeoutExpired) as error:
        return {"seed": seed, "failure": str(error)[-600:]}


MISSED = 1.92  # of the cost, half a sum of squares, by which a fit is worse than the one that starts at the truth


def missed(one, name):
    fit = one["fits"][name]
    return "cost" in fit and fit["cost"] > one["fits"]["from_truth"]["cost"] + MISSED


def table(fits):
    print(f"  {'':33s} {'bias':>9s}  {'+-':>7s} {'half width':>10s} {'RMS':>5s}  hold the truth")
    for name in [*CENTRE, *SLACK]:
        ps = [f["parameters"][name] for f in fits if name in f["parameters"]]
        errors = np.array([p["value"] / p["truth"] - 1 for p in ps])
        half = np.median([abs((p["ci95"][1] - p["ci95"][0]) / 2 / p["truth"]) for p in ps])
        hits = sum(map(report.inside, ps))
        low, high = wilson(hits, len(ps))
        rms = math.sqrt(np.mean([report.ratio(p) ** 2 for p in ps]))
        print(f"  {name:33s} {100 * errors.mean():8.2f} % {100 * errors.std(ddof=1) / math.sqrt(len(ps)):6.2f} % {100 * half:8.2f} % {rms:5.2f}  "
              f"{hits:3d}/{len(ps)} ({100 * low:.0f} .. {100 * high:.0f} %)")


TITLES = {"sequence": "one step after the other, held values as if they were known", "carried": "one step after the other, errors of held values carried",
          "stepwise": "steps, then everything", "joint": "everything at once", "from_truth": "everything at once, from the truth"}


def show(results):
    for one in results:
        if "failure" in one:
            print(one["seed"], one["failure"])
    for name, title in TITLES.items():
        done = [one for one in results if name in one.get("fits", {})]
        if len(done) < 2:
            continue
        fits = [one["fits"][name] for one in done]
        lost = [one["seed"] for one in done if missed(one, name)]
        seconds = np.array([f["core_seconds"] for f in fits])
        print(f"{title}: {len(done)} studies, {np.median(seconds):.1f} s of one core in the median, {seconds.max():.1f} at most"
              + (f", {len(lost)} missed the minimum {lost}" if "cost" in fits[0] else ""))
        if "torque" in fits[0]:
            errors = [f["torque"] for f in fits]
            print(f"  torque of trials that were not fitted: {np.median(errors):.3f} N m in the median, {max(errors):.3f} at most")
        for level, names in {"all": [*CENTRE, *SLACK], **LEVELS}.items():
            report.line(level, [(one["seed"], p) for one in done for n, p in one["fits"][name]["parameters"].items() if n in names])
        table([one["fits"][name] for one in done if not missed(one, name)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--steps", type=Path, help="the program ankle_steps, in place of sinew")
    parser.add_argument("--seeds", default="1:10", help="first:last")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path, nargs="*")
    options = parser.parse_args()
    if options.report:
        show([one for path in options.report for one in json.loads(path.read_text())])
        return
    os.environ["OMP_NUM_THREADS"] = "1"
    make, program = (in_steps, options.steps) if options.steps else (study, options.sinew)
    first, last = map(int, options.seeds.split(":"))
    results = []
    # Processes, since every one counts the time of its own children.
    with ProcessPoolExecutor(options.jobs) as pool:
        for one in pool.map(attempt, [(make, program.resolve(), seed) for seed in range(first, last + 1)]):
            results.append(one)
            if options.out:
                options.out.write_text(json.dumps(results))
    show(results)


if __name__ == "__main__":
    main()

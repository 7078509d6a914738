#!/usr/bin/python3
"""Contact whose motion was measured with errors: do 95 % intervals hold the truth, and what if the errors are ignored?

README.md describes the studies and the counts.

usage: run.py --sinew PATH --seeds 1001:1200 --out RESULTS.json [--max-evaluations 3000] [--set full_rate=1]
       run.py --sinew PATH --starts 10 --seeds 1:1
       run.py --report RESULTS.json...
"""
import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from wilson import wilson  # noqa: E402

POSITION, ROTATION = 0.005, 0.0262  # [m, rad] standard deviations of the errors, and of the prior
NAMES = ["stiffness", "dissipation", "static_friction", "dynamic_friction", "viscous_friction"]
ERRORS = f"  motion_errors: {{position: {POSITION}, rotation: {ROTATION}}}\n"
SETTINGS = """contact:
  objective: likelihood
  fit: [force_x, force_y, force_z, cop_x, cop_z, moment_y]
{errors}  regions:
    - {{name: right_sole, body: calcn_r, plate: right, position: [0.0325, -0.07343375, 0.0],
       mesh: {{box: {{size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}}}}}
    - {{name: left_sole, body: calcn_l, plate: left, position: [0.0325, -0.07343375, 0.0],
       mesh: {{box: {{size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}}}}}
  parameters:
    stiffness: {{lower: 1.0e4, upper: 1.0e8, start: 1.0e6}}
    dissipation: {{lower: 0, upper: 100, start: 1}}
"""
LOST = 3.84 / 2  # of the cost, by which a fit is worse than the one that starts at the truth


def draw(seed):
    random = np.random.default_rng([22, seed])
    truth = {"stiffness": 10 ** random.uniform(6.1, 6.5), "dissipation": random.uniform(1, 5),
             "static_friction": random.uniform(0.7, 1.2)}
    truth["dynamic_friction"] = truth["static_friction"] * random.uniform(0.5, 0.9)
    truth["viscous_friction"] = random.uniform(0.3, 1.0)
    return truth


def sinew(options, *words):
    done = subprocess.run([str(options.sinew), *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")


def settings_of(options):
    """Further settings of the synthetic data, --set NAME=VALUE."""
    return {name: float(value) for name, value in (word.split("=") for word in options.set)}


def synthesize(options, seed, truth, stances, data, size):
    values = {**truth, "person": 1, "encoders": 1, "train": stances, "validate": 0, "slip": 0.1,
              "motion_error": size * POSITION, "rotation_error": size * ROTATION, **settings_of(options)}
    sinew(options, "data", "synthesize", "contact", "--seed", seed, "--out", data, "--quiet",
          *[word for name, value in values.items() for word in ("--set", f"{name}={value!r}")])


def cpu_seconds():
    """Of the programs that were run: other jobs on the machine do not change it."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def identify(options, folder, data, settings, *words):
    found = folder / "fit.json"
    began = cpu_seconds()
    sinew(options, "identify", "contact", "--data", data, "--config", settings, "--threads", 1, "--quiet",
          "--out", folder / "fit.h5", "--json", found, *words)
    fit = json.loads(found.read_text())
    return {"cpu": cpu_seconds() - began, "cost": fit["cost"], "evaluations": fit["evaluations"], "converged": fit["converged"],
            "warnings": sorted({w.get("kind") for w in fit["warning_facts"]}),
            "parameters": {p["name"]: {k: p.get(k) for k in ("value", "ci95", "verdict")} for p in fit["parameters"] if p["name"] in NAMES}}


def write_settings(folder):
    with_errors, without = folder / "errors.yaml", folder / "exact.yaml"
    with_errors.write_text(SETTINGS.format(errors=ERRORS))
    without.write_text(SETTINGS.format(errors=""))
    return with_errors, without


def study(options, seed):
    with tempfile.TemporaryDirectory(prefix="motion_errors_") as folder:
        folder = Path(folder)
        with_errors, without = write_settings(folder)
        truth = draw(seed)
        data, exact = folder / "data.h5", folder / "exact.h5"
        synthesize(options, seed, truth, 2, data, 1)
        synthesize(options, seed, truth, 2, exact, 0)
        at_truth = [word for name, value in truth.items() for word in ("--start", f"{name}={value!r}")]
        return {"seed": seed, "truth": truth,
                "fit": identify(options, folder, data, with_errors, "--max-evaluations", options.max_evaluations),
                "oracle": identify(options, folder, data, with_errors, "--solver", "continuation", "--intervals", "linear", *at_truth),
                "ignored": identify(options, folder, data, without, "--max-evaluations", options.max_evaluations),
                "exact": identify(options, folder, exact, without, "--max-evaluations", options.max_evaluations)}


def starts(options, seed):
    """One stance from random starts: how the answer, its time and its evaluations spread."""
    with tempfile.TemporaryDirectory(prefix="motion_errors_") as folder:
        folder = Path(folder)
        with_errors, _ = write_settings(folder)
        truth = draw(seed)
        data = folder / "data.h5"
        synthesize(options, seed, truth, 1, data, 1)
        for solver in ("restarts", "continuation", "lm"):
            fits = []
            for k in range(options.starts):
                random = np.random.default_rng([23, seed, k])
                start = {"stiffness": 10 ** random.uniform(5, 7.5), "dissipation": random.uniform(0, 20),
                         "static_friction": random.uniform(0.2, 2), "dynamic_friction": random.uniform(0.2, 2),
                         "viscous_friction": random.uniform(0, 2)}
                fits.append(identify(options, folder, data, with_errors, "--solver", solver, "--seed", k + 1, "--intervals", "linear",
                                     "--max-evaluations", 10 * options.max_evaluations, *[w for n, v in start.items() for w in ("--start", f"{n}={v!r}")]))
            costs = np.array([f["cost"] for f in fits])
            best = [f for f in fits if f["cost"] < costs.min() + LOST]
            print(f"seed {seed} {solver}: {len(best)} of {len(fits)} starts end at the lowest cost {costs.min():.1f} "
                  f"(median {np.median(costs):.1f}, largest {costs.max():.1f}); "
                  f"{np.median([f['cpu'] for f in fits]):.2f} s and {np.median([f['evaluations'] for f in fits]):.0f} evaluations in the median, "
                  f"at most {max(f['cpu'] for f in fits):.2f} s and {max(f['evaluations'] for f in fits)}")
            for name in NAMES:
                values = np.array([f["parameters"][name]["value"] for f in best])
                print(f"    {name:18s} {values.min():.6g} .. {values.max():.6g} among these; truth {truth[name]:.4g}")


def inside(p, truth):
    return p["ci95"] is not None and p["ci95"][0] <= truth <= p["ci95"][1]


def line(title, pairs):
    if not pairs:
        return
    hits, n = sum(inside(p, t) for p, t in pairs), len(pairs)
    low, high = wilson(hits, n)
    half = np.median([(p["ci95"][1] - p["ci95"][0]) / 2 / t if p["ci95"] else np.nan for p, t in pairs])
    error = np.array([p["value"] / t - 1 for p, t in pairs])
    verdicts = [p["verdict"] for p, _ in pairs]
    counts = ", ".join(f"{v} {verdicts.count(v)}" for v in dict.fromkeys(sorted(verdicts)))
    print(f"  {title:18s} {hits:3d} of {n}: {100 * hits / n:5.1f} % hold the truth (Wilson {100 * low:.1f} .. {100 * high:.1f}); "
          f"half-width {100 * half:.2g} % in the median; error {100 * np.median(error):+.2g} % in the median, "
          f"{100 * np.median(abs(error)):.2g} % its size; {counts}")


def show(results):
    for one in [one for one in results if "failure" in one]:
        print(one["seed"], one["failure"])
    good = [one for one in results if "fit" in one]
    found = [one for one in good if one["fit"]["cost"] <= one["oracle"]["cost"] + LOST]
    best = [one for one in good if one["fit"]["cost"] < one["oracle"]["cost"] - LOST]
    print(f"{len(good)} studies; the search ended above the fit that starts at the truth in {len(good) - len(found)}, below it in {len(best)}")
    cpu = np.array([one["fit"]["cpu"] for one in good])
    print(f"processor time of a fit with intervals: {np.median(cpu):.1f} s in the median, {100 * np.mean(cpu < 4):.0f} % below 4 s; "
          f"{np.median([one['fit']['evaluations'] for one in good]):.0f} evaluations; budget used up in "
          f"{sum(not one['fit']['converged'] for one in good)}")
    for title, which, chosen in (("motion_errors, all", "fit", good), ("motion_errors, where the search found the minimum", "fit", found),
                                 ("errors in the data, ignored", "ignored", good), ("exact motion", "exact", good)):
        print(title)
        for name in NAMES:
            line(name, [(one[which]["parameters"][name], one["truth"][name]) for one in chosen])
        line("all", [(one[which]["parameters"][name], one["truth"][name]) for one in chosen for name in NAMES])
        kinds = [k for one in chosen for k in one[which]["warnings"]]
        print("  warnings:", {k: kinds.count(k) for k in sorted(set(kinds))})


def load(paths):
    return [one for path in paths for one in json.loads(path.read_text())]


def seeds_of(text):
    """Of ranges first:last and single ones, separated by commas."""
    seeds = []
    for part in text.split(","):
        first, _, last = part.partition(":")
        seeds += range(int(first), int(last or first) + 1)
    return seeds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", default="1:10", help="first:last")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="of the synthetic data, such as full_rate=1")
    parser.add_argument("--max-evaluations", type=int, default=3000, help="of one search")
    parser.add_argument("--starts", type=int, default=0, help="instead: one stance from so many random starts")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path, nargs="*")
    options = parser.parse_args()
    if options.report:
        show(load(options.report))
        return
    options.sinew = options.sinew.resolve()
    results = []
    for seed in seeds_of(options.seeds):
        if options.starts:
            starts(options, seed)
            continue
        try:
            results.append(study(options, seed))
        except RuntimeError as error:
            results.append({"seed": seed, "failure": str(error)[-600:]})
        if options.out:
            options.out.write_text(json.dumps(results))
    if results:
        show(results)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Does a calibration find its minimum, whatever the subject? The CEINMS example with other truths.

For every seed all 50 parameters of the project are drawn uniformly in their ranges (C1 and C2 each in theirs), the torques of its three
trials are those of sinew's own forward model at these values (no noise), and every solver calibrates from the subject's start. f is
CEINMS's objective: the sum over trials and joints of the mean squared error over the variance; at the truth it is zero.

usage: ceinms_truths.py --sinew PATH --seeds 1:20 [--tendon rigid|equilibrium|elastic] [--noise 0.3] [--solvers auto,lm,...] [--threads 2] [--out RESULTS.json]
"""
import argparse
import json
import re
import subprocess
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
EXACT = 1e-8


def sinew(options, *words, status=(0,)):
    done = subprocess.run([options.sinew, *map(str, words)], capture_output=True, text=True, timeout=3600, check=False)
    if done.returncode not in status:
        raise SystemExit(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done


def import_project(options):
    data = options.work / "project.h5"
    sinew(options, "data", "ceinms", options.data / "csetup_stiff.xml", "--validate", options.data / "trial3" / "trial3.xml",
          "--out", data)
    with h5py.File(data, "r+") as file:
        settings = file["files/nms.yaml"][()].decode()
        del file["files/nms.yaml"]
        file["files/nms.yaml"] = settings.replace("tendon: rigid", f"tendon: {options.tendon}")
    run = options.work / "start.h5"
    sinew(options, "identify", "nms", "--data", data, "--solver", "lm", "--max-evaluations", 1, "--intervals", "linear", "--quiet",
          "--out", run, status=(0, 1))
    with h5py.File(run) as file:
        table = file["parameters"]
        free = table["free"][:].astype(bool)
        names = [name.decode() for name in table["name"][:]]
        bounds = {n: (lo, hi) for n, lo, hi, f in zip(names, table["lower"][:], table["upper"][:], free) if f}
    return data, bounds


def draw(bounds, random):
    """Values of every parameter; those of the filter from C1 and C2, each uniform in the range of the mean."""
    truth = {}
    for name, (lower, upper) in bounds.items():
        if name.endswith(".filter_mean"):
            c1, c2 = random.uniform(lower, upper, 2)
            mean = (c1 + c2) / 2
            truth[name] = mean
            truth[name.replace("mean", "spread")] = ((c1 - c2) / 2 / (1 + mean)) ** 2
        elif not name.endswith(".filter_spread"):
            truth[name] = random.uniform(lower, upper)
    return truth


def make_case(options, project, bounds, seed):
    """None where the forward model has no prediction at the drawn values (a tendon without equilibrium)."""
    random = np.random.default_rng([20, seed])
    truth = draw(bounds, random)
    simulated = options.work / "simulated.h5"
    simulated.unlink(missing_ok=True)
    sets = [word for name, value in truth.items() for word in ("--set", f"{name}={value:.17g}")]
    done = sinew(options, "simulate", "nms", "--data", project, *sets, "--out", simulated, status=(0, 1, 2))
    if done.returncode:
        return None
    case = options.work / f"case_{seed}.h5"
    case.write_bytes(project.read_bytes())
    with h5py.File(simulated) as source, h5py.File(case, "r+") as target:
        target.attrs["synthetic"] = 1
        for trial in target["trials"]:
            moments = target[f"trials/{trial}/moments/channels"]
            for channel in moments:
                exact = source[f"trials/{trial}/simulated/channels/{channel}"][:]
                moments[channel][...] = exact + options.noise * random.standard_normal(len(exact))
    return case, truth


def calibrate(options, case, solver):
    out = options.work / f"{case.stem}_{re.sub('[^a-z0-9]', '_', solver)}.h5"
    out.unlink(missing_ok=True)
    began = time.monotonic()
    words = [] if solver == "default" else ["--solver", solver]
    done = sinew(options, "identify", "nms", "--data", case, *words, "--threads", options.threads, "--intervals", options.intervals,
                 "--quiet", "--out", out, status=(0, 1))
    wall = time.monotonic() - began
    with h5py.File(out) as file:
        run = dict(file["run"].attrs)
        worst = 0.0
        if "prediction" in file:
            for channel, node in file["prediction/trial3"].items():
                error = node["simulated"][:][-len(node["measured"]):] - node["measured"][:]
                worst = max(worst, float((error ** 2).mean() ** 0.5))
    return {"f": 2 * float(run["cost"]), "seconds": float(run["seconds"]), "wall": wall, "evaluations": int(run["evaluations"]),
            "held_out": worst, "stop": run["stop_reason"], "test": run["stop_test"], "text": done.stdout.split("\n")[1]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data" / "ceinms_example")
    parser.add_argument("--seeds", default="1:20", help="first:last")
    parser.add_argument("--tendon", default="rigid")
    parser.add_argument("--noise", type=float, default=0.0)
    parser.add_argument("--solvers", type=lambda text: text.split(","), default=["default", "ceres", "lm", "hop"])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--intervals", default="linear")
    parser.add_argument("--work", type=Path)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    options.sinew = options.sinew.resolve()
    options.work = options.work or Path(tempfile.mkdtemp(prefix="starts_"))
    options.work.mkdir(parents=True, exist_ok=True)
    project, bounds = import_project(options)
    first, last = map(int, options.seeds.split(":"))
    results = {}
    for seed in range(first, last + 1):
        made = make_case(options, project, bounds, seed)
        if made is None:
            print(f"seed {seed}: no prediction at the drawn values", flush=True)
            continue
        results[seed] = {}
        for solver in options.solvers:
            one = results[seed][solver] = calibrate(options, made[0], solver)
            print(f"seed {seed:3d}  {solver:14s} f {one['f']:9.2e}  {one['evaluations']:6d} evaluations {one['seconds']:7.2f} s  "
                  f"held out {one['held_out']:8.3g} N m  {one['stop']}: {one['test']}", flush=True)
    for solver in options.solvers:
        runs = [r[solver] for r in results.values()]
        seconds = sorted(r["seconds"] for r in runs)
        print(f"{solver:14s} f < {EXACT:g}: {sum(r['f'] < EXACT for r in runs)} of {len(runs)}, f > 5e-3: {sum(r['f'] > 5e-3 for r in runs)}; "
              f"seconds median {np.median(seconds):.2f}, largest {seconds[-1]:.2f}")
    if options.out:
        options.out.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()

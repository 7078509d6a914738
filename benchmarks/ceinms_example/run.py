#!/usr/bin/python3
"""A CEINMS project through sinew: CEINMS's calibration repeated by several solvers, and on torques of our own model.

CEINMS calibrates these 50 parameters in 118 s (documented settings, f = 0.217, not converged) or 235 s (510,000 evaluations,
f = 2.5e-6; held-out trial 0.08 and 0.04 N m). f is the sum over trials and joints of the mean squared error over the variance.

usage: run.py --sinew PATH [--data shared/data/ceinms_example] [--threads 2] [--solvers lm,hop,...] [--work DIR]
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[2]
LONGEST = 3600
# With a budget for solvers without a convergence test.
SOLVERS = {"lm": [], "hop": [], "ceres": [], "ipopt": [], "multistart": [], "cmaes": ["--max-evaluations", "500000"],
           "sa": ["--max-evaluations", "500000"], "sa+lm": ["--max-evaluations", "100000"]}


def sinew(options, *words, status=(0,)):
    done = subprocess.run([options.sinew, *map(str, words)], capture_output=True, text=True, timeout=LONGEST, check=False)
    if done.returncode not in status:
        raise SystemExit(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done


def identify(options, data, solver, extra=()):
    out = options.work / f"{data.stem}_{solver.replace('+', '_')}.h5"
    table = out.with_suffix(".json")
    for path in (out, table):
        path.unlink(missing_ok=True)
    sinew(options, "identify", "nms", "--data", data, "--solver", solver, "--threads", options.threads, "--quiet", "--out", out,
          "--json", table, *extra, status=(0, 1))
    with h5py.File(out) as file:
        run = dict(file["run"].attrs)
        errors = {}
        for trial in file["prediction"]:
            for channel, node in file[f"prediction/{trial}"].items():
                if "measured" in node:
                    error = node["simulated"][:][-len(node["measured"]):] - node["measured"][:]
                    errors[trial, channel] = float((error ** 2).mean() ** 0.5)
    return run, errors, json.loads(table.read_text())


def print_line(name, run, errors):
    held = [errors["trial3", f"{joint}_angle_r_moment"] for joint in ("knee", "ankle")]
    print(f"  {name:12s} f {2 * run['cost']:9.2e}  {run['evaluations']:7d} evaluations {run['seconds']:8.3f} s   held out, N m: "
          f"knee {held[0]:.2g}, ankle {held[1]:.2g}   ({run['stop_reason']})", flush=True)


def own_torques(options, data):
    """The same project with the torques that our own model gives for the true subject."""
    true = options.work / "true.h5"
    setup = options.work / "csetup_true.xml"
    setup.write_text((options.data / "csetup_stiff.xml").read_text().replace("start.xml", str(options.data / "true.xml"))
                     .replace("exc.xml", str(options.data / "exc.xml"))
                     .replace("cal_stiff.xml", str(options.data / "cal_stiff.xml")))
    calibration = (options.data / "cal_stiff.xml").read_text()
    local = options.work / "cal_stiff.xml"
    for trial in ("trial1", "trial2"):
        calibration = calibration.replace(f"{trial}/{trial}.xml", str(options.data / trial / f"{trial}.xml"))
    local.write_text(calibration)
    setup.write_text(setup.read_text().replace(str(options.data / "cal_stiff.xml"), str(local)))
    sinew(options, "data", "ceinms", setup, "--validate", options.data / "trial3" / "trial3.xml", "--out", true)
    simulated = options.work / "simulated.h5"
    simulated.unlink(missing_ok=True)
    sinew(options, "simulate", "nms", "--data", true, "--out", simulated)
    own = options.work / "own.h5"
    own.write_bytes(data.read_bytes())
    with h5py.File(simulated) as source, h5py.File(own, "r+") as target:
        for trial in target["trials"]:
            moments = target[f"trials/{trial}/moments/channels"]
            for channel in moments:
                moments[channel][...] = source[f"trials/{trial}/simulated/channels/{channel}"][:]
    return own


def verdicts(result):
    counts = {}
    for p in result["parameters"]:
        counts.setdefault(p.get("verdict") or "-", []).append(p)
    for verdict, group in sorted(counts.items()):
        print(f"  {verdict}: {len(group)}")
        for p in group if verdict != "identifiable" else []:
            print(f"    {p['name']}: {p.get('reason', '')}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data" / "ceinms_example")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--solvers", type=lambda text: text.split(","), default=list(SOLVERS))
    parser.add_argument("--work", type=Path)
    options = parser.parse_args()
    options.sinew = options.sinew.resolve()
    options.work = options.work or Path(tempfile.mkdtemp(prefix="ceinms_example_"))
    options.work.mkdir(parents=True, exist_ok=True)

    data = options.work / "ceinms.h5"
    data.unlink(missing_ok=True)
    sinew(options, "data", "ceinms", options.data / "csetup_stiff.xml", "--validate", options.data / "trial3" / "trial3.xml",
          "--out", data)
    print("CEINMS's torques, from start.xml")
    best = None
    for solver in options.solvers:
        run, errors, result = identify(options, data, solver, SOLVERS.get(solver, []))
        print_line(solver, run, errors)
        if best is None or run["cost"] < best[0]:
            best = (run["cost"], solver, result)
    print(f"\nverdicts of {best[1]}")
    verdicts(best[2])
    print("\ntorques of our own model with true.xml, from start.xml")
    own = own_torques(options, data)
    for solver in [s for s in options.solvers if s in ("lm", "hop", "ceres")]:
        run, errors, _ = identify(options, own, solver)
        print_line(solver, run, errors)


if __name__ == "__main__":
    main()

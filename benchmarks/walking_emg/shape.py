#!/usr/bin/python3
"""EMG of walking from the knee's angle alone: fitted at 3.6 km/h, predicted at 4.5 km/h, and what differs between the speeds.

Both models of problem emg_shape: (a) the thesis's averaging, (b) the identified one. Strides from the knee angle. EMG as in the
data set's envelopes. The diagnosis sees 20 s of either speed, a muscle at a time, in a model in which nothing changes with speed.

usage: shape.py --sinew PATH [--data DIR] [--work DIR] [--diagnose yes|no]
"""
import argparse
import importlib.util
import json
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
spec = importlib.util.spec_from_file_location("walking", HERE / "run.py")
walking = importlib.util.module_from_spec(spec)
spec.loader.exec_module(walking)

SETTINGS = "angle: knee_angle_r, cycles: {begins_at: highest}, low_pass: 0"


def config(options, name, more):
    path = options.work / f"{name}.yaml"
    path.write_text("emg_shape: {" + ", ".join(w for w in (SETTINGS, more) if w) + "}\n")
    return path


def strides(run, trial):
    node = run[f"details/emg_shape/trials/{trial}"]
    return list(zip(node["begin"][:], node["end"][:]))


def compare(predicted, measured, cycles, at):
    """RMSE, share of the variance explained, and the square of Pearson's correlation, over all strides."""
    inside = np.zeros(len(at), bool)
    for begin, end in cycles:
        inside |= (at >= begin) & (at < end)
    p, m = predicted[inside], measured[inside]
    rmse = np.sqrt(np.mean((p - m) ** 2))
    return rmse, 1 - rmse**2 / np.var(m), np.corrcoef(p, m)[0, 1] ** 2


def predict(options, recordings):
    shape, b, a = options.work / "shape.h5", options.work / "b.h5", options.work / "a.h5"
    hold = "hold_out: [walk45]"
    began = time.monotonic()
    print(walking.sinew(options, "identify", "emg_shape", "--data", recordings, "--config", config(options, "b", hold), "--solver", "lm",
                        "--intervals", "linear", "--quiet", "--out", shape))
    print(f"identified in {time.monotonic() - began:.1f} s")
    walking.sinew(options, "simulate", "emg_shape", "--data", recordings, "--config", config(options, "b", hold), "--from", shape,
                  "--out", b)
    walking.sinew(options, "simulate", "emg_shape", "--data", recordings, "--config", config(options, "a", hold + ", model: averaging"),
                  "--out", a)
    print("walk45 predicted from walk36: RMSE, share of the variance explained, square of the correlation")
    print("| muscle | (a) | (b) | (b) within its 95 % band |\n|---|---|---|---|")
    with h5py.File(recordings) as data, h5py.File(shape) as run, h5py.File(a) as fa, h5py.File(b) as fb:
        measured = data["trials/walk45/excitations"]
        at = measured["time"][:]
        node = run["details/emg_shape/trials/walk45"]
        cycles = strides(run, "walk45")
        for muscle in measured["channels"]:
            if muscle not in node:
                continue
            m = measured["channels"][muscle][:]
            cells = []
            for file in (fa, fb):
                grid = file["trials/walk45/simulated"]
                cells.append("{:.3f}, {:.2f}, {:.2f}".format(*compare(np.interp(at, grid["time"][:], grid["channels"][muscle][:]), m,
                                                                     cycles, at)))
            deviation = node[f"{muscle}/deviation"][:]
            within = np.mean(np.abs(m - node[f"{muscle}/predicted"][:])[len(at) // 20:-len(at) // 20]
                             <= 1.96 * deviation[len(at) // 20:-len(at) // 20])
            print(f"| {muscle} | {' | '.join(cells)} | {100 * within:.0f} % |")


def told(parameter):
    known = parameter.get("ci95")
    return f"{parameter['name']} {parameter['value']:.3g}" + (f" in {known[0]:.2g} .. {known[1]:.2g}" if known else " (at its bound)")


def diagnose(options, both, muscle):
    out = options.work / f"why_{muscle}.h5"
    words = [options.sinew, "diagnose", "emg_shape", "--data", both, "--config",
             config(options, f"d_{muscle}", f"laws: [], muscles: [{muscle}]"), "--solver", "lm", "--quiet", "--out", out, "--json",
             out.with_suffix(".json")]
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False, timeout=1800)
    if not out.with_suffix(".json").exists():
        return f"{muscle}: {done.stderr.strip()}"
    found = json.loads(out.with_suffix(".json").read_text())
    causes = "; ".join(f"{c['effect']} (" + ", ".join(told(p)
                                                       for p in c["parameters"]) + ")" for c in found["causes"])
    gain = found.get("gain")
    return (f"{muscle}: {found['verdict']}; {causes or 'no cause'}"
            + (f"; held out {gain['validate_rmse_before']:.3f} -> {gain['validate_rmse_after']:.3f}" if gain else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=walking.DATA)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--diagnose", choices=["yes", "no"], default="yes")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    options.sinew = options.sinew.resolve()
    with tempfile.TemporaryDirectory(prefix="walking_shape_") as folder:
        options.work = options.work or Path(folder)
        options.work.mkdir(exist_ok=True)
        recordings = walking.import_recordings(options)
        predict(options, recordings)
        if options.diagnose == "yes":
            both = walking.cut(options, recordings, walking.BOTH, options.work / "both.h5")
            with h5py.File(both) as file:
                muscles = list(file["trials/walk36_fit/excitations/channels"])
            with ThreadPoolExecutor(options.jobs) as pool:
                for line in pool.map(lambda m: diagnose(options, both, m), muscles):
                    print(line)


if __name__ == "__main__":
    main()

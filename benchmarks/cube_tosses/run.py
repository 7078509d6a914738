#!/usr/bin/python3
"""114 measured tosses of an acrylic cube: contact identified on 60 of them, whole tosses predicted on all, through the program.

Trials in the order of their numbers; of every 19, ten are fitted and nine held out. A whole toss is predicted from the state
that fits its flight before the first touch; its error is the mean over all frames from its first one until it lies still.

usage: run.py --sinew PATH [--data DIR] [--work DIR] [--threads 1,2] [--release NAME,...]
       run.py --sinew PATH --diagnose 6     # also: what is wrong, on every sixth toss of both kinds
"""
import argparse
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
DATA = HERE.parents[2] / "shared" / "data" / "cube_tosses"
WIDTH = 0.1048  # [m]
ROUND, FITTED = 19, 10


def run(*words, quiet=True):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)
    if done.returncode != 0 or not quiet:
        print(done.stdout + (done.stderr if done.returncode != 0 else ""))
    if done.returncode == 2:
        raise SystemExit(2)
    return done.stdout


def import_tosses(options, data):
    data.unlink(missing_ok=True)
    for i, file in enumerate(sorted(options.data.glob("*.csv"), key=lambda f: int(f.stem))):
        first = [HERE / "free_body.yaml"] if i == 0 else []
        run(options.sinew, "data", "import", file, *first, "--map", HERE / "pose.yaml", "--trial", f"toss_{int(file.stem):03d}",
            "--role", "train" if i % ROUND < FITTED else "validate", *([] if i == 0 else ["--append"]), "--out", data)


def every(data, step, out):
    """Every step-th fitted toss, and every step-th held-out one."""
    shutil.copy(data, out)
    with h5py.File(out, "r+") as file:
        trials = file["trials"]
        for role in ("train", "validate"):
            names = sorted(n for n in trials if trials[n].attrs["role"] in (role, role.encode()))
            for i, name in enumerate(names):
                if i % step:
                    del trials[name]
    return out


def whole_tosses(data, run_file):
    with h5py.File(data) as file:
        roles = {n: file["trials"][n].attrs["role"] for n in file["trials"]}
    print("| whole tosses | n | failed | position, % of the width: mean | median | rotation, degrees: mean | median |")
    print("|---|---|---|---|---|---|---|")
    with h5py.File(run_file) as file:
        tosses = file["details/free_body"]
        for role, words in (("train", "fitted"), ("validate", "held out")):
            names = [n for n in tosses if roles[n] in (role, role.encode())]
            good = [n for n in names if "position_error" in tosses[n]]
            place = [100 * np.mean(tosses[n]["position_error"][:]) / WIDTH for n in good]
            turn = [np.degrees(np.mean(tosses[n]["rotation_error"][:])) for n in good]
            print(f"| {words} | {len(names)} | {len(names) - len(good)} | {np.mean(place):.2f} | {np.median(place):.2f} | "
                  f"{np.mean(turn):.2f} | {np.median(turn):.2f} |")


def restitution(dissipation, speed):
    """Coefficient of restitution of a central impact by the law of Hunt and Crossley, independent of the stiffness: a (1 + e) = ln((1 + a) / (1 - a e)) with
    a = 1.5 c v, from the law's phase curve."""
    a = 1.5 * dissipation * speed
    low, high = 0.0, min(1.0, 1 / a)
    for _ in range(200):
        e = 0.5 * (low + high)
        if a * e >= 1 or np.log((1 + a) / (1 - a * e)) > a * (1 + e):
            high = e
        else:
            low = e
    return e


def touches(run_file):
    """Vertical impact speeds [m/s] of the middle at the last frame before the first touch."""
    speeds = []
    with h5py.File(run_file) as file:
        for toss in file["details/free_body"].values():
            last = int(toss.attrs["frames_before_touch"]) - 1
            time, z = toss["time"][:], toss["measured"][:, 2]
            speeds.append((z[last - 1] - z[last]) / (time[last] - time[last - 1]))
    return np.percentile(speeds, [10, 50, 90])


def identify(options, data, threads, release):
    out = options.work / "run.h5"
    words = [options.sinew, "identify", "free_body", "--data", data, "--threads", threads, "--quiet", "--out", out]
    for text in options.start:
        words += ["--start", text]
    if release:
        words += ["--release", ",".join(release)]
    before = time.monotonic()
    text = run(*words)
    print(text.split("  warning:")[0])
    print(f"{threads} thread{'s' if threads > 1 else ''}: {time.monotonic() - before:.0f} s with intervals\n")
    whole_tosses(data, out)
    with h5py.File(out) as file:
        values = dict(zip(file["parameters/name"].asstr()[:], file["parameters/value"][:]))
    if not release:  # the law alone has a closed form
        print(f"\nrestitution of a central impact with dissipation {values['dissipation']:.3g} s/m: "
              + ", ".join(f"{restitution(values['dissipation'], v):.3f} at {v:.2f} m/s" for v in touches(out))
              + " (a tenth, half, nine tenths of the tosses fall slower)")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--threads", type=lambda text: [int(w) for w in text.split(",")], default=[1, 2])
    parser.add_argument("--release", type=lambda text: text.split(","), default=[])
    parser.add_argument("--start", action="append", default=[])
    parser.add_argument("--diagnose", type=int, metavar="STEP")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        options.work = options.work or Path(folder)
        options.work.mkdir(parents=True, exist_ok=True)
        data = options.work / "cube.h5"
        if not data.exists():
            import_tosses(options, data)
        for threads in options.threads:
            identify(options, data, threads, options.release)
        if options.diagnose:
            some = every(data, options.diagnose, options.work / "some.h5")
            before = time.monotonic()
            run(options.sinew, "diagnose", "free_body", "--data", some, "--threads", options.threads[-1], "--quiet", "--out",
                options.work / "why.h5", quiet=False)
            print(f"{time.monotonic() - before:.0f} s")


if __name__ == "__main__":
    main()

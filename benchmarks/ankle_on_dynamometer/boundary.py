#!/usr/bin/python3
"""What the boundary level is worth: made-up experiments with straps of several stiffnesses, fitted with straps and sole, and with both rigid.

Prints, per stiffness and kind of fit, the errors of the trials that were never fitted: torque (RMSE and R2) and the ankle's angle.

usage: boundary.py --sinew build/release/sinew [--seeds 1:4] [--stiffness 1500 3000 6000 12000 24000]
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

RIGID = ("strap_stiffness=1e6", "sole_stiffness=1e9")
SMALL = ("duration=4", "speeds=3", "rate=100")


def fit(sinew, data, run, *more):
    done = subprocess.run([sinew, "identify", "ankle_on_dynamometer", "--data", data, "--solver", "lm", "--intervals", "linear", "--threads", "1",
                           "--max-evaluations", "500", "--quiet", *more, "--out", run, "--json", "-"], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr)
    found = json.loads(done.stdout)

    def pooled(channel):
        fits = [one for one in found["fit"] if one["channel"] == channel and one["role"] == "validate"]
        count = np.array([one["n"] for one in fits])
        return np.sqrt(np.sum(count * np.array([one["rmse"] for one in fits]) ** 2) / count.sum()), np.mean([one["r2"] for one in fits])
    return (*pooled("machine_torque"), 180 / np.pi * pooled("ankle_angle")[0])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--seeds", default="1:4")
    parser.add_argument("--stiffness", nargs="+", type=float, default=[1500, 3000, 6000, 12000, 24000])
    words = parser.parse_args()
    first, end = (int(part) for part in words.seeds.split(":"))
    print("stiffness [N/m] | with straps and sole: torque [N m], R2, angle [deg] | rigid: torque, R2, angle")
    with tempfile.TemporaryDirectory(prefix="boundary_") as folder:
        data, run = pathlib.Path(folder) / "data.h5", pathlib.Path(folder) / "run.h5"
        for stiffness in words.stiffness:
            compliant, rigid = [], []
            for seed in range(first, end):
                subprocess.run([words.sinew, "data", "synthesize", "ankle_on_dynamometer", "--seed", str(seed), "--set", *SMALL,
                                f"strap_stiffness={stiffness:g}", "--quiet", "--out", data], check=True, stdout=subprocess.DEVNULL)
                compliant.append(fit(words.sinew, data, run))
                rigid.append(fit(words.sinew, data, run, "--fix", *RIGID))
            row = [np.mean(fits, axis=0) for fits in (compliant, rigid)]
            print(f"{stiffness:g} | " + " | ".join(f"{t:.3f}, {r:.4f}, {a:.2f}" for t, r, a in row), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

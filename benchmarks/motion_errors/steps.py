#!/usr/bin/python3
"""How well a step without its plate is predicted from its motion, against the number of fitted steps.

    benchmarks/motion_errors/steps.py --sinew build/release/sinew --seeds 5001:5004 --shares 0,0.5,0.9 --out steps.json
    benchmarks/motion_errors/steps.py --report steps.json

Synthetic persons (70 kg) whose recorded foot errs by 5 mm and 1.5 degrees; a share of that variance is common to all their steps.
Two held-out steps are the same for every number of fitted ones.
"""
import argparse
import json
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from run import POSITION, ROTATION, SETTINGS, cpu_seconds, draw, sinew  # noqa: E402

WEIGHT = 70 * 9.81  # [N]
CHANNELS = ("force_y", "force_x", "force_z")
ERRORS = "  motion_errors: {}\n"


def study(options, seed, share):
    with tempfile.TemporaryDirectory(prefix="steps_") as folder:
        folder = Path(folder)
        settings, whole = folder / "contact.yaml", folder / "whole.h5"
        settings.write_text(SETTINGS.format(errors=ERRORS))
        most = max(options.fitted)
        truth = draw(seed)
        # A single search from anywhere ends in another minimum in one of ten cases; this is about predictions.
        at_truth = [word for name, value in truth.items() for word in ("--start", f"{name}={value!r}")]
        values = {**truth, "person": 1, "encoders": 1, "slip": 0.1, "train": most, "validate": 2, "motion_error": POSITION,
                  "rotation_error": ROTATION, "shared_error": share}
        sinew(options, "data", "synthesize", "contact", "--seed", seed, "--out", whole,
              *[word for name, value in values.items() for word in ("--set", f"{name}={value!r}")])
        rows = []
        for count in options.fitted:
            data, found = folder / f"{count}.h5", folder / "fit.json"
            shutil.copy(whole, data)
            for k in range(count + 1, most + 1):
                sinew(options, "data", "drop", data, "--trial", f"train_{k}")
            began = cpu_seconds()
            sinew(options, "identify", "contact", "--data", data, "--config", settings, "--threads", 1, "--quiet", "--solver",
                  "continuation", "--intervals", "linear", "--out", folder / "fit.h5", "--json", found, *at_truth)
            fit = json.loads(found.read_text())
            row = {"seed": seed, "share": share, "fitted": count, "cpu": cpu_seconds() - began,
                   "stiffness": next(p["value"] for p in fit["parameters"] if p["name"] == "stiffness") / truth["stiffness"]}
            for other in fit["alternatives"]:
                held_out = [one for one in other["fit"] if one["role"] == "validate"]
                row[other["prediction"]] = {
                    channel: {key: float(np.sqrt(np.mean([(one[key] or 0) ** 2 for one in held_out if one["channel"].endswith(channel)])))
                              for key in ("rmse", "band95_half_width")} for channel in CHANNELS}
            rows.append(row)
        return rows


def report(rows):
    kinds = [key for key in rows[0] if key not in ("seed", "share", "fitted", "cpu", "stiffness")]
    for share in sorted({row["share"] for row in rows}):
        for count in sorted({row["fitted"] for row in rows}):
            chosen = [row for row in rows if (row["share"], row["fitted"]) == (share, count)]
            print(f"share {share:g}, {count} fitted ({len(chosen)} persons, {np.median([row['cpu'] for row in chosen]):.1f} s, "
                  f"stiffness found / true {', '.join(format(row['stiffness'], '.2f') for row in chosen)})")
            for kind in kinds:
                print(f"  {kind}: " + "; ".join(
                    f"{channel} {np.median([row[kind][channel]['rmse'] for row in chosen]):.1f} N "
                    f"({100 * np.median([row[kind][channel]['rmse'] for row in chosen]) / WEIGHT:.1f} %, band "
                    f"{np.median([row[kind][channel]['band95_half_width'] for row in chosen]):.0f} N)" for channel in CHANNELS))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", default="5001:5002", help="first:last")
    parser.add_argument("--shares", type=lambda text: [float(word) for word in text.split(",")], default=[0, 0.5, 0.9])
    parser.add_argument("--fitted", type=lambda text: [int(word) for word in text.split(",")], default=[1, 2, 4, 8])
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path)
    options = parser.parse_args()
    if options.report:
        report(json.loads(options.report.read_text()))
        return
    options.sinew = options.sinew.resolve()
    first, last = map(int, options.seeds.split(":"))
    rows = []
    for seed in range(first, last + 1):
        for share in options.shares:
            rows += study(options, seed, share)
            options.out.write_text(json.dumps(rows, indent=1))
    report(rows)


if __name__ == "__main__":
    main()

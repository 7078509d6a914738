#!/usr/bin/python3
"""Hides effects of all levels in made-up experiments of ankle_on_dynamometer and asks `sinew diagnose` for them.

Persons, machines, the effect and its size are drawn by seed; the data files hold no label. Prints, per kind of case, how often something was
found (detected), of the right level, and in the stated set (cause and alternatives), with 95 % intervals (Wilson).

usage: hidden_effects.py --sinew build/release/sinew [--seeds FIRST:END] [--none N] [--jobs N] [--out results.json]
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

# Spread of the persons and machines about the program's own: standard deviations of the logarithm.
TRUTH = {"attachment_inertia": 0.083, "attachment_gravity": 3.4, "attachment_friction": 0.21, "sole_stiffness": 8.5e6, "sole_friction": 0.15,
         "strap_stiffness": 6600, "strap_exponent": 105, "strap_pretension": 29, "passive_stiffness": 11.5, "passive_exponent": 5.2,
         "passive_linear_stiffness": 3.8, "passive_damping": 0.42, "filter_time": 0.026, "delay": 0.042, "strength.triceps": 1.22,
         "strength.dorsiflexors": 0.84}
SPREAD = 0.15
# Effect: level, and for each parameter the range that its size is drawn from.
EFFECTS = {"dry_friction": ("robot", {"dry_friction": (0.1, 0.6)}),
           "directional_friction": ("robot", {"directional_friction": (0.15, 0.8)}),
           "friction_with_load": ("robot", {"friction_with_load": (0.02, 0.08)}),
           "axis_offset": ("boundary", {"axis_offset_x": (-0.012, 0.012), "axis_offset_y": (-0.012, 0.012)}),
           "strap_loosening": ("boundary", {"strap_loosening": (0.0003, 0.001)}),
           "sole_exponent": ("boundary", {"sole_exponent": (0.1, 0.5)}),
           "boundary_relaxation": ("boundary", {"boundary_relaxation_stiffness": (10, 60), "boundary_relaxation_time": (0.2, 1.0)}),
           "passive_hysteresis": ("human", {"passive_hysteresis": (0.15, 1.0)}),
           "passive_relaxation": ("human", {"passive_relaxation_stiffness": (1.5, 8), "passive_relaxation_time": (0.2, 1.0)}),
           "fatigue": ("human", {"fatigue": (0.01, 0.04)}),
           "unseen_drive": ("human", {"unseen_drive": (0.01, 0.04)}),
           "emg_crosstalk": ("human", {"emg_crosstalk": (0.04, 0.15)}),
           "antagonist": ("human", {"antagonist": (1.5, 8)}),
           "force_enhancement": ("human", {"force_enhancement": (0.06, 0.3)}),
           "force_depression": ("human", {"force_depression": (0.06, 0.3)})}
SMALL = {"duration": 3, "speeds": 2, "rate": 100}
SECONDS = 1200  # of one diagnosis


def wilson(hits, count, z=1.959964):
    if count == 0:
        return "none"
    share, square = hits / count, z * z / count
    middle = (share + square / 2) / (1 + square)
    half = z * np.sqrt(share * (1 - share) / count + square / (4 * count)) / (1 + square)
    return f"{hits} of {count} ({100 * max(middle - half, 0):.1f} to {100 * min(middle + half, 1):.1f} %)"


def case(sinew, seed, hide):
    random = np.random.default_rng(seed)
    words = [f"{name}={value * np.exp(SPREAD * random.standard_normal()):.6g}" for name, value in TRUTH.items()]
    words += [f"{name}={value}" for name, value in SMALL.items()]
    effect = list(EFFECTS)[seed % len(EFFECTS)] if hide else None
    hidden = []
    if effect:
        sizes = {name: random.uniform(*bounds) for name, bounds in EFFECTS[effect][1].items()}
        hidden = ["--effect", effect + ":" + ",".join(f"{name}={value:.6g}" for name, value in sizes.items())]
    with tempfile.TemporaryDirectory(prefix="hidden_ankle_") as folder:
        data = pathlib.Path(folder) / "data.h5"
        subprocess.run([sinew, "data", "synthesize", "ankle_on_dynamometer", "--seed", str(seed), "--set", *words, *hidden, "--quiet", "--out",
                        data], check=True, stdout=subprocess.DEVNULL)
        began = time.time()
        cpu = os.times().children_user
        try:
            done = subprocess.run([sinew, "diagnose", "ankle_on_dynamometer", "--data", data, "--solver", "lm", "--threads", "1", "--quiet",
                                   "--out", pathlib.Path(folder) / "why.h5", "--json", "-"], capture_output=True, text=True,
                                  timeout=SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return {"seed": seed, "effect": effect, "failure": f"longer than {SECONDS} s"}
        if done.returncode != 0:
            return {"seed": seed, "effect": effect, "failure": done.stderr.strip()[-200:]}
        found = json.loads(done.stdout)
    named = [(cause["effect"], cause["level"]) for cause in found["causes"]]
    other = [entry["effect"] for entry in found["alternatives"]]
    # Seconds of the processor mean something with --jobs 1 only.
    return {"seed": seed, "effect": effect, "verdict": found["verdict"], "named": named, "alternatives": other,
            "levels": [[one["level"], one["standing"], one["effects"], one["behind"]] for one in found["levels"]],
            "largest": max((cause["size"] for cause in found["causes"]), default=0), "seconds": time.time() - began,
            "user_seconds": os.times().children_user - cpu}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--seeds", default="1:16")
    parser.add_argument("--none", type=int, default=0, help="as many seeds again with nothing hidden")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out")
    words = parser.parse_args()
    sinew = str(pathlib.Path(words.sinew).resolve())
    first, end = (int(part) for part in words.seeds.split(":"))
    wanted = [(seed, True) for seed in range(first, end)] + [(10000 + first + k, False) for k in range(words.none)]
    results = []
    with ThreadPoolExecutor(words.jobs) as pool:
        for result in pool.map(lambda pair: case(sinew, *pair), wanted):
            results.append(result)
            print(json.dumps(result), flush=True)
    if words.out:
        pathlib.Path(words.out).write_text(json.dumps(results, indent=1))
    judged = [r for r in results if "failure" not in r]
    hidden = [r for r in judged if r["effect"]]
    empty = [r for r in judged if not r["effect"]]
    detected = [r for r in hidden if r["verdict"] != "adequate"]
    right = [r for r in hidden if r["effect"] in [name.split("@")[0] for name, _ in r["named"]] + [name.split("@")[0] for name in r["alternatives"]]]
    named = [r for r in detected if r["named"]]

    def has(result, *standings):
        return any(level == EFFECTS[result["effect"]][0] and standing in standings for level, standing, *_ in result["levels"])
    blamed = [r for r in detected if has(r, "blamed") and sum(standing == "blamed" for _, standing, *_ in r["levels"]) == 1]
    stated = [r for r in detected if has(r, "blamed", "possible")]
    print(f"failed: {len(results) - len(judged)}")
    print(f"nothing hidden, alarm: {wilson(sum(r['verdict'] != 'adequate' for r in empty), len(empty))}")
    print(f"hidden, detected: {wilson(len(detected), len(hidden))}")
    print(f"of those, a cause named: {wilson(len(named), len(detected))}")
    print(f"of those detected, its level alone to blame: {wilson(len(blamed), len(detected))}")
    print(f"of those detected, its level to blame or possible: {wilson(len(stated), len(detected))}")
    print(f"median user seconds: {np.median([r['user_seconds'] for r in judged]) if judged else np.nan:.1f}")
    print(f"of all, effect in the stated set: {wilson(len(right), len(hidden))}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

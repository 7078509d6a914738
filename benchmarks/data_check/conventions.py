#!/usr/bin/python3
"""Whole recordings of a joint with another sign, unit or zero than they are said to have: does `sinew data check F.h5 drive` say so, and
nothing of the recordings as they are? The joints are those of benchmarks/large_misfits.

usage: conventions.py --sinew PATH --seeds 701:740
"""
import argparse
import json
import math
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import h5py

sys.path.append(str(Path(__file__).resolve().parents[1] / "large_misfits"))
import cases  # noqa: E402

LONGEST = 120  # [s] of one check
# A part of the note that says it.
SAID = {"sign": "moves against", "degrees": "degrees, which are read as radians", "zero": "this one hangs at", "milliseconds": "a sample every"}


def change(grid, channel, function):
    values = grid["channels"][channel]
    values[...] = function(values[...])


def input_of(grid):
    return next(name for name in ("torque", "force", "voltage", "duty", "reference") if name in grid["channels"])


FAULTS = {
    "nothing": lambda grid: None,
    "sign": lambda grid: change(grid, input_of(grid), lambda u: -u),
    "degrees": lambda grid: change(grid, "position", lambda q: q * 180 / math.pi),
    "zero": lambda grid: change(grid, "position", lambda q: q + 1.2),
    "milliseconds": lambda grid: grid["time"].__setitem__(..., grid["time"][...] * 1000),
}


def notes(sinew, data):
    try:
        done = subprocess.run([sinew, "data", "check", data, "drive", "--json", "-"], capture_output=True, text=True, timeout=LONGEST, check=False)
    except subprocess.TimeoutExpired:
        return [f"no answer in {LONGEST} s"]
    if not done.stdout.startswith("{"):
        return [done.stderr]
    return json.loads(done.stdout).get("notes", [])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--seeds", required=True)
    options = parser.parse_args()
    first, last = map(int, options.seeds.split(":"))
    said = {fault: Counter() for fault in FAULTS}
    studies = 0
    with tempfile.TemporaryDirectory() as folder:
        data, spoilt = Path(folder) / "right.h5", Path(folder) / "spoilt.h5"
        for seed in range(first, last + 1):
            case = cases.draw_case(seed)
            words = [options.sinew, "data", "synthesize", "drive", *map(str, case.words()), "--out", data, "--quiet"]
            if subprocess.run(words, capture_output=True, check=False).returncode != 0:
                continue  # a joint that cannot be simulated
            studies += 1
            for fault, spoil in FAULTS.items():
                shutil.copy(data, spoilt)
                with h5py.File(spoilt, "r+") as file:
                    for trial in file["trials"].values():
                        spoil(trial["joint"])
                found = notes(options.sinew, spoilt)
                kinds = {kind for kind, part in SAID.items() for note in found if part in note}
                said[fault].update(kinds or ({"no answer"} if any("no answer" in note for note in found) else {"no remark"}))
    print(f"{studies} recordings")
    for fault, counts in said.items():
        print(f"  {fault}: " + ", ".join(f"{kind} {count}" for kind, count in counts.most_common()))


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Inverse kinematics of a walk in which markers are lost and swapped for a while, beside that of the whole recording.

    benchmarks/kinematics/spoilt.py --sinew build/release/sinew --data DATA/gait_walk3d --seeds 0:12
"""
import argparse
import random
import shutil
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

SPELLS = 4  # of 10 to 40 frames, in turn a limb that is lost and two markers that are swapped
LIMBS = (("Elbow", "Forearm", "Wrist"), ("Knee", "Ankle", "Heel", "MT5", "Toe"))
TOLERANCE_DEG = 1.0


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def angles(path):
    channels = h5py.File(path)["trials/walk/coordinates/channels"]
    return {name: np.asarray(channel) for name, channel in channels.items() if name not in ("pelvis_tx", "pelvis_ty", "pelvis_tz")}


def spoil(path, seed):
    """@return per frame, whether a marker was lost or swapped."""
    draw = random.Random(seed)
    with h5py.File(path, "r+") as file:
        channels = file["trials/walk/markers/channels"]
        tracked = sorted(name[:-2] for name in channels if name.endswith("_x") and name[2:-2] in
                         {part for limb in LIMBS for part in limb} | {"Shoulder", "Clavicle", "ASIS", "PSIS"})
        frames = len(channels[tracked[0] + "_x"])
        spoilt = np.zeros(frames, bool)
        for spell in range(SPELLS):
            start = draw.randrange(10, frames - 48)
            span = slice(start, start + draw.randrange(10, 40))
            spoilt[span] = True
            pair = draw.sample(tracked, 2)
            lost = [f"{draw.choice('RL')}.{part}" for part in draw.choice(LIMBS)] if spell % 2 == 0 else []
            for axis in "xyz":
                for name in lost:
                    values = channels[f"{name}_{axis}"][()]
                    values[span] = np.nan
                    channels[f"{name}_{axis}"][...] = values
                if not lost:
                    both = [channels[f"{name}_{axis}"] for name in pair]
                    first, second = (values[()] for values in both)
                    first[span], second[span] = second[span].copy(), first[span].copy()
                    both[0][...], both[1][...] = first, second
    return spoilt


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--seeds", default="0:12")
    options = parser.parse_args()
    first, last = map(int, options.seeds.split(":"))
    weights = options.data / "ik_tasks_walk.xml"
    with tempfile.TemporaryDirectory() as folder:
        whole, spoilt = Path(folder, "whole.h5"), Path(folder, "spoilt.h5")
        run(options.sinew, "data", "import", options.data / "markers_walk.trc", options.data / "subject_walk_scaled.osim",
            "--trial", "walk", "--out", whole)
        shutil.copy(whole, spoilt)
        run(options.sinew, "data", "kinematics", whole, "--weights", weights, "--quiet")
        reference = angles(whole)
        plain = Path(folder, "plain.h5")
        shutil.move(spoilt, plain)
        compared = wrong = recordings = 0
        for seed in range(first, last):
            shutil.copy(plain, spoilt)
            gone = spoil(spoilt, seed)
            run(options.sinew, "data", "kinematics", spoilt, "--weights", weights, "--quiet")
            found = angles(spoilt)
            # Whole turns aside: through spoilt frames an angle may go on round the other way.
            off = np.max([np.abs(np.degrees(np.remainder(found[name] - reference[name] + np.pi, 2 * np.pi) - np.pi))
                          for name in found], axis=0)
            here = (off > TOLERANCE_DEG) & ~gone
            compared += int((~gone).sum())
            wrong += int(here.sum())
            recordings += bool(here.any())
            if here.any():
                print(f"  seed {seed}: {here.sum()} frames from {np.flatnonzero(here)[0]}, {off[here].max():.0f} deg at most", flush=True)
        print(f"{wrong} of {compared} whole frames more than {TOLERANCE_DEG:g} deg from the answer of the whole recording, "
              f"in {recordings} of {last - first} recordings")


if __name__ == "__main__":
    main()

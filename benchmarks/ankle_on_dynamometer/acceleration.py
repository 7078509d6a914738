#!/usr/bin/python3
"""Bias and coverage of the attachment's inertia, whose regressor is an acceleration that is found from a noisy angle.

Made-up machines without noise (data synthesize, one per seed), of which the trials of the attachment alone stay; every draw adds the noise of angle and
torque anew and fits the attachment's four parameters.

usage: acceleration.py --sinew PATH [--seeds 1:6] [--draws 40]
"""
import argparse
import json
import shutil
import tempfile
from pathlib import Path

import h5py
import numpy as np

from hidden_effects import NOISE, SMALL, TRUTH, run
from wilson import wilson

ANGLE_NOISE = 2e-4  # [rad] the laboratory's default
FITTED = ["attachment_inertia", "attachment_gravity", "attachment_gravity_angle", "attachment_friction"]


def ideal(sinew, seed, path):
    words = [f"--set={name}={value!r}" for name, value in {**SMALL, "torque_noise": 0, "angle_noise": 0, "ankle_noise": 0}.items()]
    status, _, message = run(sinew, "data", "synthesize", "ankle_on_dynamometer", "--seed", seed, *words, "--out", path)
    if status != 0:
        raise SystemExit(message)


def with_noise(clean, own, path):
    shutil.copy(clean, path)
    with h5py.File(path, "r+") as file:
        for name in list(file["trials"]):
            if not name.startswith("attachment"):
                del file["trials"][name]
                continue
            for channel, noise in (("machine_angle", ANGLE_NOISE), ("machine_torque", NOISE["machine_torque"])):
                values = file[f"trials/{name}/machine/channels/{channel}"]
                values[...] += noise * own.standard_normal(values.shape)
            values.attrs["sigma"] = NOISE["machine_torque"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--seeds", default="1:6")
    parser.add_argument("--draws", type=int, default=40)
    options = parser.parse_args()
    first, last = map(int, options.seeds.split(":"))
    hits, errors = {name: [] for name in FITTED}, []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for seed in range(first, last + 1):
            ideal(options.sinew, seed, folder / "clean.h5")
            for draw in range(options.draws):
                with_noise(folder / "clean.h5", np.random.default_rng([77, seed, draw]), folder / "case.h5")
                (folder / "run.h5").unlink(missing_ok=True)
                status, _, message = run(options.sinew, "identify", "ankle_on_dynamometer", "--data", folder / "case.h5", "--solver", "lm", "--threads", 1,
                                         "--intervals", "linear", "--free", ",".join(FITTED), "--quiet", "--out", folder / "run.h5", "--json", folder / "run.json")
                if status != 0:
                    raise SystemExit(message)
                for found in json.loads((folder / "run.json").read_text())["parameters"]:
                    if found["name"] in hits:
                        hits[found["name"]].append(found["ci95"][0] <= TRUTH[found["name"]] <= found["ci95"][1])
                    if found["name"] == FITTED[0]:
                        errors.append(100 * (found["value"] / TRUTH[FITTED[0]] - 1))
    print(f"{FITTED[0]}: {np.mean(errors):+.2f} % +- {np.std(errors) / np.sqrt(len(errors)):.2f} % off in the mean")
    for name, held in hits.items():
        low, high = wilson(sum(held), len(held))
        print(f"{name}: in {sum(held)} of {len(held)} 95 % intervals ({100 * low:.1f} to {100 * high:.1f} %)")


if __name__ == "__main__":
    main()

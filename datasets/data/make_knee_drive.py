#!/usr/bin/python3
"""Writes knee_drive.h5, which ./demo diagnoses, and knee_drive.truth.json, which no part of sinew reads.

The drive of a knee joint on the bench: a shank of about 2 kg hangs from it, the motor's torque is recorded, an encoder gives
the angle. `sinew data synthesize drive` makes the trials with its laboratory, which shares no code with the model that is
fitted; one effect that the base model does not have is hidden in them. The data file holds no label of it.

usage: make_knee_drive.py SINEW [OUT_DIR]     (default: the folder of this file; needs h5py)
"""
import json
import pathlib
import subprocess
import sys

import h5py

SEED = 7
JOINT = {"inertia": 0.14, "viscous_friction": 0.35, "gravity_torque": 4.0}  # [kg m2, N m s/rad, N m]
EFFECT, SIZE = "asymmetric_friction", {"forward_friction": 0.16, "backward_friction": 0.08}  # [N m]
# Encoder noise of 2 mrad, half of its variance white, half correlated over some samples; the data do not state its level.
BENCH = {"duration": 8, "rate": 100, "position_noise": 0.002, "noise_rho": 0.8, "noise_slow": 0.5, "known_noise": 0}
TITLE = "knee joint on the bench"


def main():
    sinew = sys.argv[1]
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parent
    path = folder / "knee_drive.h5"
    settings = [word for name, value in {**JOINT, **BENCH}.items() for word in ("--set", f"{name}={value}")]
    hidden = f"{EFFECT}:{','.join(f'{name}={value}' for name, value in SIZE.items())}"
    subprocess.run([sinew, "data", "synthesize", "drive", *settings, "--seed", str(SEED), "--effect", hidden, "--out",
                    str(path)], check=True, stdout=subprocess.DEVNULL)
    with h5py.File(path, "r+") as file:
        for name, text in (("title", TITLE), ("subject", "drive of a knee joint, with a hanging shank")):
            file.attrs.modify(name, text)
    truth = {"data": path.name, "base": JOINT, "effects": {EFFECT: SIZE}, "position_noise_rad": BENCH["position_noise"]}
    (folder / "knee_drive.truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Writes ankle_study.h5, an example for `sinew diagnose nms`, and ankle_study.truth.json, which no part of sinew reads.

A foot moves up and down on a dynamometer at six speeds, driven by seven muscles: raw EMG of one electrode per muscle at 2048 Hz,
excitations (the mean of the envelopes of 1024 electrodes), lengths, moment arms, angle and moment. `sinew data synthesize nms`
makes the trials at a thousand frames a second from the true excitations; one effect that the base model does not have is hidden
in them. The data file holds no label of it.

usage: make_ankle_study.py SINEW [OUT_DIR]     (default: the folder of this file; needs h5py)
"""
import json
import pathlib
import subprocess
import sys

import h5py

SEED = 7
PERSON = {"triceps.strength": 0.84, "peronei.strength": 1.13, "dorsiflexors.strength": 1.06, "plantarflexors.shape": -1.35,
          "dorsiflexors.shape": -0.9, "triceps.tendon_slack_length": 1.012, "dorsiflexors.tendon_slack_length": 0.985}
EFFECT, SIZE = "passive_stiffness.ankle_angle_r", {"passive_stiffness.ankle_angle_r": 9.0}  # [N m/rad]
LABORATORY = {"cycles": 2, "raw": 1, "moment_noise": 1.0, "electrodes": 1024}


def main():
    sinew = sys.argv[1]
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parent
    path = folder / "ankle_study.h5"
    settings = [word for name, value in {**PERSON, **LABORATORY}.items() for word in ("--set", f"{name}={value}")]
    hidden = f"{EFFECT}:{','.join(f'{name}={value}' for name, value in SIZE.items())}"
    path.unlink(missing_ok=True)
    subprocess.run([sinew, "data", "synthesize", "nms", *settings, "--seed", str(SEED), "--effect", hidden, "--out", str(path)],
                   check=True, stdout=subprocess.DEVNULL)
    with h5py.File(path, "r+") as file:
        file.attrs.modify("title", "ankle on a dynamometer")
        file.attrs.modify("subject", "a person who is made up")
    truth = {"data": path.name, "base": PERSON, "effects": {EFFECT: SIZE}, "moment_noise_Nm": LABORATORY["moment_noise"]}
    (folder / "ankle_study.truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()

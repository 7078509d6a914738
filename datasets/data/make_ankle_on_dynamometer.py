#!/usr/bin/python3
"""Writes ankle_on_dynamometer.h5, an example for `sinew identify ankle_on_dynamometer`, and ankle_on_dynamometer.truth.json, which no
part of sinew reads.

A foot is strapped to the plate of a dynamometer: the attachment alone, passive rotations, an isometric trial and contractions at six
speeds that are fitted, a passive and two active speeds that are held out. `sinew data synthesize ankle_on_dynamometer` simulates the
trials by the laboratory's own integrator and motor; nothing is hidden in them.

usage: make_ankle_on_dynamometer.py SINEW [OUT_DIR]     (default: the folder of this file; needs h5py)
"""
import json
import pathlib
import subprocess
import sys

import h5py

SEED = 11
PERSON = {"attachment_inertia": 0.071, "attachment_gravity": 2.8, "attachment_gravity_angle": 0.1, "attachment_friction": 0.26,
          "sole_stiffness": 7.2e6, "sole_friction": 0.17, "strap_stiffness": 5200, "strap_exponent": 95, "strap_pretension": 34,
          "passive_stiffness": 9.6, "passive_exponent": 4.7, "passive_linear_stiffness": 4.4, "passive_damping": 0.36, "shape": -0.9,
          "filter_time": 0.023, "delay": 0.038, "strength.triceps": 1.14, "strength.dorsiflexors": 0.91,
          "tendon_slack_length.triceps": 1.005, "tendon_slack_length.dorsiflexors": 0.994}
LABORATORY = {"duration": 5, "rate": 100}


def main():
    sinew = sys.argv[1]
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parent
    path = folder / "ankle_on_dynamometer.h5"
    settings = [word for name, value in {**PERSON, **LABORATORY}.items() for word in ("--set", f"{name}={value}")]
    path.unlink(missing_ok=True)
    subprocess.run([sinew, "data", "synthesize", "ankle_on_dynamometer", *settings, "--seed", str(SEED), "--out", str(path)],
                   check=True, stdout=subprocess.DEVNULL)
    with h5py.File(path, "r+") as file:
        file.attrs.modify("title", "ankle on a dynamometer")
        file.attrs.modify("subject", "a person who is made up")
    truth = {"data": path.name, "base": PERSON, "effects": {}}
    (folder / "ankle_on_dynamometer.truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Interaction torque, force under the sole and force of the straps that a fit finds, against those of the laboratory, which no file that
is fitted holds: made-up persons of run.py, fitted with straps and sole, and with both rigid.

usage: interaction.py --sinew build/release/sinew [--seeds 1:8]
"""
import argparse
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

import run

TRUE = {"interaction torque [N m]": ("true_interaction", "interaction_torque"), "force under the sole [N]": ("true_sole_force", "sole_force_normal"),
        "force of the straps [N]": ("true_strap_force", "strap_force")}
RIGID = {"straps and sole free": [], "rigid": ["--fix", "strap_stiffness=1e6", "sole_stiffness=1e9"]}


def errors(data, fitted):
    """By quantity and role: RMSE, and that in % of the true range."""
    found = {}
    with h5py.File(data) as truth, h5py.File(fitted) as fit:
        for name, trial in truth["trials"].items():
            for text, (true, model) in TRUE.items():
                if true not in trial["machine/channels"]:
                    continue
                # The model's stops are the samples, and may begin and end within them.
                details = fit[f"details/ankle_on_dynamometer/{name}"]
                expected = np.interp(details["time"][:], trial["machine/time"][:], trial[f"machine/channels/{true}"][:])
                found.setdefault((text, trial.attrs["role"]), []).append((expected, details[model][:]))
    result = {}
    for key, pairs in found.items():
        expected, got = (np.concatenate(part) for part in zip(*pairs))
        error = np.sqrt(np.mean((got - expected) ** 2))
        result[key] = error, 100 * error / np.ptp(expected)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", required=True, type=Path)
    parser.add_argument("--seeds", default="1:8", help="first:last")
    options = parser.parse_args()
    first, last = map(int, options.seeds.split(":"))
    table = {}
    for seed in range(first, last + 1):
        truth = run.draw(seed)
        with tempfile.TemporaryDirectory(prefix="interaction_") as folder:
            folder = Path(folder)
            data, told = folder / "data.h5", folder / "told.h5"
            words = [w for name, value in {**run.SMALL, **truth}.items() for w in ("--set", f"{name}={value!r}")]
            run.sinew(options.sinew, "data", "synthesize", "ankle_on_dynamometer", "--seed", seed, "--out", data, "--quiet", *words)
            run.sinew(options.sinew, "data", "synthesize", "ankle_on_dynamometer", "--seed", seed, "--out", told, "--quiet", *words, "--set",
                      "hidden_truth=1")
            for title, fixed in RIGID.items():
                fit = run.identify(options.sinew, data, folder, title.split()[0], *fixed)
                for key, value in errors(told, folder / f"{title.split()[0]}.h5").items():
                    table.setdefault((title, *key), []).append(value)
                table.setdefault((title, "torque of held-out trials [N m]", "validate"), []).append((run.torque(fit), np.nan))
    for (title, text, role), rows in table.items():
        absolute, relative = np.array(rows).T
        print(f"{title}, {text}, {role}: median {np.median(absolute):.3g}, worst {np.max(absolute):.3g}"
              + ("" if np.isnan(relative).any() else f"; of the range {np.median(relative):.2g} %, {np.max(relative):.2g} %") + f" ({len(rows)})")


if __name__ == "__main__":
    sys.exit(main())

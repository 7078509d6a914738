#!/usr/bin/python3
"""How often the 95 % intervals of the contact parameters contain the truth: many synthetic experiments, through the program.

Each seed: `data synthesize contact` (robot that slips, finer mesh and motion than the fitted model), `data kinematics` if
there are no encoders, `identify` on the full force vector. The truth is drawn here and never in the data file.

usage: contact_coverage.py SINEW [--seeds 100] [--marker-noise 0] [--encoders]
"""
import argparse
import json
import random
import subprocess
import tempfile
from pathlib import Path

SETTINGS = """
contact:
  objective: likelihood
  fit: [force_x, force_y, force_z]
  regions:
    - {name: right_sole, body: calcn_r, plate: right, position: [0.02, -0.04519, 0.0],
       mesh: {box: {size: [0.16, 0.02, 0.09], strips: [24, 14]}}}
    - {name: left_sole, body: calcn_l, plate: left, position: [0.02, -0.04519, 0.0],
       mesh: {box: {size: [0.16, 0.02, 0.09], strips: [24, 14]}}}
  parameters:
    stiffness: {lower: 1.0e4, upper: 1.0e7, start: 1.0e5}
    dissipation: {lower: 0, upper: 600, start: 10}
"""


def draw_truth(seed):
    draw = random.Random(seed)
    truth = {"stiffness": draw.uniform(7e5, 1.2e6), "dissipation": draw.uniform(20, 50)}
    truth["static_friction"] = draw.uniform(0.7, 1.2)
    truth["dynamic_friction"] = truth["static_friction"] * draw.uniform(0.5, 0.9)
    truth["viscous_friction"] = draw.uniform(0.3, 1.0)
    return truth


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sinew")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--marker-noise", type=float, default=0.0, help="of every marker coordinate [m]")
    parser.add_argument("--encoders", action="store_true", help="the motion is known; no markers, no kinematics")
    parser.add_argument("--slip", type=float, default=0.2, help="speed of sliding [m/s]")
    options = parser.parse_args()

    inside, verdicts, width = {}, {}, {}
    with tempfile.TemporaryDirectory() as folder:
        data, settings = Path(folder) / "data.h5", Path(folder) / "contact.yaml"
        settings.write_text(SETTINGS)
        for seed in range(1, options.seeds + 1):
            truth = draw_truth(seed)
            words = [f"{name}={value!r}" for name, value in truth.items()]
            words += [f"slip={options.slip}", f"marker_noise={options.marker_noise}", f"encoders={int(options.encoders)}"]
            run(options.sinew, "data", "synthesize", "contact", "--out", data, "--seed", seed,
                *[w for word in words for w in ("--set", word)])
            if not options.encoders:
                run(options.sinew, "data", "kinematics", data, "--quiet")
            result = json.loads(run(options.sinew, "identify", "contact", "--data", data, "--config", settings,
                                    "--out", Path(folder) / "run.h5", "--json", "-", "--quiet"))
            for parameter in result["parameters"]:
                name, interval = parameter["name"], parameter["ci95"]
                hit = interval is not None and interval[0] <= truth[name] <= interval[1]
                inside.setdefault(name, []).append(hit)
                verdicts.setdefault(name, []).append(parameter["verdict"])
                if interval is not None:
                    width.setdefault(name, []).append((interval[1] - interval[0]) / 2 / truth[name])
    print(f"{options.seeds} seeds, slip {options.slip} m/s, marker noise {options.marker_noise} m"
          f"{', encoders' if options.encoders else ''}")
    for name, hits in inside.items():
        identifiable = verdicts[name].count("identifiable")
        half = 100 * sum(width.get(name, [0])) / max(1, len(width.get(name, [])))
        print(f"  {name:18s} truth inside {sum(hits):3d} of {len(hits)}, identifiable {identifiable}, mean half-width {half:.2g} %")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Undermodelled machines with one short record and a smooth residual: `adequate` must not be said where what the base model leaves exceeds
the noise. What is wrong is in no library in two thirds of the cases.

usage: structure.py --sinew PATH --two-tanks PATH [--seeds 1:30] --out RESULTS.json
"""
import argparse
import dataclasses
import json
import math
import random
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import axes  # noqa: E402
import run  # noqa: E402
import tanks  # noqa: E402


def draw_tanks(seed):
    """One record of 256 samples; what is wrong has a tenth to three times the size that tanks.py draws."""
    draw = random.Random(f"structure {seed}")
    made = dataclasses.replace(tanks.draw_tanks(seed), records=1, samples=256, outsider={}, interval=draw.choice((2.0, 4.0, 8.0)))
    size = 10 ** draw.uniform(-1, 0.5)
    outsiders = ({"pump_lag": {"pump_time": 20 * size}}, {"leaking_base": {"leak": 0.03 * size}}, {"worn_pump": {"worn": min(0.6, 0.1 * size)}})
    if draw.random() < 2 / 3:
        return dataclasses.replace(made, effects={}, outsider=draw.choice(outsiders))
    name, values = next(iter(made.effects.items()))
    return dataclasses.replace(made, effects={name: {key: value * size if key in ("upper_rate", "lower_rate", "pump_curve", "upper_exponent",
                                                                                  "lower_exponent") else value
                                                     for key, value in values.items()}})


def draw_axis(seed):
    """One record of 8 s at 100 Hz: a slow force besides, or dry friction alone."""
    draw = random.Random(f"structure {seed}")
    made = axes.draw_axis(seed)
    viscous = (made.forward + made.backward) / 2
    made = dataclasses.replace(made, trials=1, duration=8.0, rate=100.0, held_stated=True, coulomb=0.0, offset=0.0, forward=viscous,
                               backward=viscous, cogging=0.0, noise=10 ** draw.uniform(-5.5, -3.5), resolution=draw.choice((0.0, 1e-5)))
    size = 10 ** draw.uniform(-2.5, -0.5) * made.mass
    if draw.random() < 2 / 3:
        return dataclasses.replace(made, disturbance=size, slowness=draw.uniform(1.5, 6))
    return dataclasses.replace(made, coulomb=size)


def study(options, seed):
    kind = "axis" if seed % 3 == 0 else "tanks"
    axes_draw, tanks_draw = axes.draw_axis, tanks.draw_tanks
    machine = draw_axis(seed) if kind == "axis" else draw_tanks(seed)
    with tempfile.TemporaryDirectory(prefix="structure_") as folder:
        axes.draw_axis = tanks.draw_tanks = lambda _: machine
        try:
            case = run.Case(options, kind, seed, Path(folder))
        finally:
            axes.draw_axis, tanks.draw_tanks = axes_draw, tanks_draw
        d = case.run("diagnose")
    noise = math.hypot(machine.noise, machine.resolution / math.sqrt(12))
    left = case.error(d["base"]["fit"], "train") if "fit" in d["base"] else math.nan
    wrong = "disturbance" if kind == "axis" and machine.disturbance else "coulomb" if kind == "axis" else \
        ", ".join([*machine.effects, *machine.outsider])
    return {"kind": kind, "seed": seed, "wrong": wrong, "noise": noise, "structure": math.sqrt(max(0, left ** 2 / noise ** 2 - 1)),
            "verdict": d["verdict"], "inconclusive": d["inconclusive_kind"], "causes": [c["effect"] for c in d["causes"]], "p": d["family_p_value"],
            "machine": dataclasses.asdict(machine)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--two-tanks", type=Path, required=True)
    parser.add_argument("--seeds", type=run.seeds, default=run.seeds("1:30"))
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    results = []
    for seed in options.seeds:
        try:
            r = study(options, seed)
        except RuntimeError as error:
            print(f"{seed}: {str(error)[-300:]}", flush=True)
            continue
        results.append(r)
        options.out.write_text(json.dumps(results, indent=1))
        print(f"{r['kind']} {seed}: {r['wrong']}, structure {r['structure']:.2f} x the noise: {r['verdict']} (p = {r['p']:.2g}) "
              f"{', '.join(r['causes'])}", flush=True)
    above = [r for r in results if r["structure"] > 1]
    false = [r["seed"] for r in above if r["verdict"] == "adequate"]
    print(f"{len(results)} cases, structure above the noise in {len(above)}: adequate in {len(false)} {false or ''}")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Hides effects in the stances of a small robot (problem contact), runs the diagnosis on the files, and counts.

Each case: the program synthesizes five stances (three fitted, two held out) of a humanoid robot with a stiffness, dissipation and
frictions drawn by seed, with one effect whose size is known here and nowhere in the file; `sinew data kinematics` and `sinew
diagnose contact` see the data only. A size is in units of what a test of that effect alone, at 5 %, just detects with 95 %: from the
diagnosis of the same stances, with other noise, without a fault. Counts are those of ../hidden_effects/README.md.

usage: run.py --sinew PATH [--kind none,single] [--cases 100] [--sizes 2,4] [--effect NAME]... [--jobs 2] [--first-seed 1]
              [--out results.json]                        run.py --merge results.json...
"""
import math
import random
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "hidden_effects"))
from counting import compare, run  # noqa: E402
from studies import diagnose, run_studies, study_parser, synthesize  # noqa: E402

UNIT = 3.605
POWER = 1.645  # of smallest_detectable, which is for the family's threshold
PHASES = ("early", "middle", "late")
# Effect: its parameters at their null, as `data synthesize` calls them, and whether it has two signs.
EFFECTS = {
    **{f"foot_{mode}": ({f"foot_{mode}_{phase}": 0.0 for phase in PHASES}, True) for mode in ("bend", "pitch", "height")},
    "height_offset": ({"height_offset": 0.0}, True),
    "right.height_offset": ({"value": 0.0}, True),
    "tilted_floor": ({"floor_slope_x": 0.0, "floor_slope_z": 0.0}, True),
    "floor_compliance": ({"floor_compliance": 0.0}, False),
    "stiffness_exponent": ({"stiffness_exponent": 0.0}, True),
    "unmodelled_mass": ({"unmodelled_mass": 0.0}, True),
    "right_force_y.offset": ({"value": 0.0}, True),
    "right_force_y.gain": ({"value": 1.0}, True),
    "right_force_y.time_offset": ({"value": 0.0}, True),
}
FITTED = {"stiffness": (4e5, 2e6), "dissipation": (10.0, 100.0)}


def base_truth(seed):
    own = random.Random(7000001 * seed)
    return {name: math.exp(own.uniform(math.log(low), math.log(high))) for name, (low, high) in FITTED.items()}


def record(options, seed, noise_seed, effects, out):
    words = [f"--set={name}={value!r}" for name, value in base_truth(seed).items()]
    words += [word for effect, values in effects.items()
              for word in ("--effect", effect + ":" + ",".join(f"{name}={value!r}" for name, value in values.items()))]
    synthesize(options, "contact", noise_seed, words, out)
    status, _, message = run(options.sinew, "data", "kinematics", out, "--threads", 1, "--quiet")
    if status != 0:
        raise ValueError(message)


def units_of(options, seed, folder):
    """{effect: (the parameter that the diagnosis judges, its change of unit size)}."""
    record(options, seed, 900000 + seed, {}, folder / "plain.h5")
    found, _ = diagnose(options, "contact", folder / "plain.h5", folder)
    told = {score["effect"]: score["smallest_detectable"] for score in found["scores"]
            if score["effect"] in EFFECTS and score.get("smallest_detectable")}
    return {name: (least["parameter"], least["value"] * UNIT / (found["threshold"] + POWER)) for name, least in told.items()}


def hide(name, parameter, change):
    """What `data synthesize` is told, and the same under the names of the problem's parameters."""
    values = dict(EFFECTS[name][0])
    values[parameter if parameter in values else "value"] += change
    return {name: values}, {parameter if key == "value" else key: value for key, value in values.items()}


def study(options, kind, size, seed):
    case = {"kind": kind, "size": size, "noise": "plate", "seed": seed}
    truth = {"base": base_truth(seed), "effects": []}
    case["truth"] = truth
    own = random.Random(1000003 * seed + int(100 * size) + {"none": 0, "single": 1}[kind])
    effects = {}
    with tempfile.TemporaryDirectory(prefix="robot_stances_") as folder:
        folder = Path(folder)
        try:
            if kind == "single":
                units = units_of(options, seed, folder)
                name = own.choice(sorted(n for n in (options.effect or EFFECTS) if n in units))
                parameter, unit = units[name]
                sign = own.choice([-1, 1]) if EFFECTS[name][1] else 1
                effects, values = hide(name, parameter, sign * size * unit)
                truth["effects"].append({"name": name, "parameters": values, "statistic": UNIT * size})
            record(options, seed, seed, effects, folder / "case.h5")
            found, case["seconds"] = diagnose(options, "contact", folder / "case.h5", folder)
        except ValueError as error:
            case["failure"] = str(error)
            return case
        compare(case, truth, found)
    return case


def main():
    parser = study_parser(__doc__, "a test")
    options = parser.parse_args()
    run_studies(parser, options, "robot_stances", study)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""Hides effects in the synthetic EMG study (problem emg_shape), runs the diagnosis on the files, and counts.

Each case: the program synthesizes the envelopes of a person drawn at random (two muscles, four speeds, six training and three
held-out cycles a speed; EMG of one electrode per muscle) with one effect whose size is known here and nowhere in the file;
`sinew diagnose emg_shape` sees the data only. A size is in units of what a test of that effect alone, at 5 %, just detects with
95 %: from the diagnosis of another recording of the same person, without a fault. Counts are those of ../hidden_effects/README.md.

usage: run.py --sinew PATH [--kind none,single,outsider] [--cases 100] [--sizes 1,2,3] [--jobs 2] [--first-seed 1]
              [--laws no|yes] [--out results.json]        run.py --merge results.json...
"""
import random
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "hidden_effects"))
from counting import compare  # noqa: E402
from studies import diagnose, run_studies, study_parser, synthesize  # noqa: E402

UNIT = 3.605
POWER = 1.645  # of smallest_detectable, which is for the family's threshold
PEOPLE = 20  # of single effects
STUDY = {"raw": 0, "moments": 0, "speeds": 4, "muscles": 2, "train": 6, "validate": 3}
MUSCLES = ("lat_gas_r", "med_gas_r")
TRIALS = ("train_045", "train_075", "train_090", "train_120")
# Effect: its parameters in one muscle, and whether it has two signs.
EFFECTS = {
    "amplitude_with_speed": ("{m}.amplitude_exponent", True),
    "phase_shift_with_speed": ("lead", True),
    "warp_with_speed": ("warp_sine", True),
    "fatigue": ("{m}.fatigue", True),
    **{f"noise_floor@{t}": ("{m}.floor@" + t, False) for t in TRIALS},
    **{f"cross_talk.{m}": (f"cross_talk.{m}", False) for m in MUSCLES},
}
OUTSIDERS = {"lost_bursts": 0.6, "loose_electrode": 0.5, "hum": 0.04}


def record(options, person, seed, effects, out):
    words = [f"--set={k}={v}" for k, v in STUDY.items()] + [f"--set=subject={person}", f"--set=laws={int(options.laws == 'yes')}"]
    for effect, values in effects.items():
        for name, value in values.items():
            words += ["--effect", f"{effect}:{name}={value!r}"]
    synthesize(options, "emg_shape", seed, words, out)


def units_of(options, person):
    """{effect: amplitude of unit size} of the parameter that the diagnosis names, and which one that is."""
    with tempfile.TemporaryDirectory(prefix="hidden_emg_") as folder:
        folder = Path(folder)
        record(options, person, 900000 + person, {}, folder / "data.h5")
        found, _ = diagnose(options, "emg_shape", folder / "data.h5", folder, "--solver", "lm")
    units = {}
    for score in found["scores"]:
        told = score.get("smallest_detectable")
        if score["known"] and told:
            units[score["effect"]] = (told["parameter"], told["value"] * UNIT / (found["threshold"] + POWER))
    return units


def study(options, kind, size, seed):
    case = {"kind": kind, "size": size, "noise": "emg", "seed": seed}
    own = random.Random(1000003 * seed + int(100 * size) + {"none": 0, "single": 1, "outsider": 2}[kind])
    # Sizes need a recording without a fault of the same person; without sizes, every case is another person.
    person = 100 + (seed % PEOPLE if kind == "single" else seed)
    truth = {"base": {}, "effects": []}
    effects = {}
    if kind == "single":
        names = sorted(n for n in (options.effect or EFFECTS) if n in options.units[person])
        effect = own.choice(names)
        parameter, unit = options.units[person][effect]
        sign = own.choice([-1, 1]) if EFFECTS[effect][1] else 1
        effects = {effect: {parameter: sign * size * unit}}
        truth["effects"].append({"name": effect, "parameters": effects[effect], "statistic": UNIT * size})
    elif kind == "outsider":
        effect = own.choice(sorted(OUTSIDERS))
        effects = {effect: {effect: OUTSIDERS[effect] * size / 3}}
        truth["effects"].append({"name": effect, "parameters": effects[effect], "statistic": UNIT * size})
    case["truth"] = truth
    with tempfile.TemporaryDirectory(prefix="hidden_emg_") as folder:
        folder = Path(folder)
        try:
            record(options, person, seed, effects, folder / "case.h5")
            found, case["seconds"] = diagnose(options, "emg_shape", folder / "case.h5", folder, "--solver", "lm")
        except ValueError as error:
            case["failure"] = str(error)
            return case
        compare(case, truth, found)
    return case


def find_units(options, plan):
    people = sorted({100 + seed % PEOPLE for kind, _, seed in plan if kind == "single"})
    with ThreadPoolExecutor(options.jobs) as pool:
        options.units = dict(zip(people, pool.map(lambda p: units_of(options, p), people)))


def main():
    parser = study_parser(__doc__, "a test")
    parser.add_argument("--laws", choices=["no", "yes"], default="no",
                        help="yes: size and phase do change with speed, and the model has laws for that")
    options = parser.parse_args()
    run_studies(parser, options, "hidden_emg", study, find_units)


if __name__ == "__main__":
    sys.exit(main())

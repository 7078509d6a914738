#!/usr/bin/python3
"""Effects hidden in two fitted stances whose motion was measured with errors: are they found, named, and is nothing found where nothing is?

README.md describes the studies and the counts.

usage: hidden.py --sinew PATH --seeds 2001:2030 --out RESULTS.json [--size 2] [--per-seed 2] [--told] [--jobs 1] [--seconds 3000] [--set full_rate=1]
       hidden.py --report RESULTS.json...
"""
import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))
from wilson import wilson  # noqa: E402
from run import POSITION, ROTATION, draw, load, seeds_of, settings_of, write_settings  # noqa: E402

DETECTABLE = 3.605  # length of a signature that a test for it alone at 5 % detects with 95 %
LONGEST = 900       # [s] of one diagnosis
WHOLE_LIBRARY = 10  # -2 log L, about what a test of some thirty effects at 5 % needs
# Name: lower and upper end of what may be hidden, which are those of the problem; the parameter that is not 0 comes first.
EFFECTS = {
    "height_offset": (-0.01, 0.01),
    "right.height_offset": (-0.01, 0.01),
    "right_force_y.time_offset": (-0.05, 0.05),
    "right_force_x.time_offset": (-0.05, 0.05),
    "right_force_y.gain": (-0.2, 0.2),
    "right_force_x.gain": (-0.2, 0.2),
    "right_force_y.offset": (-100, 100),
    "tilted_floor": (-0.05, 0.05),
    "floor_compliance": (0, 1e-5),
    "stiffness_exponent": (-0.5, 2),
    "missing_toe_region": (0, 1),
    "unmodelled_mass": (-5, 5),
    "foot_bend": (-0.2, 0.2),
    "linear_damping": (0, 1e6),
    "uneven_stiffness": (-2, 2),
    "shear_compliance": (0, 1e-4),
}
# Of several values, the one that is hidden is the first; the others stay at 0, their null.
SEVERAL = {
    "tilted_floor": ("floor_slope_x", "floor_slope_z"),
    "foot_bend": ("foot_bend_early", "foot_bend_middle", "foot_bend_late"),
    "uneven_stiffness": ("stiffness_toes_to_heel", "stiffness_middle_to_ends", "stiffness_outside_to_inside"),
}
OF_NULL_ONE = ("gain",)  # the null of these parameters is 1


def request(name, value):
    if name in SEVERAL:
        # Sized by `smallest_detectable`, which is of the first one.
        first, *others = SEVERAL[name]
        return f"{name}:{first}={value!r}" + "".join(f",{other}=0" for other in others)
    parameter = {"missing_toe_region": "toe_region_weight"}.get(name, "value" if "." in name else name)
    return f"{name}:{parameter}={1 + value if name.endswith(OF_NULL_ONE) else value!r}"


def synthesize(options, seed, truth, data, effects):
    values = {**truth, "person": 1, "encoders": 1, "train": 2, "validate": 1, "slip": 0.1,
              "motion_error": POSITION, "rotation_error": ROTATION, **settings_of(options)}
    words = [options.sinew, "data", "synthesize", "contact", "--seed", seed, "--out", data, "--quiet"]
    words += [w for name, value in values.items() for w in ("--set", f"{name}={value!r}")]
    words += [w for effect in effects for w in ("--effect", effect)]
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr[-400:])


def diagnose(options, folder, data, settings):
    found = folder / "found.json"
    found.unlink(missing_ok=True)
    began = time.monotonic()
    try:
        done = subprocess.run([str(w) for w in (options.sinew, "diagnose", "contact", "--data", data, "--config", settings, "--threads", 1,
                                                "--quiet", "--out", folder / "found.h5", "--json", found)],
                              capture_output=True, text=True, check=False, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return None, f"took longer than {LONGEST} s", LONGEST
    if not found.exists():
        return None, done.stderr[-400:], time.monotonic() - began
    return json.loads(found.read_text()), "", time.monotonic() - began


def told(options, folder, data, settings, effect):
    """Cost of the fit that is told which effect is hidden."""
    found = folder / "told.json"
    found.unlink(missing_ok=True)
    done = subprocess.run([str(w) for w in (options.sinew, "identify", "contact", "--data", data, "--config", settings, "--threads", 1,
                                            "--quiet", "--release", effect, "--intervals", "linear", "--out", folder / "told.h5",
                                            "--json", found)], capture_output=True, text=True, check=False, timeout=LONGEST)
    if not found.exists():
        raise RuntimeError(done.stderr[-400:])
    return json.loads(found.read_text())["cost"]


def facts(found, seconds):
    return {"verdict": found["verdict"], "p": found["family_p_value"], "seconds": seconds,
            "causes": [c["effect"] for c in found["causes"]],
            "alternatives": [a["effect"] for a in found["alternatives"]],
            "withdrawn": [w["effect"] for w in found.get("withdrawn", [])],
            "terms": [f"{u['port']}({u['signal']})" for u in found["unknown_terms"]],
            "base": found["base"]["stop_test"], "cost": found["base"]["cost"]}


def unit_sizes(found):
    """Of the effects that this diagnosis could judge: the value whose signature has the length DETECTABLE."""
    sizes = {}
    for score in found["scores"]:
        least = score.get("smallest_detectable")
        if score["effect"] in EFFECTS and least:
            sizes[score["effect"]] = DETECTABLE * least["value"] / (found["threshold"] + 1.645)
    return sizes


def study(options, seed):
    """The stances with nothing hidden, then the same ones with one effect at a time."""
    with tempfile.TemporaryDirectory(prefix="hidden_") as folder:
        folder = Path(folder)
        settings, _ = write_settings(folder)
        truth = draw(seed)
        data = folder / "data.h5"
        synthesize(options, seed, truth, data, [])
        found, failure, seconds = diagnose(options, folder, data, settings)
        if found is None:
            return {"seed": seed, "failure": failure}
        one = {"seed": seed, "truth": truth, "none": facts(found, seconds), "hidden": [], "beyond": []}
        sizes = unit_sizes(found)
        random = np.random.default_rng([24, seed])
        for name in random.permutation(list(EFFECTS)):
            name = str(name)
            low, high = EFFECTS[name]
            sign = 1 if low == 0 or random.uniform() < 0.5 else -1
            value = sign * options.size * sizes.get(name, math.inf)
            if not low <= value <= high:
                one["beyond"].append(name)  # no value that the problem allows has this size
                continue
            if len(one["hidden"]) == options.per_seed:
                break
            try:
                synthesize(options, seed, truth, data, [request(name, value)])
            except RuntimeError as error:
                one["hidden"].append({"effect": name, "value": value, "failure": str(error)})
                continue
            found, failure, seconds = diagnose(options, folder, data, settings)
            case = {"effect": name, "value": value, "size": options.size}
            if found is None:
                one["hidden"].append({**case, "failure": failure})
                continue
            case.update(facts(found, seconds))
            if options.told:
                case["told"] = told(options, folder, data, settings, name)
            one["hidden"].append(case)
        return one


def share(title, hits, n):
    if n == 0:
        return
    low, high = wilson(hits, n)
    print(f"  {title}: {hits} of {n}, {100 * hits / n:.1f} % (Wilson {100 * low:.1f} .. {100 * high:.1f})")


def show(results):
    for one in results:
        if "failure" in one:
            print(f"  seed {one['seed']}: {one['failure']}")
    good = [one for one in results if "none" in one]
    none = [one["none"] for one in good]
    print("nothing hidden")
    share("false alarms (verdict not adequate)", sum(c["verdict"] != "adequate" for c in none), len(none))
    share("p-value below 0.05", sum(c["p"] <= 0.05 for c in none), len(none))
    cases = [c for one in good for c in one["hidden"] if "verdict" in c]
    failed = [c for one in good for c in one["hidden"] if "failure" in c]
    print(f"hidden, {len(cases)} cases ({len(failed)} failed)")
    found = [c for c in cases if c["verdict"] != "adequate"]
    stated = [c for c in found if c["effect"] in c["causes"] + c["alternatives"]]
    share("detected", len(found), len(cases))
    known = [c for c in cases if "told" in c]
    if known:
        gains = [2 * (c["cost"] - c["told"]) for c in known]
        expected = (DETECTABLE * known[0]["size"]) ** 2
        print(f"  -2 log L falls by {np.median(gains):.0f} in the median where the effect is told ({expected:.0f} by the linear model)")
        for least in (3.84, WHOLE_LIBRARY):
            able = [c for c, gain in zip(known, gains) if gain > least]
            share(f"detected, where it falls by more than {least:g}", sum(c in found for c in able), len(able))
            share(f"truth in the stated set, where it falls by more than {least:g}", sum(c in found and c["effect"] in c["causes"] + c["alternatives"]
                                                                                     for c in able), len(able))
    share("truth in the stated set, of all", len(stated), len(cases))
    share("truth in the stated set, of the detected", len(stated), len(found))
    share("named first, of the detected", sum(c["causes"][:1] == [c["effect"]] for c in found), len(found))
    share("unexplained, of the detected", sum(c["verdict"] == "unexplained" for c in found), len(found))
    if stated:
        print(f"  size of the stated set where it holds the truth: {np.mean([len(c['causes']) + len(c['alternatives']) for c in stated]):.1f}")
    for name in EFFECTS:
        own = [c for c in cases if c["effect"] == name]
        beyond = sum(name in one["beyond"] for one in good)
        print(f"    {name:26s} {sum(c in stated for c in own)} stated, {sum(c in found for c in own)} detected of {len(own)}; "
              f"beyond its range in {beyond} seeds")
    seconds = [c["seconds"] for c in none + cases]
    print(f"  {np.median(seconds):.0f} s per diagnosis in the median, {max(seconds):.0f} s at most (busy machine)")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", default="1:2", help="first:last")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="of the synthetic data, such as full_rate=1")
    parser.add_argument("--size", type=float, default=2, help="over the size that an oracle detects with 95 %%")
    parser.add_argument("--per-seed", type=int, default=2, help="hidden effects, one at a time")
    parser.add_argument("--told", action="store_true", help="fit each hidden effect, told which, too: what could be detected at all?")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=math.inf, help="no study begins later")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path, nargs="*")
    options = parser.parse_args()
    if options.report:
        show(load(options.report))
        return
    options.sinew = options.sinew.resolve()
    began = time.monotonic()
    results = []

    def work(seed):
        if time.monotonic() - began > options.seconds:
            return
        try:
            results.append(study(options, seed))
        except RuntimeError as error:
            results.append({"seed": seed, "failure": str(error)})
        if options.out:
            options.out.write_text(json.dumps(results))

    with ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(work, seeds_of(options.seeds)))
    if results:
        show(results)


if __name__ == "__main__":
    main()

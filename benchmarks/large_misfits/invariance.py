#!/usr/bin/python3
"""Does the answer depend on what it should not depend on? Cases of cases.py are diagnosed again with data changed by 1e-9 of each channel's
size, with two threads and with other seeds of the program; recorded at half and at double the rate, which is also new noise; and with
every training trial cut in two. The answer of the first run is what they are compared with.

usage: invariance.py --sinew PATH --seeds 620:649 [--jobs 1] [--variants perturbed,two_threads,seed_2,...] --out RESULTS.json [--resume]
       invariance.py --report RESULTS.json [--each]
"""
import argparse
import json
import math
import sys
import tempfile
from pathlib import Path

import h5py
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import cases  # noqa: E402
from run import held_out, share, sinew, study_all  # noqa: E402

SAME = ("perturbed", "two_threads", "seed_2", "seed_3", "seed_4", "seed_5")  # the same data: names equal, held-out error within 1 %
OTHER = ("half_rate", "double_rate", "cut")                                  # other data of the same joint: names equal


def perturb(source, target):
    """Every channel plus white noise of 1e-9 of its root mean square."""
    target.write_bytes(source.read_bytes())
    draw = numpy.random.default_rng(1)
    with h5py.File(target, "r+") as file:
        def change(_, item):
            if isinstance(item, h5py.Dataset) and "/channels/" in item.name and item.dtype.kind == "f":
                values = item[()]
                item[()] = values + 1e-9 * numpy.sqrt(numpy.mean(values**2)) * draw.standard_normal(values.shape)
        file.visititems(change)


def synthesize(program, case, rate, target):
    case.settings["rate"] = rate
    sinew(program, "data", "synthesize", "drive", *case.words(), "--out", target, "--quiet")


def answer(program, data, folder, threads=1, seed=1):
    found = folder / "why.json"
    sinew(program, "diagnose", "drive", "--data", data, "--threads", threads, "--seed", seed, "--quiet", "--out", folder / "why.h5",
          "--json", found)
    d = json.loads(found.read_text())
    return {"verdict": d["verdict"], "causes": sorted(c["effect"] for c in d["causes"]),
            "alternatives": sorted([a["instead_of"], a["effect"]] for a in d["alternatives"]), "held_out": held_out(d["extended_fit"])}


def variant(name, program, case, data, folder):
    rate = case.settings["rate"]
    changed = folder / f"{name}.h5"
    if name == "perturbed":
        perturb(data, changed)
    elif name in ("half_rate", "double_rate"):
        synthesize(program, cases.draw_case(case.seed), rate / 2 if name == "half_rate" else rate * 2, changed)
    elif name == "cut":
        changed.write_bytes(data.read_bytes())
        sinew(program, "data", "split", changed, "--every", case.settings["duration"] / 2)
    else:
        changed = data
    return answer(program, changed, folder, threads=2 if name == "two_threads" else 1,
                  seed=int(name.split("_")[1]) if name.startswith("seed") else 1)


def samples(case):
    return case.settings["train"] * case.settings["rate"] * case.settings["duration"]


def study(options, seed):
    case = cases.draw_case(seed)
    result = {"seed": seed, "effects": sorted(case.effects), "outsider": next(iter(case.outsider), ""), "variants": {}}
    with tempfile.TemporaryDirectory(prefix="invariance_") as folder:
        folder = Path(folder)
        data = folder / "case.h5"
        try:
            synthesize(options.sinew, cases.draw_case(seed), case.settings["rate"], data)
            result["first"] = answer(options.sinew, data, folder)
            for name in options.variants:
                result["variants"][name] = variant(name, options.sinew, case, data, folder)
        except RuntimeError as error:
            result["error"] = str(error)[-2000:]
    return result


def names(one):
    """Effects that nothing can tell apart (cases.CLASSES) count as one name."""
    return sorted({min(cases.class_of(name)) for name in one["causes"]})


def stated(one):
    return set(names(one)) | {min(cases.class_of(name)) for _, name in one["alternatives"]}


def tell(results, each):
    good = [r for r in results if "first" in r]
    print(f"{len(results)} cases, {len(results) - len(good)} failed")
    for name in (*SAME, *OTHER):
        some = [(r["first"], r["variants"][name]) for r in good if name in r["variants"]]
        if not some:
            continue
        # A name that the other answer states as an alternative is the same statement.
        agree = sum(set(names(a)) <= stated(b) and set(names(b)) <= stated(a) for a, b in some)
        error = sum(abs(b["held_out"] / a["held_out"] - 1) <= 0.01 for a, b in some)
        print(f"{name}: same names {share(sum(names(a) == names(b) for a, b in some), len(some))}; each name a cause or an alternative of the "
              f"other {share(agree, len(some))}; same verdict {share(sum(a['verdict'] == b['verdict'] for a, b in some), len(some))}"
              + (f"; held-out error within 1 % {share(error, len(some))}" if name in SAME else ""))
    if each:
        for r in good:
            print(f"{r['seed']}: true {', '.join(r['effects'])}{' + ' + r['outsider'] if r['outsider'] else ''}")
            for name, one in (("first", r["first"]), *r["variants"].items()):
                if name == "first" or names(one) != names(r["first"]) or abs(one["held_out"] / r["first"]["held_out"] - 1) > 0.01:
                    print(f"  {name}: {one['verdict']}, {', '.join(one['causes'])}; or "
                          f"{', '.join('/'.join(a) for a in one['alternatives'])}; held-out {one['held_out']:.5f} rad")
    for r in results:
        if "error" in r:
            print(f"{r['seed']}: {r['error'][-300:]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", default="620:649", help="first:last")
    parser.add_argument("--variants", type=lambda text: text.split(","), default=[*SAME, *OTHER])
    parser.add_argument("--most-samples", type=float, default=math.inf, help="of the training data; larger cases are left out")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--resume", action="store_true", help="without the seeds that --out has already")
    parser.add_argument("--report", type=Path)
    parser.add_argument("--each", action="store_true", help="what differs, case by case")
    options = parser.parse_args()
    if options.report:
        tell(json.loads(options.report.read_text()), options.each)
        return
    first, last = map(int, options.seeds.split(":"))
    seeds = [seed for seed in range(first, last + 1) if samples(cases.draw_case(seed)) <= options.most_samples]
    results = study_all(options, seeds, lambda seed: study(options, seed), lambda r: r["first"])
    tell(results, options.each)


if __name__ == "__main__":
    main()

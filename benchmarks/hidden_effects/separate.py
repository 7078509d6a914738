#!/usr/bin/python3
"""Does the experiment that a diagnosis suggests separate two effects that it could not distinguish?

Each case: one effect is hidden as in run.py and the file is diagnosed. Where the truth is stated together with others, the case
is made again with one more trial of the kind that `separated_by` names (joint, effect, ordinary trials and their noise stay
the same), diagnosed again, and the sets are compared. Control: one more trial of the ordinary kind. Effects of the truth's
declared class are counted apart.

usage: separate.py --sinew PATH --generate PATH [--cases 60] [--sizes 2,3] [--effect NAME] [--first-seed 1] [--every-kind]
                   [--jobs 1] [--out results.json]
"""
import argparse
import json
import statistics
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from counting import cell, counted, read, run
from studies import numbers

KINDS = ("same", "rest", "creep", "hold", "fast", "sharp")
# By the text of a suggestion. None: it needs an instrument, a stop or a weight that these data do not have. Where a suggestion
# has two parts ("several positions, one of them known", "a trigger, then a sharp command"), the trial is the part that these
# data can have.
KIND_OF = {
    "slow reversals under small torques, where the joint sticks": "creep",
    "the same slow motion forwards and backwards": "creep",
    "creeping at several constant, very low speeds": "creep",
    "the same slow motion with and without a weight, or swings over a wider range": "fast",
    "lifting and lowering the same weight slowly, or swings over a wider range": "fast",
    "breaking away slowly under several weights, or swings over a wider range": "fast",
    "the same slow motion under several weights, or swings over a wider range": "fast",
    "constant speeds up to the highest": "fast",
    "holding many positions over the whole range at rest": "hold",
    "holding several positions at rest, one of them an angle that is known by other means": "hold",
    "motion over a wider range of positions": "fast",
    "holding several positions at rest, and a rest with the drive switched off": "hold",
    "large commands against a fixed stop": None,
    "large commands without a load": "fast",
    "commands of several sizes at rest against a torque sensor": None,
    "the same motion at the begin and at the end of a long trial": "same",
    "a trigger that all instruments record, then one sharp command, at a high sampling rate": "sharp",
    "fast commands recorded much faster than they are sent": "sharp",
    "slow reversals with sensors on both sides of the gear": None,
    "torque against a fixed stop": None,
    "holding several positions at rest, one of them with an input that is known by other means": "hold",
    "rest phases at several values, one of them known by other means": "hold",
    "holding several positions at rest, at the begin and at the end of a long trial": "hold",
    "rest phases at several values, at the begin and at the end of a long trial": "hold",
    "a known input": None,
    "a true value that is known by other means, or a trial over a wider range": "fast",
    "a trigger that all instruments record, at a high sampling rate": None,
    "a sharp input, recorded before and after the filter": None,
    "a sudden event (a drop, a tap) recorded without the filter, at a high sampling rate": None,
    "a trial with larger values, or with a sensor of a wider range": "fast",
    "a slow ramp, where the steps can be seen one by one": "creep",
}


def diagnose(options, folder, size, seed, also):
    """Truth and result of a case with the given trials on top."""
    name = "_".join(["case", *also])
    data, truth, found = (folder / f"{name}{end}" for end in (".h5", "_truth.json", "_found.json"))
    words = [options.generate, "--kind", "single", "--seed", seed, "--size", size, "--noise", options.noise, "--experiment",
             options.experiment, "--no-correlations", "--out", data, "--truth", truth]
    words += [w for effect in options.effect for w in ("--effect", effect)]
    words += [w for kind in also for w in ("--also", kind)]
    status, _, message = run(*words)
    if status != 0:
        raise SystemExit(message)
    status, seconds, message = run(options.sinew, "diagnose", "drive", "--data", data, "--out", folder / f"{name}_run.h5",
                                   "--json", found, "--seed", options.program_seed, "--threads", 1, "--quiet")
    data.unlink()
    return read(truth)["effects"][0]["name"], read(found), seconds, message or f"exit status {status}"


def stated(found):
    return [c["effect"] for c in found["causes"]] + [a["effect"] for a in found["alternatives"]]


def set_size(found):
    """Of the stated set, a declared class counting as one."""
    return len(found["causes"]) + sum(not a.get("same_class") for a in found["alternatives"])


def rivals(truth, found):
    """What is stated beside the truth, and the suggested experiment; `class`: of the truth's declared class."""
    own = {truth}
    for _ in range(2):  # twice: the truth may come after others of its class
        for a in found["alternatives"]:
            if a.get("same_class") and own & {a["instead_of"], a["effect"]}:
                own |= {a["instead_of"], a["effect"]}
    result = []
    for a in found["alternatives"]:
        if a.get("contains_cause"):  # no experiment can exclude a law that contains the cause
            continue
        pair = [a["instead_of"], a["effect"]]
        others = [e for e in pair if e not in own]
        if a.get("same_class"):
            if truth not in pair:
                continue
            others = [e for e in pair if e != truth]
        if len(others) == 1:
            result.append({"rival": others[0], "class": bool(a.get("same_class")), "correlation": abs(a["correlation"]),
                           "separated_by": a["separated_by"], "kind": KIND_OF.get(a["separated_by"], "unknown")})
    return result


def study(options, size, seed):
    """One case: its pairs, and per kind of further trial the result."""
    case = {"size": size, "seed": seed, "pairs": [], "after": {}}
    with tempfile.TemporaryDirectory(prefix="separate_") as folder:
        folder = Path(folder)
        case["truth"], found, case["seconds"], message = diagnose(options, folder, size, seed, [])
        if found is None:
            return {**case, "failure": message}
        case["stated"], case["set_size"] = stated(found), set_size(found)
        case["first"] = case["stated"][:1] == [case["truth"]]
        if case["truth"] not in case["stated"]:
            return case
        case["pairs"] = rivals(case["truth"], found)
        if not case["pairs"]:
            return case
        kinds = set(KINDS) if options.every_kind else {"same"} | {p["kind"] for p in case["pairs"]} - {None, "unknown"}
        for kind in sorted(kinds):
            _, found, seconds, message = diagnose(options, folder, size, seed, [kind])
            if found is None:
                case["after"][kind] = {"failure": message}
                continue
            names = stated(found)
            case["after"][kind] = {"stated": names, "set_size": set_size(found), "first": names[:1] == [case["truth"]],
                                   "truth_in_set": case["truth"] in names, "seconds": seconds}
    return case


def separated(case, pair, kind):
    """Is the rival gone and the truth still stated? None where that trial was not tried."""
    after = case["after"].get(kind)
    if after is None:
        return None
    return "failure" not in after and after["truth_in_set"] and pair["rival"] not in after["stated"]


def count(values):
    values = [v for v in values if v is not None]
    return counted(sum(values), len(values))


def short(values):
    result = count(values)
    return f"{result['hits']}/{result['of']}" if result else "-"


def print_rows(rows):
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        print("  " + "  ".join(text.ljust(width) if i < 3 else text.rjust(width)
                               for i, (text, width) in enumerate(zip(row, widths))).rstrip())


def mean_correlation(group):
    return f"{statistics.fmean(p['correlation'] for _, p in group):.3f}"


def by(pairs, key):
    groups = {}
    for case, pair in pairs:
        groups.setdefault(key(case, pair), []).append((case, pair))
    return sorted(groups.items(), key=lambda g: (-len(g[1]), str(g[0])))


def print_groups(titles, pairs, key, extra):
    rows = [[*titles, "|R|", "seen", "suggested", "control", *extra]]
    for words, group in by(pairs, key):
        kind = group[0][1]["kind"]
        rows.append([*words, mean_correlation(group), str(len(group)),
                     *(short(separated(c, p, k) for c, p in group) for k in (kind, "same", *extra))])
    print_rows(rows)


def summarise_pairs(title, pairs, extra):
    """Tables and counts of pairs of a case and a rival."""
    print(f"\n{title}")
    words_of = {None: "not in these data"}
    print_groups(["truth", "stated beside it", "trial"], pairs,
                 lambda c, p: (c["truth"], p["rival"], words_of.get(p["kind"], p["kind"])), extra)
    print()
    print_groups(["suggestion", "", "trial"], pairs,
                 lambda _, p: (p["separated_by"], "", words_of.get(p["kind"], p["kind"])), extra)
    done = [(c, p) for c, p in pairs if p["kind"] in KINDS]
    counts = {"pairs": len(pairs), "pairs_tried": len(done),
              "suggested": count(separated(c, p, p["kind"]) for c, p in done),
              "control": count(separated(c, p, "same") for c, p in done),
              "only_suggested": sum(bool(separated(c, p, p["kind"])) and not separated(c, p, "same") for c, p in done),
              "only_control": sum(bool(separated(c, p, "same")) and not separated(c, p, p["kind"]) for c, p in done)}
    print(f"{len(pairs)} pairs, {len(done)} with a suggestion that these data can have; separated by the suggested trial "
          f"{cell(counts['suggested'])}, by one more ordinary trial {cell(counts['control'])}; only by the first "
          f"{counts['only_suggested']}, only by the second {counts['only_control']}")
    # Of a case and a suggested kind: each once, however many pairs it is suggested for.
    once = {(c["size"], c["seed"], p["kind"]): (c, p["kind"]) for c, p in done}.values()
    for name, kind_of in (("suggested", lambda k: k), ("control", lambda _: "same")):
        after = [(c, c["after"][kind_of(k)]) for c, k in once]
        after = [(c, a) for c, a in after if "failure" not in a]
        if not after:
            continue
        row = {"mean_set_size_before": statistics.fmean(c["set_size"] for c, _ in after),
               "mean_set_size_after": statistics.fmean(a["set_size"] for _, a in after),
               "truth_first_before": count(c["first"] for c, _ in after), "truth_first_after": count(a["first"] for _, a in after),
               "truth_in_set_after": count(a["truth_in_set"] for _, a in after)}
        counts["sets_" + name] = row
        print(f"{name}: stated set {row['mean_set_size_before']:.2f} -> {row['mean_set_size_after']:.2f}, truth first "
              f"{cell(row['truth_first_before'])} -> {cell(row['truth_first_after'])}, truth stated "
              f"{cell(row['truth_in_set_after'])}")
    return counts


def summarise(cases, every_kind):
    pairs = [(c, p) for c in cases for p in c["pairs"]]
    extra = [k for k in KINDS if k != "same"] if every_kind else []
    summary = {"cases": len(cases), "failed": sum("failure" in c for c in cases),
               "truth_in_set": sum(c["truth"] in c.get("stated", []) for c in cases),
               "truth_with_others": sum(any(not p["class"] for p in c["pairs"]) for c in cases),
               "truth_with_its_class": sum(any(p["class"] for p in c["pairs"]) for c in cases)}
    print(f"{summary['cases']} cases, {summary['failed']} failed, truth stated in {summary['truth_in_set']}, with others in "
          f"{summary['truth_with_others']}, with others of its class in {summary['truth_with_its_class']}")
    summary["others"] = summarise_pairs("not of one class", [(c, p) for c, p in pairs if not p["class"]], extra)
    summary["classes"] = summarise_pairs("of one class", [(c, p) for c, p in pairs if p["class"]], extra)
    unknown = Counter(p["separated_by"] for _, p in pairs if p["kind"] == "unknown")
    for text, often in unknown.items():
        print(f"not in the table of this script ({often}): {text}")
    return summary


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--generate", type=Path, required=True, help="hidden_effects_generate")
    parser.add_argument("--cases", type=int, default=60, help="per size")
    parser.add_argument("--sizes", type=numbers, default=[2.0, 3.0], help="in units of what an oracle just detects")
    parser.add_argument("--noise", choices=["white", "ar", "other"], default="white")
    parser.add_argument("--experiment", choices=["multisine", "trapezoid"], default="multisine")
    parser.add_argument("--effect", action="append", default=[], help="hide this one instead of drawing")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--program-seed", type=int, default=1, help="--seed of the diagnosis")
    parser.add_argument("--every-kind", action="store_true", help="try every kind of trial, not the suggested alone")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()

    begin = time.monotonic()
    with ThreadPoolExecutor(options.jobs) as pool:
        cases = list(pool.map(lambda p: study(options, *p), [(size, options.first_seed + i) for size in options.sizes
                                                             for i in range(options.cases)]))
    summary = summarise(cases, options.every_kind)
    for failure in sorted({c["failure"] for c in cases if "failure" in c})[:5]:
        print(f"failed: {failure}")
    print(f"{time.monotonic() - begin:.0f} s")
    if options.out:
        settings = {k: str(v) if isinstance(v, Path) else v for k, v in vars(options).items()}
        options.out.write_text(json.dumps({"schema": "sinew.separate/1", "settings": settings, "summary": summary,
                                           "cases": cases}, indent=1))


if __name__ == "__main__":
    main()

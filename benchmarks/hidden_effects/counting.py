"""A diagnosis beside the truth that its data file does not hold, and tables of many of them. README.md describes the counts."""
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from wilson import wilson  # noqa: E402

LONGEST = 600       # [s] of one command; a case that takes longer is counted as failed
MATCHED = 0.8       # an outsider whose signature an effect of the library matches so well is counted apart
SEPARABLE = 0.4165  # size s tells two effects apart with 95 % only if 1 - |R| > SEPARABLE / s^2
NOMINAL = 1.959964


def run(*words):
    """Status, seconds and the last line of standard error of a command."""
    begin = time.monotonic()
    try:
        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=LONGEST, check=False)
    except subprocess.TimeoutExpired:
        return -1, time.monotonic() - begin, f"took longer than {LONGEST} s"
    lines = done.stderr.strip().splitlines()
    return done.returncode, time.monotonic() - begin, lines[-1] if lines else ""


def read(path):
    return json.loads(path.read_text()) if path.exists() else None


def intervals(parameters):
    """Value and 95 % interval by name, of parameters that have one."""
    return {p["name"]: (p["value"], p["ci95"]) for p in parameters if p.get("ci95") and None not in p["ci95"]}


def covered(truth, known):
    """Per parameter of the hidden effect that has an interval: is the truth inside?"""
    return {name: known[name][1][0] <= value <= known[name][1][1]
            for effect in truth["effects"] for name, value in effect["parameters"].items() if name in known}


def base_covered(truth, known):
    return {name: known[name][1][0] <= value <= known[name][1][1]
            for name, value in truth["base"].items() if name in known}


def compare(case, truth, found):
    causes = [c["effect"] for c in found["causes"]]
    classes = {c: {c} for c in causes}       # a declared class counts as one with its cause
    others = {c: [] for c in causes}
    for a in found["alternatives"]:
        if a.get("same_class"):
            classes.setdefault(a["instead_of"], {a["instead_of"]}).add(a["effect"])
        else:
            others.setdefault(a["instead_of"], []).append(a["effect"])
    case["verdict"] = found["verdict"]
    case["threshold"] = found.get("threshold")
    case["family_p_value"] = found.get("family_p_value")
    case["causes"] = causes
    case["alternatives"] = [{k: a.get(k) for k in ("instead_of", "effect", "same_class", "separating_size")}
                            for a in found["alternatives"]]
    case["unknown_terms"] = [f"{u['port']}({u['signal']})" for u in found["unknown_terms"]]
    case["withdrawn"] = [w["effect"] for w in found.get("withdrawn", [])]
    case["gain"] = found.get("gain")
    case["detected"] = found["verdict"] != "adequate"
    gain = found.get("gain") or {}
    # Of held-out trials, by an extended model that has an unknown term.
    case["unknown_term_gains"] = bool(found["unknown_terms"]) and (gain.get("reduction") or 0) > 0
    case["unknown_term_gains_for_sure"] = case["unknown_term_gains"] and gain["ci95"][0] > 0
    stated = set(causes) | {a["effect"] for a in found["alternatives"]}
    case["set_size"] = sum(1 + len(others.get(c, [])) for c in causes)
    hidden = [e["name"] for e in truth["effects"]]
    if not hidden:
        return
    statistics_ = [abs(e["statistic"]) for e in truth["effects"]]
    case["oracle_at_5"] = max(statistics_) > NOMINAL
    if case["threshold"]:
        case["oracle_at_threshold"] = max(statistics_) > case["threshold"]
    case["first"] = bool(causes) and causes[0] in hidden
    case["first_in_class"] = bool(causes) and bool(classes[causes[0]] & set(hidden))
    case["in_set"] = all(name in stated for name in hidden)
    case["exact"] = (len(causes) == len(hidden)
                     and all(any(name in classes[c] for c in causes) for name in hidden))
    if case["kind"] == "single" and "correlations" in truth["effects"][0]:
        limit = SEPARABLE / case["size"] ** 2
        case["inseparable"] = sum(1 - r <= limit for r in truth["effects"][0]["correlations"].values())
    extended = found.get("extended_parameters") or []
    after = {p["name"]: p["value"] for p in extended}
    before = {p["name"]: p["value"] for p in found["base"].get("parameters", [])}
    case["base_error_before"] = {n: before[n] / v - 1 for n, v in truth["base"].items() if n in before}
    case["base_error_after"] = {n: after[n] / v - 1 for n, v in truth["base"].items() if n in after}
    named = {}
    for c in found["causes"]:
        if c["effect"] in hidden:
            named.update(intervals(c["parameters"]))
    for a in found["alternatives"]:
        if a["effect"] in hidden:
            named.update({k: v for k, v in intervals(a.get("parameters", [])).items() if k not in named})
    case["stated_covers"] = covered(truth, named)


def counted(hits, count):
    """Share and its 95 % interval."""
    if count == 0:
        return None
    return {"share": hits / count, "hits": hits, "of": count, "ci95": list(wilson(hits, count))}


def share(cases, test):
    values = [test(c) for c in cases]
    values = [bool(v) for v in values if v is not None]
    return counted(sum(values), len(values))


def mean(values):
    values = [v for v in values if v is not None]
    return statistics.fmean(values) if values else None


def base_error(cases, key):
    """Median over cases of the largest relative error of a base parameter."""
    worst = [max(abs(v) for v in c[key].values()) for c in cases if c.get(key)]
    return statistics.median(worst) if worst else None


def coverage(cases, key):
    hits = [hit for c in cases for hit in c.get(key, {}).values()]
    return counted(sum(hits), len(hits))


# Outsiders that are a function of one signal that the model has: the others depend on two, on time or are periodic in it.
OF_ONE_SIGNAL = ("end_stop", "torque_bump", "coarse_command", "cubic_drag", "eccentric_encoder")


def best_match(case):
    """Largest |correlation| of an outsider's signature with an effect of the library; 0 if the oracle has none."""
    return max((abs(r) for r in case["truth"]["effects"][0].get("correlations", {}).values()), default=0)


def tally(kind, cases):
    """The counts of cases of one kind, size and noise."""
    done = [c for c in cases if "failure" not in c]
    result = {"cases": len(cases), "failed": len(cases) - len(done),
              "seconds_per_case": mean([c["seconds"] for c in done]),
              "detected": share(done, lambda c: c["detected"]),
              "verdicts": {v: sum(c["verdict"] == v for c in done) for v in sorted({c["verdict"] for c in done})}}
    if kind == "none":
        result["threshold"] = mean([c["threshold"] for c in done])
        return result
    result["oracle_at_5"] = share(done, lambda c: c["oracle_at_5"])
    result["oracle_at_threshold"] = share(done, lambda c: c.get("oracle_at_threshold"))
    named = [c for c in done if c["detected"]]
    if kind == "outsider":
        result["explained_by_the_library"] = share(done, lambda c: c["verdict"] in ("explained", "ambiguous")
                                                   and not c["unknown_terms"])
        far = [c for c in done if best_match(c) < MATCHED]
        near = [c for c in done if best_match(c) >= MATCHED]
        result["explained_unmatched"] = share(far, lambda c: c["verdict"] in ("explained", "ambiguous"))
        result["explained_matched"] = share(near, lambda c: c["verdict"] in ("explained", "ambiguous"))
        result["unknown_term_found"] = share(named, lambda c: bool(c["unknown_terms"]))
        one = [c for c in named if c["truth"]["effects"][0]["name"] in OF_ONE_SIGNAL]
        more = [c for c in named if c["truth"]["effects"][0]["name"] not in OF_ONE_SIGNAL]
        for key, group in (("one_signal", one), ("more_signals", more)):
            result["held_out_gain_" + key] = share(group, lambda c: c["unknown_term_gains"])
            unnamed = [c for c in group if c["verdict"] == "unexplained"]
            result["held_out_gain_unexplained_" + key] = share(unnamed, lambda c: c["unknown_term_gains"])
        names = sorted({c["truth"]["effects"][0]["name"] for c in done})
        result["by_outsider"] = {
            n: {v: sum(c["verdict"] == v for c in done if c["truth"]["effects"][0]["name"] == n)
                for v in ("adequate", "explained", "ambiguous", "unexplained")} for n in names}
        return result
    result["in_set"] = share(done, lambda c: c["in_set"])
    result["in_set_if_detected"] = share(named, lambda c: c["in_set"])
    result["mean_set_size"] = mean([c["set_size"] for c in named])
    result["base_error_before"] = base_error(named, "base_error_before")
    result["base_error_after"] = base_error(named, "base_error_after")
    result["stated_interval_covers"] = coverage(done, "stated_covers")
    if kind == "pair":
        result["exact"] = share(done, lambda c: c["exact"])
        far = [c for c in done if c["truth"]["pair_correlation"] <= 0.7]
        near = [c for c in done if c["truth"]["pair_correlation"] > 0.7]
        result["in_set_if_correlation_low"] = share(far, lambda c: c["in_set"])
        result["in_set_if_correlation_high"] = share(near, lambda c: c["in_set"])
        return result
    result["unexplained"] = share(done, lambda c: c["verdict"] == "unexplained")
    result["first"] = share(named, lambda c: c["first"])
    result["first_in_class"] = share(named, lambda c: c["first_in_class"])
    result["separable"] = share(done, lambda c: c.get("inseparable", None) == 0)
    result["first_if_separable"] = share([c for c in named if c.get("inseparable") == 0], lambda c: c["first"])
    result["mean_inseparable_effects"] = mean([c.get("inseparable") for c in done])
    result["told_interval_covers"] = coverage(done, "told_covers")
    result["told_base_covers"] = coverage(done, "told_base_covers")
    names = sorted({c["truth"]["effects"][0]["name"] for c in done})
    result["by_effect"] = {}
    for n in names:
        own = [c for c in done if c["truth"]["effects"][0]["name"] == n]
        result["by_effect"][n] = {"cases": len(own), "detected": sum(c["detected"] for c in own),
                                  "first": sum(c["first"] for c in own), "in_set": sum(c["in_set"] for c in own)}
    return result


COLUMNS = {
    "none": [("false alarms", "detected")],
    "single": [("detect", "detected"), ("oracle 5%", "oracle_at_5"), ("oracle fam.", "oracle_at_threshold"),
               ("first", "first"), ("class", "first_in_class"), ("separable", "first_if_separable"),
               ("in set", "in_set_if_detected"), ("size", "mean_set_size"), ("unexpl.", "unexplained"), ("ci told", "told_interval_covers"),
               ("ci stated", "stated_interval_covers")],
    "pair": [("detect", "detected"), ("exact", "exact"), ("in set", "in_set"), ("|R|<=0.7", "in_set_if_correlation_low"),
             ("|R|>0.7", "in_set_if_correlation_high"), ("size", "mean_set_size")],
    "outsider": [("detect", "detected"), ("oracle 5%", "oracle_at_5"), ("expl. unmatched", "explained_unmatched"),
                 ("matched", "explained_matched"), ("unknown term", "unknown_term_found"),
                 ("gain, 1 signal", "held_out_gain_one_signal"), ("more", "held_out_gain_more_signals"),
                 ("if unexpl., 1", "held_out_gain_unexplained_one_signal"),
                 ("more", "held_out_gain_unexplained_more_signals")],
}


def cell(value):
    if value is None:
        return "-"
    if isinstance(value, dict):
        return f"{100 * value['share']:.0f} % ({value['hits']}/{value['of']})"
    return f"{value:.2f}"


def print_table(kind, rows):
    columns = COLUMNS[kind]
    lines = [["noise", "size", "cases", "failed"] + [title for title, _ in columns] + ["s/case"]]
    for (noise, size), result in rows.items():
        lines.append([noise, f"{size:g}", str(result["cases"]), str(result["failed"])]
                     + [cell(result.get(key)) for _, key in columns] + [cell(result["seconds_per_case"])])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    print(f"\n{kind}")
    for line in lines:
        print("  " + "  ".join(text.rjust(width) for text, width in zip(line, widths)))
    if kind == "none":
        for (noise, _), result in rows.items():
            low, high = result["detected"]["ci95"] if result["detected"] else (float("nan"),) * 2
            print(f"  {noise}: false alarms, 95 % interval {100 * low:.1f} to {100 * high:.1f} %")


def summarise(cases):
    """Prints the tables and returns them, by kind."""
    summary = {}
    for kind in dict.fromkeys(c["kind"] for c in cases):
        own = [c for c in cases if c["kind"] == kind]
        groups = {}
        for c in own:
            groups.setdefault((c["noise"], 0.0 if kind == "none" else c["size"]), []).append(c)
        rows = {group: tally(kind, groups[group]) for group in sorted(groups)}
        print_table(kind, rows)
        summary[kind] = [{"noise": noise, "size": size, **result} for (noise, size), result in rows.items()]
    return summary


def summarise_by_name(cases):
    """The result for every hidden effect, and up to five reasons why cases failed."""
    for kind in ("single", "outsider"):
        own = [c for c in cases if c["kind"] == kind and "failure" not in c]
        counts = ("noticed, first, in the set", ("detected", "first", "in_set"))
        if kind == "outsider":
            counts = ("noticed, put down to known effects", ("detected", "put_down"))
            for case in own:
                case["put_down"] = case["verdict"] in ("explained", "ambiguous")
        print(f"\n{kind}, by name: cases, {counts[0]}" if own else "")
        for name in sorted({c["truth"]["effects"][0]["name"] for c in own}):
            of = [c for c in own if c["truth"]["effects"][0]["name"] == name]
            print(f"  {name:38s} {len(of):3d} " + " ".join(f"{sum(c[key] for c in of):3d}" for key in counts[1]))
    for failure in sorted({c["failure"] for c in cases if "failure" in c})[:5]:
        print(f"failed: {failure}")

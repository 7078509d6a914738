"""Counts of the coverage study."""
import math
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))
from wilson import wilson  # noqa: E402

QUANTILE = 1.959964
SEARCH_FAILED = 3.84  # of 2 log likelihood, by which the fit is worse than the one that starts at the truth
ON_BOUND = 1e-6       # of the range


def clustered(hits):
    """Wilson interval with the number of intervals divided by the design effect: those of one study share its noise (Kish 1965)."""
    sums = np.array([sum(h) for h in hits.values()], float)
    sizes = np.array([len(h) for h in hits.values()], float)
    n, k = sizes.sum(), len(sizes)
    share = sums.sum() / n
    binomial = share * (1 - share) / n
    if k < 2 or binomial == 0:
        return n, wilson(sums.sum(), n)
    variance = k / (k - 1) * ((sums - share * sizes) ** 2).sum() / n ** 2
    effective = n / max(variance / binomial, 1.0)
    return effective, wilson(share * effective, effective)


def search_failed(one):
    if not one["oracle_cost"] > 0:
        return False
    return one["samples"] * math.log(one["cost"] / one["oracle_cost"]) > SEARCH_FAILED


def inside(p):
    return p["ci95"] is not None and p["ci95"][0] <= p["truth"] <= p["ci95"][1]


def on_bound(p):
    room = ON_BOUND * (p["upper"] - p["lower"])
    return p["value"] <= p["lower"] + room or p["value"] >= p["upper"] - room


def ratio(p):
    """Error over half of the interval's width, in standard deviations."""
    return (p["value"] - p["truth"]) / max((p["ci95"][1] - p["ci95"][0]) / 2 / QUANTILE, 1e-300)


def linear(p, which):
    return abs(p["value"] - p["truth"]) <= QUANTILE * which(p["std_error"], p["std_error_robust"])


def line(title, chosen):
    if not chosen:
        return
    hits = defaultdict(list)
    for seed, p in chosen:
        hits[seed].append(inside(p))
    n, total = len(chosen), sum(map(sum, hits.values()))
    effective, bounds = clustered(hits)
    rms = math.sqrt(np.mean([ratio(p) ** 2 for _, p in chosen]))
    finite = [p for _, p in chosen if p["std_error"] is not None and p["std_error_robust"] is not None]
    share = [100 * np.mean([linear(p, which) for p in finite]) if finite else math.nan
             for which in (lambda a, b: a, lambda a, b: b, max)]
    print(f"  {title:44s} {n:6d} intervals, {100 * total / n:5.1f} % hold the truth (Wilson {100 * bounds[0]:.1f} .. {100 * bounds[1]:.1f}, "
          f"n eff {effective:.0f}); RMS {rms:5.2f}; estimate +- 1.96 errors: plain {share[0]:.1f}, robust {share[1]:.1f}, larger {share[2]:.1f}")


def show(results, names):
    for problem in dict.fromkeys(one["problem"] for one in results):
        ones = [one for one in results if one["problem"] == problem]
        fits = [one for one in ones if "cost" in one]
        failed = [one for one in fits if search_failed(one)]
        print(f"{problem}: {len(fits)} studies ({sum('failure' in o for o in ones)} failed, {sum('impossible' in o for o in ones)} without a "
              f"truth), {len(failed)} searches missed the minimum; {np.median([o['seconds'] for o in fits] or [0]):.1f} s in the median")
        if not fits:
            continue
        everything = [(one["seed"], p) for one in fits for p in one["parameters"]]
        good = [(one["seed"], p) for one in fits if one not in failed for p in one["parameters"]]
        line("all", everything)
        line("search missed the minimum", [(one["seed"], p) for one in failed for p in one["parameters"]])
        line("at the minimum", good)
        for verdict in ("identifiable", "weak", "not_identifiable", "at_bound"):
            line(f"- {verdict}", [(s, p) for s, p in good if p["verdict"] == verdict])
        line("- value on a bound", [(s, p) for s, p in good if on_bound(p)])
        line("- not on a bound", [(s, p) for s, p in good if not on_bound(p)])
        cut = [(s, p) for s, p in good if p["ci95"] and (p["ci95"][0] <= p["lower"] or p["ci95"][1] >= p["upper"])]
        line("- interval cut off at a bound", cut)
        line("- both ends inside", [(s, p) for s, p in good if p["ci95"] and p["ci95"][0] > p["lower"] and p["ci95"][1] < p["upper"]])
        for kind in ("profile", "linear", "none"):
            line(f"- interval: {kind}", [(s, p) for s, p in good if p.get("interval") == kind])
        if names:
            for name in dict.fromkeys(p["name"] for _, p in good):
                line(f"- {name}", [(s, p) for s, p in good if p["name"] == name])

#!/usr/bin/python3
"""Contact whose motion was measured with errors: does the search find the minimum that a fit from the true motion of the foot ends in?

README.md describes the studies. Nothing is hidden in them.

usage: search.py --sinew PATH --from-truth PATH --seeds 3214:3235 [--out RESULTS.json] [--set full_rate=1]
       search.py --report RESULTS.json...
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from run import NAMES, cpu_seconds, draw, load, seeds_of, sinew, synthesize, write_settings

MISSED = 2  # of the cost


def study(options, seed):
    with tempfile.TemporaryDirectory(prefix="search_") as folder:
        folder = Path(folder)
        settings, _ = write_settings(folder)
        truth = draw(seed)
        data, exact, found = folder / "data.h5", folder / "exact.h5", folder / "fit.json"
        synthesize(options, seed, truth, 2, data, 1)
        synthesize(options, seed, truth, 2, exact, 0)
        began = cpu_seconds()
        sinew(options, "identify", "contact", "--data", data, "--config", settings, "--threads", 1, "--quiet", "--intervals", "linear",
              "--out", folder / "fit.h5", "--json", found)
        fit = json.loads(found.read_text())
        used = cpu_seconds() - began
        # The fit from the true motion has the prior that the other one has chosen.
        chosen = {figure["name"]: figure["value"] for figure in fit["figures"]}
        prior = f"correlation_time: {chosen['correlation time']!r}, roughness: {chosen['roughness']!r}"
        settings.write_text(settings.read_text().replace("motion_errors: {", "motion_errors: {" + prior + ", "))
        done = subprocess.run([str(w) for w in (options.from_truth, data, exact, settings, *(truth[n] for n in NAMES))],
                              capture_output=True, text=True, check=True)
        return {"seed": seed, "from_truth": json.loads(done.stdout), "cost": fit["cost"], "stop": fit["stop_test"],
                "cpu": used}


def show(results):
    above = np.array([one["cost"] - one["from_truth"]["cost"] for one in results])
    print(f"{len(results)} studies; from the true motion fits end at {min(o['from_truth']['cost'] for o in results):.0f} to "
          f"{max(o['from_truth']['cost'] for o in results):.0f}; the search ends above them by more than {MISSED} in {np.sum(above > MISSED)} "
          f"({', '.join(f'{a:.0f}' for a in np.sort(above) if a > MISSED) or 'none'}), below by more than that in {np.sum(above < -MISSED)}; "
          f"{np.median([one['cpu'] for one in results]):.1f} s of processor time in the median, {max(one['cpu'] for one in results):.0f} s at most")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--from-truth", type=Path, help="the program motion_from_truth")
    parser.add_argument("--seeds", default="1:5", help="first:last")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="of the synthetic data, such as full_rate=1")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path, nargs="*")
    options = parser.parse_args()
    if options.report:
        show(load(options.report))
        return
    options.sinew = options.sinew.resolve()
    options.from_truth = options.from_truth.resolve()
    results = []
    for seed in seeds_of(options.seeds):
        results.append(study(options, seed))
        one = results[-1]
        print(f"{seed}: {one['cost']:.1f}, from the true motion {one['from_truth']['cost']:.1f}; {one['cpu']:.1f} s; {one['stop']}", flush=True)
        if options.out:
            options.out.write_text(json.dumps(results))
    show(results)


if __name__ == "__main__":
    main()

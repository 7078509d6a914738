#!/usr/bin/python3
"""Do 95 % intervals of `sinew identify` hold the truth? Many studies with truths drawn afresh, through the program.

README.md describes the problems, the truths and the counts.

usage: run.py --sinew PATH --problem contact,drive,nms_rigid_0.3,... --seeds 1:200 [--jobs 1] --out RESULTS.json
       run.py --report RESULTS.json...
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py

sys.path.insert(0, str(Path(__file__).resolve().parent))
import problems  # noqa: E402
import report  # noqa: E402

LONGEST = 900  # [s] of one command


def sinew(program, *words):
    done = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, timeout=LONGEST, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done


def identify(options, case, folder, name, *words):
    found = folder / f"{name}.json"
    began = time.monotonic()
    sinew(options.sinew, "identify", case.problem, "--data", case.data, *case.words, *words, "--threads", 1, "--quiet",
          "--out", folder / f"{name}.h5", "--json", found)
    result = json.loads(found.read_text())
    result["wall"] = time.monotonic() - began
    with h5py.File(folder / f"{name}.h5") as file:
        table = file["uncertainty"]
        result["kinds"] = {n.decode(): k.decode() for n, k in zip(table["name"][:], table["interval"][:])}
    return result


def study(options, name, seed):
    """One study: data, fit with intervals, and a fit that starts at the truth, which tells whether the first one is at the minimum."""
    with tempfile.TemporaryDirectory(prefix="coverage_") as folder:
        folder = Path(folder)
        case = problems.make(name, seed, folder, lambda *words: sinew(options.sinew, *words), options)
        if case is None:
            return {"problem": name, "seed": seed, "impossible": True}
        starts = [word for key, value in case.truth.items() for word in ("--start", f"{key}={value:.17g}")]
        oracle = identify(options, case, folder, "oracle", *starts, "--solver", "lm", "--intervals",
                          options.intervals if options.from_truth else "linear")
        fit = oracle if options.from_truth else identify(options, case, folder, "fit", "--intervals", options.intervals)
        one = {"problem": name, "seed": seed, "cost": fit["cost"], "oracle_cost": oracle["cost"], "samples": case.samples,
               "seconds": fit["wall"], "warnings": fit["warning_facts"], "parameters": []}
        for p in fit["parameters"]:
            if p["name"] in case.truth:
                kept = {k: p.get(k) for k in ("name", "value", "lower", "upper", "std_error", "std_error_robust", "ci95", "verdict")}
                one["parameters"].append({**kept, "truth": case.truth[p["name"]], "interval": fit["kinds"].get(p["name"])})
        return one


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--problem", type=lambda text: text.split(","), default=[])
    parser.add_argument("--seeds", default="1:30", help="first:last")
    parser.add_argument("--intervals", default="profile")
    parser.add_argument("--from-truth", action="store_true",
                        help="the fit starts at the truth: intervals alone, not whether the search finds the minimum; five times faster")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--ceinms", type=Path, default=problems.CEINMS, help="folder of the CEINMS example")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path, nargs="*")
    parser.add_argument("--names", action="store_true", help="a line per parameter, too")
    options = parser.parse_args()
    if options.report:
        report.show([one for path in options.report for one in json.loads(path.read_text())], options.names)
        return
    options.sinew = options.sinew.resolve()
    options.projects = {}
    options.work = Path(tempfile.mkdtemp(prefix="coverage_"))
    first, last = map(int, options.seeds.split(":"))
    results = []

    def run(what):
        try:
            return study(options, *what)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            return {"problem": what[0], "seed": what[1], "failure": str(error)[-600:]}

    with ThreadPoolExecutor(options.jobs) as pool:
        for one in pool.map(run, [(name, seed) for seed in range(first, last + 1) for name in options.problem]):
            results.append(one)
            if "failure" in one:
                print(one["problem"], one["seed"], one["failure"], flush=True)
            if options.out:
                options.out.write_text(json.dumps(results))
    report.show(results, options.names)


if __name__ == "__main__":
    main()

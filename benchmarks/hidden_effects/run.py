#!/usr/bin/python3
"""Hides effects in synthetic data of a driven joint, runs the diagnosis on the files, and counts.

Each case: hidden_effects_generate makes a data file without a label and the truth beside it; `sinew diagnose drive` sees the
data only; its JSON is compared with the truth. README.md describes the counts and the limits of any method.

usage: run.py --sinew PATH --generate PATH [--kind none,single,pair,outsider] [--cases 100] [--sizes 1,1.5,2,3,6]
              [--noise white,ar] [--experiment multisine] [--effect NAME] [--jobs 2] [--first-seed 1] [--out results.json [--resume]]
       run.py --merge results.json...
"""
import argparse
import json
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from counting import base_covered, compare, covered, intervals, read, run, summarise
from studies import diagnose, numbers, words


def study(options, number, kind, size, noise, seed):
    """One case; returns the truth, the result and their comparison."""
    case = {"kind": kind, "size": size, "noise": noise, "seed": seed}
    with tempfile.TemporaryDirectory(prefix="hidden_effects_") as folder:
        folder = Path(folder)
        data, truth_file = folder / f"case_{number:05d}.h5", folder / "truth.json"
        words = [options.generate, "--kind", kind, "--seed", seed, "--size", size, "--noise", noise, "--experiment",
                 options.experiment, "--out", data, "--truth", truth_file]
        if options.no_correlations:
            words.append("--no-correlations")
        if kind not in ("none",):
            words += [w for effect in options.effect for w in ("--effect", effect)]
        status, case["generate_seconds"], message = run(*words)
        if status != 0:
            raise SystemExit(message)
        truth = read(truth_file)
        case["truth"] = truth
        try:
            found, case["seconds"] = diagnose(options, "drive", data, folder, "--seed", options.program_seed)
        except ValueError as error:
            case["failure"] = str(error)
            return case
        compare(case, truth, found)
        if kind == "single" and not options.no_coverage:
            name = truth["effects"][0]["name"]
            told = folder / "told.json"
            status, case["told_seconds"], message = run(options.sinew, "identify", "drive", "--data", data, "--out",
                                                        folder / "told.h5", "--release", name, "--json", told,
                                                        "--threads", 1, "--quiet")
            result = read(told)
            if result is None:
                case["told_failure"] = message
            else:
                case["told_covers"] = covered(truth, intervals(result["parameters"]))
                case["told_base_covers"] = base_covered(truth, intervals(result["parameters"]))
    return case


class Kept:
    """The cases that have ended, a line each in a file beside the results, until these are written."""

    def __init__(self, options):
        self.path = options.out.with_name(options.out.name + ".cases") if options.out else None
        self.lock = threading.Lock()
        self.cases = {}
        # What a case follows from, besides its kind, size, noise and seed.
        settings = {"effect": options.effect, "experiment": options.experiment, "program_seed": options.program_seed,
                    "no_coverage": options.no_coverage, "no_correlations": options.no_correlations}
        if self.path is None:
            return
        if options.resume and self.path.exists():
            lines = [line for line in self.path.read_text().split("\n")[:-1]]  # one that was cut off is none
            if not lines or json.loads(lines[0]) != settings:
                raise SystemExit(f"{self.path} was made with other settings: {lines[0] if lines else 'none'}")
            self.cases = {self.key(**case): case for case in map(json.loads, lines[1:])}
            self.path.write_text("".join(line + "\n" for line in lines))
        else:
            self.path.write_text(json.dumps(settings) + "\n")

    @staticmethod
    def key(kind, size, noise, seed, **_):
        return kind, size, noise, seed

    def study(self, options, number, *what):
        known = self.cases.get(what)
        if known is not None:
            return known
        case = study(options, number, *what)
        if self.path is not None:
            with self.lock, self.path.open("a") as file:
                file.write(json.dumps(case) + "\n")
        return case

    def remove(self):
        if self.path is not None:
            self.path.unlink()


def run_all(options, plan, kept):
    with ThreadPoolExecutor(options.jobs) as pool:
        # A size of 0 is for the table only: the generator ignores it where nothing is hidden.
        tasks = [pool.submit(kept.study, options, n, kind, size or 1.0, noise, seed)
                 for n, (kind, size, noise, seed) in enumerate(plan)]
        cases = []
        for task in tasks:
            cases.append(task.result())
            if sys.stderr.isatty():
                print(f"\r{len(cases)} of {len(plan)}", end="", file=sys.stderr)
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--generate", type=Path, help="hidden_effects_generate")
    parser.add_argument("--kind", type=words, default=["none", "single"], help="of none,single,pair,outsider")
    parser.add_argument("--cases", type=int, default=100, help="per kind, size and noise")
    parser.add_argument("--sizes", type=numbers, default=[2.0], help="in units of what an oracle just detects")
    parser.add_argument("--noise", type=words, default=["white"], help="of white,ar,other")
    parser.add_argument("--experiment", choices=["multisine", "trapezoid", "over_the_top", "cascade"], default="multisine")
    parser.add_argument("--effect", action="append", default=[], help="hide this one instead of drawing")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=1, help="cases of one seed share joint and motion")
    parser.add_argument("--program-seed", type=int, default=1, help="--seed of the diagnosis")
    parser.add_argument("--no-coverage", action="store_true", help="without the fit that is told the true effect")
    parser.add_argument("--no-correlations", action="store_true", help="without the count `separable`, which needs them")
    parser.add_argument("--merge", type=Path, nargs="+", help="no new cases: the tables of these results together")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--resume", action="store_true", help="go on with what a run that was stopped has kept beside --out")
    options = parser.parse_args()
    if options.resume and not options.out:
        parser.error("--resume needs --out")

    plan = [(kind, size, noise, options.first_seed + i)
            for kind in options.kind for noise in options.noise
            for size in (options.sizes if kind != "none" else [0.0]) for i in range(options.cases)]
    begin = time.monotonic()
    if options.merge:
        cases = [case for path in options.merge for case in json.loads(path.read_text())["cases"]]
    else:
        if not options.sinew or not options.generate:
            parser.error("--sinew and --generate are needed")
        options.sinew, options.generate = options.sinew.resolve(), options.generate.resolve()
        kept = Kept(options)
        cases = run_all(options, plan, kept)
    summary = summarise(cases)
    for failure in sorted({c["failure"] for c in cases if "failure" in c})[:5]:
        print(f"failed: {failure}")
    print(f"\n{len(cases)} cases" + ("" if options.merge else f" in {time.monotonic() - begin:.0f} s"))
    if options.out:
        settings = {k: [str(w) for w in v] if k == "merge" and v else str(v) if isinstance(v, Path) else v
                    for k, v in vars(options).items()}
        options.out.write_text(json.dumps({"schema": "sinew.hidden_effects/1", "settings": settings,
                                           "summary": summary, "cases": cases}, indent=1))
        if not options.merge:
            kept.remove()


if __name__ == "__main__":
    main()

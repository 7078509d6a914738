"""Studies of hidden effects whose data the program itself synthesizes: their command line, their cases, and the commands of one case."""
import argparse
import json
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from counting import read, run, summarise, summarise_by_name


def numbers(text):
    return [float(word) for word in text.split(",")]


def words(text):
    return text.split(",")


def study_parser(about, detector):
    """The command-line arguments of a study whose cases the program itself synthesizes."""
    parser = argparse.ArgumentParser(description=about.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--kind", type=words, default=["none", "single"], help="of none,single,outsider; for the muscles also further")
    parser.add_argument("--cases", type=int, default=100, help="per kind and size")
    parser.add_argument("--sizes", type=numbers, default=[2.0], help=f"in units of what {detector} just detects")
    parser.add_argument("--effect", action="append", default=[], help="hide this one instead of drawing")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--merge", type=Path, nargs="+", help="no new cases: the tables of these results together")
    parser.add_argument("--out", type=Path)
    return parser


def run_studies(parser, options, name, study, prepare=None):
    """The cases of a study, or those of earlier results, written and counted.

    @param study(options, kind, size, seed): one case. @param prepare(options, plan): what all cases need.
    """
    begin = time.monotonic()
    if options.merge:
        cases = [case for path in options.merge for case in json.loads(path.read_text())["cases"]]
    else:
        if not options.sinew:
            parser.error("--sinew is needed")
        options.sinew = options.sinew.resolve()
        plan = [(kind, size, options.first_seed + i) for kind in options.kind
                for size in (options.sizes if kind != "none" else [0.0]) for i in range(options.cases)]
        if prepare:
            prepare(options, plan)
        with ThreadPoolExecutor(options.jobs) as pool:
            cases = list(pool.map(lambda words: study(options, *words), plan))
    if options.out:
        options.out.write_text(json.dumps({"schema": f"sinew.{name}/1", "cases": cases}, indent=1))
    summarise(cases)
    summarise_by_name(cases)
    print(f"\n{len(cases)} cases" + ("" if options.merge else f" in {time.monotonic() - begin:.0f} s"))


def synthesize(options, problem, seed, words, out):
    """A data set with an effect among `words`. Raises ValueError with the message of the program."""
    status, _, message = run(options.sinew, "data", "synthesize", problem, "--seed", seed, *words, "--out", out, "--quiet")
    if status != 0:
        raise ValueError(message)


def diagnose(options, problem, data, folder, *words):
    """The answer of a diagnosis and its seconds. Raises ValueError with the message of the program."""
    answer = folder / "found.json"
    answer.unlink(missing_ok=True)
    status, seconds, message = run(options.sinew, "diagnose", problem, "--data", data, "--out", folder / "found.h5", "--json", answer,
                                   "--threads", 1, "--quiet", *words)
    found = read(answer)
    if found is None:
        raise ValueError(message or f"exit status {status}")
    return found, seconds

"""A diagnosis of one drawn case, and the command line of studies of several."""
import argparse
import json
import resource
import subprocess
import tempfile
from pathlib import Path

from wilson import wilson

LONGEST = 900  # [s] of one diagnosis


def diagnose(sinew, write):
    """The JSON of `sinew diagnose drive` on data that write(path) makes, and its processor time [s]; None if it does not end in LONGEST."""
    with tempfile.TemporaryDirectory() as folder:
        data, found = Path(folder) / "case.h5", Path(folder) / "found.json"
        write(data)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        words = [sinew, "diagnose", "drive", "--data", data, "--threads", "1", "--quiet", "--out", Path(folder) / "why.h5", "--json", found]
        try:
            done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=LONGEST, check=False)
        except subprocess.TimeoutExpired:
            return None, LONGEST
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{done.stdout}{done.stderr}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return json.loads(found.read_text()), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def inside(answer, truths):
    """Of the parameters of the extended model whose true values are given: does the 95 % interval contain them? One at a bound has none."""
    intervals = {p["name"]: p["ci95"] for p in answer["extended_parameters"]}
    return {name: intervals[name] is not None and intervals[name][0] <= truth <= intervals[name][1]
            for name, truth in truths.items() if name in intervals}


def share(hits, count):
    low, high = wilson(hits, count)
    return f"{hits} of {count} ({100 * low:.0f}-{100 * high:.0f} %)"


def report_common(cases):
    kept = [value for case in cases for value in case.get("inside", {}).values()]
    print("parameters in their 95 % intervals:", share(sum(kept), len(kept)))
    seconds = sorted(c["seconds"] for c in cases)
    print(f"CPU seconds: median {seconds[len(seconds) // 2]:.0f}, most {seconds[-1]:.0f}")


def study(doc, flag, flag_help, examine, report):
    """--sinew, --seeds, --out, --report, --each and one flag. @param examine (sinew, seed, flag) to a case @param report of cases"""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", help="first:last")
    parser.add_argument(flag, action="store_true", dest="flag", help=flag_help)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path)
    parser.add_argument("--each", action="store_true", help="a line per case")
    options = parser.parse_args()
    if options.report:
        cases = json.loads(options.report.read_text())
        for case in cases if options.each else ():
            print(json.dumps(case))
        report(cases)
        return
    first, last = map(int, options.seeds.split(":"))
    cases = []
    for seed in range(first, last + 1):
        cases.append(examine(options.sinew, seed, options.flag))
        options.out.write_text(json.dumps(cases, indent=1))
        print(seed, cases[-1]["verdict"], cases[-1].get("causes", ""), flush=True)
    report(cases)

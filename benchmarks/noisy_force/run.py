#!/usr/bin/python3
"""Does a diagnosis take noise of a recorded force for a misfit of the model? README.md describes the cases.

usage: run.py --sinew PATH --seeds 100:119 [--friction] --out RESULTS.json
       run.py --report RESULTS.json [--each]
"""
import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import axes  # noqa: E402
from wilson import wilson  # noqa: E402

LONGEST = 900  # [s] of one diagnosis
# What says the same: dry friction by direction has the equal one as a special case.
FRICTION = {"coulomb_friction": ["coulomb_torque"], "asymmetric_friction": ["forward_friction", "backward_friction"]}


def examine(sinew, seed, friction):
    axis = axes.draw_axis(seed, friction)
    case = {"seed": seed, "friction": axis.coulomb, "noise_share": axis.force_noise / axis.force, "samples": sum(len(r[0]) for r in axis.records)}
    with tempfile.TemporaryDirectory() as folder:
        data, found = Path(folder) / "case.h5", Path(folder) / "found.json"
        axes.write(axis, data)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        words = [sinew, "diagnose", "drive", "--data", data, "--threads", "1", "--quiet", "--out", Path(folder) / "why.h5", "--json", found]
        try:
            done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=LONGEST, check=False)
        except subprocess.TimeoutExpired:
            return {**case, "verdict": "not ended"}
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{done.stdout}{done.stderr}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        answer = json.loads(found.read_text())
    case["seconds"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    case["verdict"] = answer["verdict"]
    case["causes"] = [cause["effect"] for cause in answer["causes"]]
    values = {p["name"]: p for p in answer["extended_parameters"]}
    truths = {"inertia": axis.mass, "viscous_friction": axis.viscous}
    for effect in set(case["causes"]) & set(FRICTION):
        truths.update({name: axis.coulomb for name in FRICTION[effect]})
    case["inside"] = {name: values[name]["ci95"][0] <= truth <= values[name]["ci95"][1] for name, truth in truths.items() if name in values}
    return case


def share(hits, count):
    low, high = wilson(hits, count)
    return f"{hits} of {count} ({100 * low:.0f}-{100 * high:.0f} %)"


def report(cases, each):
    for case in cases if each else ():
        print(json.dumps(case))
    clean, hidden = [c for c in cases if not c["friction"]], [c for c in cases if c["friction"]]
    if clean:
        print("nothing hidden, adequate:", share(sum(c["verdict"] == "adequate" for c in clean), len(clean)))
    if hidden:
        named = [c for c in hidden if set(c.get("causes", [])) & set(FRICTION)]
        print("friction hidden, named:", share(len(named), len(hidden)))
        print("... and nothing else:", share(sum(len(c["causes"]) == 1 for c in named), len(hidden)))
    inside = [value for case in cases for value in case.get("inside", {}).values()]
    print("parameters in their 95 % intervals:", share(sum(inside), len(inside)))
    seconds = sorted(c["seconds"] for c in cases if "seconds" in c)
    if seconds:
        print(f"CPU seconds: median {seconds[len(seconds) // 2]:.0f}, most {seconds[-1]:.0f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", help="first:last")
    parser.add_argument("--friction", action="store_true", help="dry friction of 0.3 of the force's root mean square is hidden")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path)
    parser.add_argument("--each", action="store_true", help="a line per case")
    options = parser.parse_args()
    if options.report:
        report(json.loads(options.report.read_text()), options.each)
        return
    first, last = map(int, options.seeds.split(":"))
    cases = []
    for seed in range(first, last + 1):
        cases.append(examine(options.sinew, seed, options.friction))
        options.out.write_text(json.dumps(cases, indent=1))
        print(seed, cases[-1]["verdict"], cases[-1].get("causes", ""), flush=True)
    report(cases, False)


if __name__ == "__main__":
    main()

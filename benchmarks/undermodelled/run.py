#!/usr/bin/python3
"""Is a recording called adequate whose model lacks something? README.md describes the cases and the counts.

usage: run.py --sinew PATH --tank PATH --seeds 1:200 [--nothing] [--jobs 1] --out RESULTS.json [--resume]
       run.py --report RESULTS.json [--each]
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import cases  # noqa: E402

LONGEST = 1800     # [s] of one command
NO_STRUCTURE = 0.03  # noise, as a share of the signal's deviation, where the model lacks nothing


def program(options, case, *words):
    command = [options.sinew, words[0], "drive", *words[1:]] if case.problem == "drive" else [options.tank, *words]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=LONGEST, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")


def structure(options, case, folder):
    """[unit] Deviation of what the base model cannot follow: the fit to the reading without noise."""
    cases.write(case, folder / "clean.h5", case.clean, None)
    program(options, case, "identify", "--data", folder / "clean.h5", "--intervals", "linear", "--threads", options.threads, "--quiet", "--out",
            folder / "fit.h5", "--json", folder / "fit.json")
    return json.loads((folder / "fit.json").read_text())["fit"][0]["rmse"]


def study(options, seed):
    case = cases.draw_case(seed, options.nothing)
    result = {"seed": seed, "problem": case.problem, "lacks": case.lacks, "noise": case.noise, "stated": case.stated,
              "samples": len(case.time), **case.values}
    with tempfile.TemporaryDirectory(prefix="undermodelled_") as folder:
        folder = Path(folder)
        try:
            if case.lacks:
                result["structure"] = structure(options, case, folder)
                deviation = result["structure"] / case.ratio
            else:
                deviation = NO_STRUCTURE * case.signal / case.ratio
            values = cases.reading(case, deviation)
            result["deviation"] = float((values - case.clean).std())
            result["ratio"] = result.get("structure", 0) / result["deviation"]
            cases.write(case, folder / "data.h5", values, result["deviation"] if case.stated else None)
            if options.keep:
                cases.write(case, Path(options.keep) / f"{seed}.h5", values, result["deviation"] if case.stated else None)
            began = time.monotonic()
            program(options, case, "diagnose", "--data", folder / "data.h5", "--threads", options.threads, "--quiet", "--out",
                    folder / "why.h5", "--json", folder / "why.json")
            d = json.loads((folder / "why.json").read_text())
            result.update(verdict=d["verdict"], p=d["family_p_value"], causes=[c["effect"] for c in d["causes"]],
                          unknown_terms=[t.get("name", "") for t in d["unknown_terms"]], seconds=time.monotonic() - began,
                          cross_validated=bool(d["left_out"]), rmse=d["base"]["fit"][0]["rmse"] if d["base"].get("fit") else None)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            result["error"] = str(error)[-2000:]
    return result


def tell(results, each):
    if each:
        for r in results:
            print(f"{r['seed']:4d} {r['problem']:5s} {r['lacks']:10s} {r['noise']:8s} {'stated' if r['stated'] else '      '} "
                  f"{r['samples']:6d} at {r['rate']:6.4g} Hz, structure {r.get('ratio', 0):5.2f} x noise, "
                  + (r["error"][-200:] if "error" in r else
                     f"{r['verdict']}, p = {r['p']:.3g}{', cross-validated' if r['cross_validated'] else ''}, {r['seconds']:.0f} s: "
                     f"{', '.join(r['causes'])} {', '.join(r['unknown_terms'])}"))
    done = [r for r in results if "error" not in r]
    print(f"{len(results)} cases, {len(results) - len(done)} failed")
    groups = [("all", done)]
    groups += [(f"structure {low} to {high} times the noise", [r for r in done if low <= r["ratio"] < high])
               for low, high in ((1, 2), (2, 5), (5, 10), (10, 1000))]
    groups += [(noise, [r for r in done if r["noise"] == noise]) for noise in ("white", "rounded", "filtered", "ar")]
    groups += [(title, [r for r in done if r["stated"] == stated]) for title, stated in (("stated", True), ("not stated", False))]
    for title, some in groups:
        if some:
            print(f"{title}: adequate {sum(r['verdict'] == 'adequate' for r in some)} of {len(some)}")
    if done:
        print(f"seconds: median {sorted(r['seconds'] for r in done)[len(done) // 2]:.0f}, longest {max(r['seconds'] for r in done):.0f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew")
    parser.add_argument("--tank", help="the program of docs/examples/outside/tank.cpp")
    parser.add_argument("--seeds", default="1:200")
    parser.add_argument("--nothing", action="store_true", help="the same joints and tanks, but the model lacks nothing")
    parser.add_argument("--keep", help="folder for the data sets")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--report")
    parser.add_argument("--each", action="store_true")
    options = parser.parse_args()
    if options.report:
        tell(json.loads(Path(options.report).read_text()), options.each)
        return
    first, last = map(int, options.seeds.split(":"))
    results = json.loads(Path(options.out).read_text()) if options.resume and Path(options.out).exists() else []
    known = {r["seed"] for r in results}
    with ThreadPoolExecutor(options.jobs) as pool:
        for result in pool.map(lambda seed: study(options, seed), [s for s in range(first, last + 1) if s not in known]):
            results.append(result)
            Path(options.out).write_text(json.dumps(results, indent=1))
    tell(results, options.each)


if __name__ == "__main__":
    main()

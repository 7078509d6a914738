#!/usr/bin/python3
"""Several things wrong at once: does `sinew diagnose` predict trials that were not fitted as well as a fit of the true causes does, and
does it name them? README.md describes the cases and the counts.

usage: run.py --sinew PATH --seeds 1:40 [--jobs 1] [--threads 1] [--reuse ORACLES.json] --out RESULTS.json [--resume]
       run.py --report RESULTS.json
"""
import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import cases  # noqa: E402

LONGEST = 3600  # [s] of one command
MATTERS = 1.1   # growth of the oracle's held-out error without an effect


def sinew(program, *words):
    done = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, timeout=LONGEST, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"sinew {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done


def held_out(table):
    return next((row["rmse"] for row in table if row["role"] == "validate" and row["channel"] == "position"), math.nan)


def fit(options, data, folder, effects):
    """Held-out error and base parameters of a fit with these effects released."""
    found = folder / "fit.json"
    release = ["--release", ",".join(effects)] if effects else []
    sinew(options.sinew, "identify", "drive", "--data", data, *release, "--intervals", "linear", "--threads", options.threads, "--quiet",
          "--out", folder / "fit.h5", "--json", found)
    result = json.loads(found.read_text())
    return held_out(result["fit"]), {p["name"]: p["value"] for p in result["parameters"]}


def oracle(options, case, data, folder):
    """The fit that is told the true effects; which of them matter."""
    names = list(case.effects)
    error, _ = fit(options, data, folder, names)
    without = {name: fit(options, data, folder, [n for n in names if n != name])[0] for name in names}
    return {"held_out": error, "without": without, "matters": [name for name in names if without[name] > MATTERS * error]}


def diagnose(options, data, folder):
    found = folder / "why.json"
    began = time.monotonic()
    sinew(options.sinew, "diagnose", "drive", "--data", data, "--threads", options.threads, "--seed", options.program_seed, "--quiet",
          "--out", folder / "why.h5", "--json", found)
    d = json.loads(found.read_text())
    noise = 0.0
    return {"verdict": d["verdict"], "causes": [c["effect"] for c in d["causes"]], "seconds": time.monotonic() - began,
            "alternatives": [[a["instead_of"], a["effect"]] for a in d["alternatives"]], "held_out": held_out(d["extended_fit"]),
            "chosen_shares": {one["effect"]: one["share"] for one in d["chosen_shares"]},
            "ladder": [[step["effects"], step["error"]] for step in d["ladder"]],
            "unknown_terms": len(d["unknown_terms"]), "cross_validated": bool(d["left_out"]), "noise": noise,
            "base": {p["name"]: {"value": p["value"], "ci95": p.get("ci95")} for p in d["extended_parameters"]},
            "base_held_out": held_out(d["base"]["fit"]) if "fit" in d["base"] else math.nan}


def study(options, seed, oracles):
    case = cases.draw_case(seed)
    result = {"seed": seed, "settings": case.settings, "effects": case.effects, "outsider": case.outsider}
    with tempfile.TemporaryDirectory(prefix="large_misfit_") as folder:
        folder = Path(folder)
        data = folder / "case.h5"
        try:
            sinew(options.sinew, "data", "synthesize", "drive", *case.words(), "--out", data, "--quiet")
            result["oracle"] = oracles.get(seed) or oracle(options, case, data, folder)
            result["diagnosis"] = diagnose(options, data, folder)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            result["error"] = str(error)[-2000:]
    return result


def count(results):
    """One judged case each: what was named, and how well held-out trials are predicted."""
    judged = []
    for r in results:
        if "error" in r:
            continue
        d, o = r["diagnosis"], r["oracle"]
        stated = set(d["causes"]) | {other for _, other in d["alternatives"]}
        matters = o["matters"]
        base = {name: d["base"][name]["ci95"] for name in ("inertia", "viscous_friction", "gravity_torque") if name in d["base"]}
        judged.append({
            "seed": r["seed"], "single": r["settings"]["train"] == 1, "outsider": next(iter(r["outsider"]), ""),
            "ratio": d["held_out"] / o["held_out"], "matter": len(matters),
            "recalled": sum(bool(cases.class_of(name) & stated) for name in matters),
            "named": len(d["causes"]),
            "right": sum(any(name in cases.class_of(true) for true in r["effects"]) for name in d["causes"]),
            "contained": sum(ci is not None and ci[0] <= r["settings"][name] <= ci[1] for name, ci in base.items()), "base": len(base),
            "verdict": d["verdict"], "seconds": d["seconds"],
            "explained_away": bool(r["outsider"]) and d["verdict"] in ("explained", "ambiguous", "adequate")})
    return judged


def share(found, of):
    return f"{found} of {of} ({100 * found / of:.0f} %)" if of else "-"


def tell(results, each):
    judged = count(results)
    print(f"{len(results)} cases, {len(results) - len(judged)} failed")
    for title, some in (("all", judged), ("several trials", [j for j in judged if not j["single"]]),
                        ("one trial", [j for j in judged if j["single"]]), ("no outsider", [j for j in judged if not j["outsider"]])):
        total = lambda key: sum(j[key] for j in some)  # noqa: E731
        if not some:
            continue
        print(f"{title}: held-out error at most 1.2 x the oracle's in {share(sum(j['ratio'] <= 1.2 for j in some), len(some))}; "
              f"effects that matter in the stated set {share(total('recalled'), total('matter'))}; "
              f"named causes true {share(total('right'), total('named'))}; "
              f"base parameters in their intervals {share(total('contained'), total('base'))}; "
              f"median {sorted(j['seconds'] for j in some)[len(some) // 2]:.0f} s")
    outside = [j for j in judged if j["outsider"]]
    print(f"outsiders explained away: {share(total_of(outside, 'explained_away'), len(outside))}")
    if each:
        by_seed = {r["seed"]: r for r in results}
        for j in judged:
            r = by_seed[j["seed"]]
            print(f"{j['seed']:5d} {'1' if j['single'] else r['settings']['train']} trials, {r['settings']['rate']} Hz, "
                  f"{'closed' if r['settings']['excitation'] else 'open'}, ratio {j['ratio']:.2f}, {j['verdict']}, {j['seconds']:.0f} s: "
                  f"true {', '.join(n + ('' if n in r['oracle']['matters'] else ' (small)') for n in r['effects'])}"
                  f"{' + ' + j['outsider'] if j['outsider'] else ''}; named {', '.join(r['diagnosis']['causes'])}; "
                  f"or {', '.join('/'.join(a) for a in r['diagnosis']['alternatives'])}")
    for r in results:
        if "error" in r:
            print(f"{r['seed']}: {r['error'][-300:]}")


def total_of(some, key):
    return sum(j[key] for j in some)


def write_whole(path, text):
    """Whoever stops this finds the old file or the new one."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def study_all(options, seeds, study_one, answer_of):
    """The results of all seeds, written to --out after each; with --resume those that it has are not done again."""
    done = {r["seed"]: r for r in json.loads(options.out.read_text())} if options.resume and options.out.exists() else {}
    results = []
    with ThreadPoolExecutor(options.jobs) as pool:
        for result in pool.map(lambda seed: done.get(seed) or study_one(seed), seeds):
            results.append(result)
            # What an earlier run has found of later seeds stays until these are reached.
            later = [r for seed, r in sorted(done.items()) if seed > result["seed"]]
            write_whole(options.out, json.dumps(results + later, indent=1))
            print(result["seed"], result.get("error", "")[-200:] or answer_of(result)["causes"], flush=True)
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--seeds", default="1:40", help="first:last")
    parser.add_argument("--program-seed", type=int, default=1, help="of the diagnosis")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--reuse", type=Path, help="results whose oracles are taken over")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--resume", action="store_true", help="without the seeds that --out has already")
    parser.add_argument("--report", type=Path)
    parser.add_argument("--each", action="store_true", help="a line per case")
    options = parser.parse_args()
    if options.report:
        tell(json.loads(options.report.read_text()), options.each)
        return
    first, last = map(int, options.seeds.split(":"))
    oracles = {r["seed"]: r["oracle"] for r in json.loads(options.reuse.read_text()) if "oracle" in r} if options.reuse else {}
    results = study_all(options, range(first, last + 1), lambda seed: study(options, seed, oracles), lambda r: r["diagnosis"])
    tell(results, options.each)


if __name__ == "__main__":
    main()

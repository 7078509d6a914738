#!/usr/bin/python3
"""Machines with one or few long, finely sampled records: does the diagnosis name what is wrong, predict records that were not fitted, and
say `unexplained` only where something is left? README.md describes the cases and the counts.

usage: run.py --sinew PATH [--two-tanks PATH] [--axes 1:8] [--tanks 1:8] [--reuse RESULTS.json] --out RESULTS.json
       run.py --report RESULTS.json [--each]
"""
import argparse
import dataclasses
import json
import math
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import axes  # noqa: E402
import tanks  # noqa: E402

AXES = {"axis": axes.draw_axis, "rippled axis": axes.draw_rippled_axis}
LONGEST = 3000  # [s] of one command
MATTERS = 1.1   # growth of the oracle's held-out error without an effect
# A name stands for all that nothing which is measured here tells from it.
STANDS_FOR = {
    "coulomb_friction": {"asymmetric_friction"},  # dry friction by direction is the sum of it and an offset
    "torque_offset": {"asymmetric_friction", "force.offset", "reference.offset", "position.offset"},
    "hold": {"command_delay", "force.time_offset", "position.time_offset", "position.low_pass", "force.low_pass"},
}


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Case:
    """A machine, its data file and the program that fits it."""

    def __init__(self, options, kind, seed, folder):
        self.kind, self.seed, self.folder = kind, seed, folder
        self.data = folder / "case.h5"
        if kind in AXES:
            self.machine = AXES[kind](seed)
            axes.write(self.machine, self.data)
            (folder / "drive.yaml").write_text(self.machine.settings())
            self.program, self.model, self.channel = options.sinew, ["drive"], "position"
            self.config = ["--config", folder / "drive.yaml"]
        else:
            self.machine = tanks.draw_tanks(seed)
            tanks.write(self.machine, self.data)
            self.program, self.model, self.channel, self.config = options.two_tanks, [], "level", []

    def run(self, command, *words):
        found = self.folder / "found.json"
        words = [self.program, command, *self.model, "--data", self.data, *self.config, *words, "--threads", 1, "--quiet", "--out",
                 self.folder / "out.h5", "--json", found]
        done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=LONGEST, check=False)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
        return json.loads(found.read_text())

    def error(self, table, role):
        return next((row["rmse"] for row in table if row["role"] == role and row["channel"] == self.channel), math.nan)

    def oracle_error(self, effects):
        """Of a fit that is told the effects: of the held-out record, and of the fitted ones."""
        release = ["--release", ",".join(effects)] if effects else []
        fit = self.run("identify", *release, "--intervals", "linear")["fit"]
        return self.error(fit, "validate"), self.error(fit, "train")

    def oracle(self, matters):
        names = list(self.machine.truth())
        held_out, fitted = self.oracle_error(names)
        if not matters:
            return {"held_out": held_out, "fitted": fitted, "matters": names}
        without = {name: self.oracle_error([n for n in names if n != name])[0] for name in names}
        return {"held_out": held_out, "fitted": fitted, "without": without, "base_held_out": self.oracle_error([])[0],
                "matters": [name for name in names if without[name] > MATTERS * held_out]}

    def diagnose(self, program_seed):
        began = cpu_seconds()
        d = self.run("diagnose", "--seed", program_seed)
        return {"verdict": d["verdict"], "causes": [c["effect"] for c in d["causes"]], "cpu_seconds": cpu_seconds() - began,
                "alternatives": [[a["instead_of"], a["effect"]] for a in d["alternatives"]],
                "withdrawn": [w["effect"] for w in d["withdrawn"]], "cross_validated": bool(d["left_out"]),
                "unknown": [[t["name"], t["held_out_reduction"]] for t in d["unknown_terms"]],
                "held_out": self.error(d["extended_fit"], "validate"), "fitted": self.error(d["extended_fit"], "train"),
                "warnings": [w["kind"] for w in d["warning_facts"]],
                "base": {p["name"]: {"value": p["value"], "ci95": p.get("ci95")} for p in d["extended_parameters"]}}


def study(options, kind, seed, oracles):
    with tempfile.TemporaryDirectory(prefix="long_record_") as folder:
        case = Case(options, kind, seed, Path(folder))
        result = {"kind": kind, "seed": seed, "machine": dataclasses.asdict(case.machine), "effects": case.machine.truth(),
                  "outsider": list(getattr(case.machine, "outsider", {})), "true_base": case.machine.base()}
        try:
            if not options.no_oracle:
                result["oracle"] = oracles.get((kind, seed)) or case.oracle(not options.all_matter)
            result["diagnosis"] = case.diagnose(options.program_seed)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            result["error"] = str(error)[-2000:]
    return result


def judge(r):
    d, o = r["diagnosis"], r.get("oracle", {"held_out": math.nan, "matters": []})
    stated = set(d["causes"]) | {other for _, other in d["alternatives"]}
    true = {name: {name} | STANDS_FOR.get(name, set()) for name in r["effects"]}
    if r["machine"]["resolution"]:
        true["quantisation"] = {"position.quantisation", "level.quantisation"}
    base = {name: d["base"][name]["ci95"] for name in r["true_base"] if name in d["base"]}
    noise = math.hypot(r["machine"]["noise"], r["machine"]["resolution"] / math.sqrt(12))
    return {"ratio": d["held_out"] / o["held_out"], "matter": len(o["matters"]),
            "recalled": sum(bool(true[name] & stated) for name in o["matters"]),
            "missed": [name for name in o["matters"] if not true[name] & stated], "named": len(d["causes"]),
            "right": sum(any(name in one for one in true.values()) for name in d["causes"]), "base": len(base),
            "contained": sum(ci is not None and ci[0] <= r["true_base"][name] <= ci[1] for name, ci in base.items()),
            "left": d["fitted"] / noise, "noise": noise}


def share(found, of):
    return f"{found} of {of} ({100 * found / of:.0f} %)" if of else "-"


def tell(results, each):
    done = [(r, judge(r)) for r in results if "error" not in r]
    print(f"{len(results)} cases, {len(results) - len(done)} failed")
    groups = {"axes": lambda r: r["kind"] == "axis", "axes, open loop": lambda r: r["kind"] == "axis" and not r["machine"]["closed"],
              "axes, closed loop": lambda r: r["kind"] == "axis" and r["machine"]["closed"],
              "axes with a fine ripple": lambda r: r["kind"] == "rippled axis",
              "tanks": lambda r: r["kind"] == "tanks" and not r["outsider"],
              "tanks, outsider": lambda r: r["kind"] == "tanks" and r["outsider"]}
    for title, wanted in groups.items():
        some = [(r, j) for r, j in done if wanted(r)]
        if not some:
            continue
        total = lambda key: sum(j[key] for _, j in some)  # noqa: E731
        verdicts = [r["diagnosis"]["verdict"] for r, _ in some]
        seconds = sorted(r["diagnosis"]["cpu_seconds"] for r, _ in some)
        print(f"{title} ({len(some)}): held-out error at most 1.2 x the oracle's in {share(sum(j['ratio'] <= 1.2 for _, j in some), len(some))}; "
              f"effects that matter in the stated set {share(total('recalled'), total('matter'))}; "
              f"named causes true {share(total('right'), total('named'))}; "
              f"base parameters in their intervals {share(total('contained'), total('base'))}; verdicts "
              f"{', '.join(f'{v} {verdicts.count(v)}' for v in sorted(set(verdicts)))}; CPU seconds median {seconds[len(seconds) // 2]:.0f}, "
              f"most {seconds[-1]:.0f}")
    if each:
        for r, j in done:
            d, m = r["diagnosis"], r["machine"]
            what = f"{m['trials']} x {m['duration']:.0f} s, {m['rate']:.0f} Hz, {'closed' if m['closed'] else 'open'}" \
                if r["kind"] in AXES else f"{m['records']} x {m['samples']} samples, {m['interval']:.0f} s"
            missing = f", missing {', '.join(j['missed'])}" if j["missed"] else ""
            beside = f" + {r['outsider'][0]}" if r["outsider"] else ""
            print(f"{r['kind']} {r['seed']}: {what}; ratio {j['ratio']:.2f}, left {j['left']:.2f} x the noise, {d['verdict']}"
                  f"{', cross-validated' if d['cross_validated'] else ''}, {d['cpu_seconds']:.0f} s: true {', '.join(r['effects'])}{beside}; "
                  f"named {', '.join(d['causes'])}{missing}; base {j['contained']}/{j['base']}; "
                  f"or {', '.join('/'.join(a) for a in d['alternatives'])}; "
                  f"withdrawn {', '.join(d['withdrawn'])}; unknown {', '.join(t[0] for t in d['unknown'])}")
    for r in results:
        if "error" in r:
            print(f"{r['kind']} {r['seed']}: {r['error'][-300:]}")


def seeds(text):
    first, last = map(int, text.split(":"))
    return range(first, last + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--two-tanks", type=Path, help="the program of two_tanks.cpp")
    parser.add_argument("--axes", type=seeds, default=[], help="seeds, first:last")
    parser.add_argument("--rippled-axes", type=seeds, default=[], help="seeds, first:last")
    parser.add_argument("--tanks", type=seeds, default=[], help="seeds, first:last")
    parser.add_argument("--program-seed", type=int, default=1, help="of the diagnosis")
    parser.add_argument("--no-oracle", action="store_true")
    parser.add_argument("--all-matter", action="store_true", help="a quicker oracle: every true effect counts as one that matters")
    parser.add_argument("--reuse", type=Path, help="results whose oracles are taken over")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--report", type=Path)
    parser.add_argument("--each", action="store_true", help="a line per case")
    options = parser.parse_args()
    if options.report:
        tell(json.loads(options.report.read_text()), options.each)
        return
    known = json.loads(options.reuse.read_text()) if options.reuse else []
    oracles = {(r["kind"], r["seed"]): r["oracle"] for r in known if "oracle" in r}
    results = []
    for kind, seed in [("axis", s) for s in options.axes] + [("rippled axis", s) for s in options.rippled_axes] + [("tanks", s) for s in options.tanks]:
        results.append(study(options, kind, seed, oracles))
        options.out.write_text(json.dumps(results, indent=1))
        tell(results[-1:], True)
        sys.stdout.flush()
    print()
    tell(results, options.each)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Faults put into copies of measured data sets: which of those that move a parameter `sinew data check` finds.

Every copy has one fault of a random kind, place and size, in a channel that a problem is fitted to (fits.py). The recordings are
checked (`data check F.h5`), made ready for the fit and checked again (`data check F.h5 PROBLEM`), and fitted. A copy is judged if a
parameter moves by more than the half-width of its 95 % interval of the untouched data, or if the program refuses the data or has no
answer within LIMIT s. A fault is found if a remark that the untouched data do not have names its channel (or the one that it was compared with, or its grid, of a
clock), its trial and, of a part of a trial, its time; or if `identify` remarks that the fit of the other trials contradicts this one
(`odd_trial`), which names the trial alone and is counted apart.

    run.py --sinew build/release/sinew --work data_check_work [--judged 200] [--seed 1] [--jobs 2]
    run.py ... --untouched        # only the remarks on the data as they are
    run.py ... --moves rows.json  # after a change of the check: the fits are those of an earlier run
    run.py ... --everywhere       # the same sign, unit or delay in all trials
"""
import argparse
import json
import multiprocessing
import shutil
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

import h5py
import numpy as np

import faults
import fits
import real_sets


def check(sinew, path, *problem):
    began = time.time()
    done = subprocess.run([str(w) for w in (sinew, "data", "check", path, *problem, "--json", "-")], capture_output=True, text=True,
                          check=False)
    if done.returncode == 2:
        raise fits.CannotUse(done.stderr)
    return json.loads(done.stdout)["findings"], time.time() - began


def key(finding):
    return finding["kind"], finding["trial"], finding["channel"], tuple(round(s["from_s"], 2) for s in finding["spans"])


def config_of(pair):
    words = list(pair.words)
    return ["--config", words[words.index("--config") + 1]] if "--config" in words else []


def which(row):
    """What tells one copy from the others."""
    return json.dumps([row[k] for k in ("kind", "set", "trial", "channel", "span", "size")])


def repeat_everywhere(file, fault):
    """The same fault of a whole channel in every other trial."""
    for trial, group in file["trials"].items():
        for grid, content in group.items():
            if trial == fault.trial or not isinstance(content, h5py.Group) or fault.channel not in content.get("channels", {}):
                continue
            other = faults.Fault(fault.kind, None, file, (trial, grid, fault.channel))
            if fault.kind == "sign":
                other.write(-other.x)
            elif fault.kind == "lag":
                other.size = fault.size
                other.write(other.delayed(other.x))
            else:
                other.write(other.x * fault.size)


class Study:
    """A pair with its untouched recordings, their fit and their remarks."""

    def __init__(self, options, pair):
        self.options, self.pair = options, pair
        folder = options.work / pair.name
        folder.mkdir(parents=True, exist_ok=True)
        self.recordings, self.ready = folder / "recordings.h5", folder / "ready.h5"
        if not self.recordings.exists():
            pair.raw(options.sinew, options.data, self.recordings)
        if not self.ready.exists():
            pair.prepare(options.sinew, self.recordings, self.ready)
        began = time.time()
        self.clean, self.odd = pair.fit(options.sinew, self.ready)
        self.seconds = time.time() - began
        self.remarks, self.check_seconds = check(options.sinew, self.recordings)
        self.ready_remarks, _ = check(options.sinew, self.ready, pair.problem, *config_of(pair))

    def draw(self, kind, seed, folder):
        """One copy with a fault of this kind; None if the channel drawn cannot have it."""
        rng = np.random.default_rng(seed)
        copy = folder / f"{self.pair.name}_{seed[-1]}.h5"
        ready = copy.with_suffix(".ready.h5")
        shutil.copy(self.recordings, copy)
        try:
            with h5py.File(copy, "r+") as file:
                places = list(self.pair.places(file))
                where, window = places[rng.integers(len(places))]
                fault = faults.Fault(kind, rng, file, where, window, self.pair.swing)
                if not fault.make():
                    return None
                if self.options.everywhere:
                    repeat_everywhere(file, fault)
            return self.judge(fault, copy, ready)
        finally:
            copy.unlink(missing_ok=True)
            ready.unlink(missing_ok=True)

    def judge(self, fault, copy, ready):
        row = {"kind": fault.kind, "set": self.pair.name, "trial": fault.trial, "channel": fault.channel, "span": fault.span,
               "size": fault.size, "move": None, "whose": "", "found": False, "found_ready": False, "found_fit": False}
        pair, sinew = self.pair, self.options.sinew
        known = {key(f) for f in self.remarks}
        remarks = [f for f in check(sinew, copy)[0] if key(f) not in known]
        row["found"] = fault.found(remarks)
        row["said"] = [f["sentence"] for f in remarks]
        before = self.options.moves.get(which(row))
        try:
            pair.prepare(sinew, copy, ready)
            known = {key(f) for f in self.ready_remarks}
            remarks = [f for f in check(sinew, ready, pair.problem, *config_of(pair))[0] if key(f) not in known]
            row["found_ready"] = fault.found(remarks, pair.cut.get(fault.trial, ()), pair.renamed)
            row["said_ready"] = [f["sentence"] for f in remarks]
            if before:
                row["move"], row["whose"], row["found_fit"] = before
            else:
                answer, odd = pair.fit(sinew, ready, self.clean)
                row["move"], row["whose"] = fits.largest_move(self.clean, answer)
                row["found_fit"] = any(t in {fault.trial, *pair.cut.get(fault.trial, ())} for t in odd if t not in self.odd)
        except fits.CannotUse as error:
            row["refused"] = str(error)[-300:]
        return row


STUDIES = {}
EVERYWHERE = ("sign", "unit_57", "unit_1000", "lag")


def work(job):
    kind, name, seed, folder = job
    return STUDIES[name].draw(kind, seed, Path(folder))


def is_judged(row):
    return row["move"] is None or row["move"] > 1


def is_found(row):
    return row["found"] or row["found_ready"] or row["found_fit"]


def table(rows, title, by, columns):
    print(f"\n| {title} | judged | found | by {columns} |\n|---|---|---|---|")
    groups = defaultdict(lambda: defaultdict(list))
    for row in rows:
        groups[row[by]][row[columns]].append(is_found(row))
    for name, of in groups.items():
        every = [f for found in of.values() for f in found]
        print(f"| {name} | {len(every)} | {sum(every)} | " + ", ".join(f"{n} {sum(f)}/{len(f)}" for n, f in sorted(of.items())) + " |")
    if rows:
        found = sum(is_found(row) for row in rows)
        print(f"| all | {len(rows)} | {found} ({100 * found / len(rows):.0f} %) | |")


def report(rows, options):
    judged = [row for row in rows if is_judged(row)][:options.judged]
    rest = [row for row in rows if not is_judged(row)]
    print(f"\n{len(rows)} copies drawn; {len(judged)} judged, of which the program refused {sum(r['move'] is None for r in judged)}")
    by_fit = sum(r["found_fit"] and not (r["found"] or r["found_ready"]) for r in judged)
    print(f"found by the fit of the other trials alone: {by_fit}")
    judged.sort(key=lambda r: faults.KINDS.index(r["kind"]))
    table(judged, "moves a parameter", "kind", "set")
    table(sorted(judged, key=lambda r: r["set"]), "moves a parameter", "set", "kind")
    table(sorted(rest, key=lambda r: faults.KINDS.index(r["kind"])), "moves none", "kind", "set")
    for row in judged:
        if not is_found(row):
            print("missed:", row["kind"], row["set"], row["trial"], row["channel"], row["span"], row["size"],
                  "refused" if row["move"] is None else f"{row['whose']} by {row['move']:.1f}", file=sys.stderr)


def untouched(options):
    print("| untouched | remarks | s |\n|---|---|---|")
    for name in real_sets.SETS:
        path = real_sets.make(options.sinew, name, options.work / f"{name}.h5", options.data)
        findings, seconds = check(options.sinew, path)
        print(f"| {name} | {len(findings)} | {seconds:.2f} |")
        for f in findings:
            print("   ", f["sentence"], file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=real_sets.DATA)
    parser.add_argument("--judged", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="data sets, separated by commas")
    parser.add_argument("--kinds", default="", help="kinds of faults, separated by commas")
    parser.add_argument("--untouched", action="store_true")
    parser.add_argument("--everywhere", action="store_true", help="the same sign, unit or delay in all trials: no trial contradicts another")
    parser.add_argument("--rows", type=Path, help="JSON with every copy")
    parser.add_argument("--moves", type=Path, help="--rows of an earlier run with this seed: its fits are not repeated, only the checks")
    options = parser.parse_args()
    earlier = json.loads(options.moves.read_text()) if options.moves else []
    options.moves = {which(row): (row["move"], row["whose"], row["found_fit"]) for row in earlier if row["move"] is not None}
    options.work.mkdir(parents=True, exist_ok=True)
    if options.untouched:
        return untouched(options)
    chosen = options.only.split(",") if options.only else [p.__name__ for p in fits.PAIRS]
    print("| data set and problem | fit [s] | check [s] | remarks | parameters with an interval |\n|---|---|---|---|---|")
    for make in fits.PAIRS:
        if make.__name__ in chosen:
            study = Study(options, make(options.data))
            STUDIES[make.__name__] = study
            print(f"| {make.__name__} {study.pair.problem} | {study.seconds:.1f} | {study.check_seconds:.2f} | {len(study.remarks)}, "
                  f"{len(study.ready_remarks)}, {len(study.odd)} | {', '.join(n for n, (_, h) in study.clean.items() if h)} |", flush=True)
    kinds = options.kinds.split(",") if options.kinds else list(EVERYWHERE if options.everywhere else faults.KINDS)
    folder = options.work / f"copies_{options.seed}"
    folder.mkdir(exist_ok=True)
    # Every kind and every data set in turn; the place and the size are random.
    jobs = [(kinds[i % len(kinds)], chosen[(i // len(kinds)) % len(chosen)], (options.seed, i), str(folder)) for i in range(60 * options.judged)]
    rows = []
    with multiprocessing.Pool(options.jobs) as pool:
        for row in pool.imap(work, jobs):
            rows += [row] if row else []
            if row and options.rows:
                options.rows.write_text(json.dumps(rows, indent=0))
            if sum(map(is_judged, rows)) == options.judged:
                break
    shutil.rmtree(folder, ignore_errors=True)
    report(rows, options)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Runs a fixed list of sinew commands and keeps everything that they say, for compare.py.

The list stands in commands.py (made-up data) and measured.py (measured data, left out if the folder is not there). Every
command has a folder DIR/NAME with out.h5, out.json, stdout.txt, stderr.txt and command.json (words, status, seconds). All
paths are relative to DIR, so that nothing in a file depends on where DIR or this tree lie.

usage: run.py --program PATH --out DIR [--data SHARED] [--threads 2] [--only NAME,...]
"""
import argparse
import json
import resource
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

from commands import COMMANDS
from measured import MEASURED

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LONGEST = 600  # [s] a command that takes longer is stopped and counts as failed
# The words that every command of a kind gets beside its own.
FIT = " --out {out} --json {json} --quiet --threads {threads}"
ADDED = {"identify": FIT, "diagnose": FIT, "compare": FIT, "data synthesize": " --out {out}", "data import": " --out {out}",
         "data ceinms": " --out {out}", "simulate": " --out {out}"}
SAYS_JSON = ("data info", "mbs")  # to standard output, which is kept as out.json too


def starts_with(line, kinds):
    return next((kind for kind in kinds if line.startswith(kind)), None)


def words_of(name, line, threads):
    """@OTHER means the out.h5 of the command OTHER; {here} is the folder of this one."""
    kind = starts_with(line, ADDED)
    if kind and " --out " not in line:
        line += ADDED[kind]
    line = line.format(here=name, out=f"{name}/out.h5", json=f"{name}/out.json", threads=threads)
    return [f"{word[1:]}/out.h5" if word.startswith("@") else word for word in shlex.split(line)]


def prepare(folder, shared):
    """Links to the data and settings that the commands name; True if measured data are there."""
    folder.mkdir(parents=True, exist_ok=True)
    links = {"data": ROOT / "datasets" / "data", "examples": ROOT / "docs" / "examples", "benchmarks": HERE.parent,
             "settings": HERE / "settings", "measured": shared}
    for name, target in links.items():
        link = folder / name
        link.unlink(missing_ok=True)
        if target.is_dir():
            link.symlink_to(target.resolve())
    return shared.is_dir()


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def execute(program, words, folder):
    """(status, seconds, cpu seconds, stdout, stderr); status 124 if it took too long."""
    begin, cpu = time.monotonic(), cpu_seconds()
    try:
        done = subprocess.run([str(program), *words], cwd=folder, capture_output=True, text=True, timeout=LONGEST, check=False)
        status, out, err = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired:
        status, out, err = 124, "", f"stopped after {LONGEST} s"
    return status, time.monotonic() - begin, cpu_seconds() - cpu, out, err


def run(options, name, line, start):
    """Returns the exit status and the seconds."""
    place = options.out / name
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    words = words_of(name, line, options.threads)
    if start:  # of a command that changes a file
        source = options.out / (f"{start[1:]}/out.h5" if start.startswith("@") else start)
        if source.exists():
            shutil.copyfile(source, place / "out.h5")
    status, seconds, cpu, out, err = execute(options.program, words, options.out)
    (place / "stdout.txt").write_text(out)
    (place / "stderr.txt").write_text(err)
    if starts_with(line, SAYS_JSON) and out.startswith("{"):
        (place / "out.json").write_text(out)
    (place / "command.json").write_text(json.dumps({"command": words, "status": status, "seconds": seconds, "cpu_seconds": cpu},
                                                   indent=1) + "\n")
    return status, seconds, (err.strip().splitlines() or [""])[-1]


def chosen(options, measured):
    """(name, line, start, expected status) of what is to be run, in order."""
    commands = COMMANDS + (MEASURED if measured else [])
    rows = [(*row, "", 0)[:4] if len(row) == 2 else (*row, 0)[:4] for row in commands]
    names = [row[0] for row in rows]
    if len(set(names)) != len(names):
        raise SystemExit("a name stands in the list twice")
    unknown = sorted(set(options.only) - set(names))
    if unknown:
        raise SystemExit(f"--only: no command is named {', '.join(unknown)}")
    return [row for row in rows if not options.only or row[0] in options.only]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", type=lambda text: text.split(","), default=[])
    options = parser.parse_args()
    options.program, options.out = options.program.resolve(), options.out.resolve()
    measured = prepare(options.out, options.data)
    if not measured:
        print(f"{options.data} is not there: commands on measured data are left out")
    unexpected, total = [], 0.0
    for name, line, start, expected in chosen(options, measured):
        status, seconds, last = run(options, name, line, start)
        total += seconds
        note = "" if status == expected else f"  expected status {expected}: {last}"
        print(f"{name:34} status {status} {seconds:7.2f} s{note}", flush=True)
        if status != expected:
            unexpected.append(name)
    print(f"{total:.0f} s in all" + (f"; not as expected: {', '.join(unexpected)}" if unexpected else ""))
    return 1 if unexpected else 0


if __name__ == "__main__":
    sys.exit(main())

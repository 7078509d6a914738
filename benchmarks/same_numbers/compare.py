#!/usr/bin/python3
"""Compares two folders of run.py, number by number.

Every HDF5 and JSON file of BEFORE is held against the one of AFTER: numbers bit by bit (NaN equals NaN), with their types and
shapes, words as they are. Not compared is what NOT_COMPARED names; SENTENCES that differ are counted, but fail nothing, and
neither do the texts of the terminal. What AFTER lacks fails; what only AFTER has is listed.

usage: compare.py BEFORE AFTER [--relative 0] [--only NAME,...] [--places 5]
"""
import argparse
import sys
from pathlib import Path

from reading import read, results
from tally import Tally, compare_numbers, compare_words, count_different

# Keys of times, of the program's version, and of paths; at any depth.
NOT_COMPARED = {"seconds", "cpu_seconds", "seconds_to_target", "version", "data_file", "data", "command"}
# Keys of texts for people, whose words may change while every number stays.
SENTENCES = {"sentence", "sentences", "findings", "warnings", "reason", "remedy", "meaning", "source", "title", "objective",
             "stop_test", "why", "why_not", "separated_by", "directions", "basis", "shape", "nearest_law", "failure", "reference",
             "stdout", "stderr"}
# Also not compared where numbers may differ a little (--relative): they change with every bit.
HASHES = {"hash", "data_hash"}


def left_out(place, relative):
    names = NOT_COMPARED | (HASHES if relative > 0 else set())
    return bool(names.intersection(place.replace("@", "/").split("/")))


def compare_value(place, key, a, b, relative, tally):
    """Lists are words, arrays are numbers."""
    if isinstance(a, list) != isinstance(b, list):
        tally.different(place, 1, "numbers became words, or words numbers")
    elif not isinstance(a, list):
        compare_numbers(place, a, b, relative, tally)
    elif key in SENTENCES:
        tally.texts += count_different(a, b)
    else:
        compare_words(place, a, b, tally)


def compare_file(before, after, relative, tally, name):
    a, b = read(before), read(after)
    for place, (key, value) in a.items():
        if left_out(place, relative):
            continue
        if place in b:
            compare_value(f"{name}/{place}", key, value, b[place][1], relative, tally)
        elif key in SENTENCES and isinstance(value, list):
            tally.texts += 1
        else:
            tally.missing.append(f"{name}/{place}")
    tally.extra += [f"{name}/{place}" for place, (key, value) in b.items() if place not in a and not left_out(place, relative)
                    and not (key in SENTENCES and isinstance(value, list))]


def compare_command(before, after, relative):
    tally = Tally()
    if not after.is_dir():
        tally.missing.append("the whole command")
        return tally
    for name in sorted(results(before) | results(after)):
        if name not in results(after):
            tally.missing.append(name)
        elif name not in results(before):
            tally.extra.append(name)
        else:
            compare_file(before / name, after / name, relative, tally, name)
    return tally


def show(places, words, most):
    for place in places[:most]:
        print(f"    {words}{place}")
    if len(places) > most:
        print(f"    {words}... {len(places) - most} more")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--relative", type=float, default=0, help="numbers that differ by less do not count as different")
    parser.add_argument("--only", type=lambda text: text.split(","), default=[])
    parser.add_argument("--places", type=int, default=5, help="differences to list per command")
    options = parser.parse_args()
    commands = {folder: {p.name for p in folder.iterdir() if (p / "command.json").exists()}
                for folder in (options.before, options.after)}
    names = sorted(options.only or commands[options.before])
    total = Tally()
    for name in names:
        tally = compare_command(options.before / name, options.after / name, options.relative)
        print(tally.line(name))
        show(tally.places, "", options.places)
        show(tally.missing, "missing: ", options.places)
        show(tally.extra, "only after: ", options.places)
        total.add(tally)
    extra = sorted(commands[options.after] - commands[options.before])
    if extra:
        print(f"commands only after: {', '.join(extra)}")
    print(total.line(f"{len(names)} commands"))
    return 1 if total.failed or not names else 0


if __name__ == "__main__":
    sys.exit(main())

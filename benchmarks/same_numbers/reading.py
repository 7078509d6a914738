"""Files of results as flat tables: place -> (key, numbers as an array | words as a list of str)."""
import json
import re
from pathlib import Path

import h5py
import numpy as np

SUFFIXES = {".h5", ".json", ".txt", ".sto", ".xml"}
DURATION = re.compile(r"(\b\d+ min )?\b\d[\d.]*(e[+-]?\d+)? (us|ms|s|min)\b")  # in texts of the terminal
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")


def results(folder):
    return {str(path.relative_to(folder)) for path in Path(folder).rglob("*") if path.suffix in SUFFIXES}


def read(path):
    if path.suffix == ".h5":
        return read_h5(path)
    if path.suffix == ".json":
        return read_json(path)
    alone = not any(p.suffix in SUFFIXES and p.name not in ("stdout.txt", "stderr.txt", "command.json")
                    for p in path.parent.iterdir())
    if path.suffix == ".txt" and not (alone and path.name == "stdout.txt"):
        return read_said(path)
    return read_table(path)


def as_text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def entry(key, value):
    """Numbers keep their type and shape."""
    if isinstance(value, h5py.Empty):
        return key, ["(empty)"]
    array = np.asarray(value)
    if array.dtype.kind in "OSU":
        return key, [as_text(v) for v in array.ravel()]
    return key, np.ascontiguousarray(array)


def read_h5(path):
    table = {}

    def visit(name, item):
        for attribute, value in item.attrs.items():
            table[f"{name}@{attribute}"] = entry(attribute, value)
        if isinstance(item, h5py.Dataset):
            table[name] = entry(name.rsplit("/", 1)[-1], item[()])
        elif len(item) == 0:
            table[name] = (name.rsplit("/", 1)[-1], ["(empty group)"])

    with h5py.File(path) as file:
        visit("", file)
        file.visititems(visit)
    return table


def read_json(path):
    """null is NaN: the program writes numbers that are not finite so."""
    table = {}

    def visit(place, key, value):
        if isinstance(value, dict):
            for name, inner in value.items():
                visit(f"{place}/{name}".lstrip("/"), name, inner)
        elif isinstance(value, list):
            for i, inner in enumerate(value):
                visit(f"{place}/{i}", key, inner)
        elif isinstance(value, str):
            table[place] = (key, [value])
        else:
            table[place] = (key, np.array([np.nan if value is None else float(value)]))

    visit("", "", json.loads(path.read_text()))
    return table


def read_said(path):
    """What a command says: its sentences, without durations and line breaks, which depend on them. JSON is in out.json too."""
    text = " ".join(path.read_text().split())
    if text.startswith("{"):
        return {}
    return {path.stem: (path.stem, DURATION.sub("TIME", text).split(". "))}


def read_table(path):
    """The numbers and the words of each line."""
    table = {}
    for i, line in enumerate(path.read_text().splitlines(), 1):
        numbers = [float(word) for word in NUMBER.findall(line)]
        words = " ".join(NUMBER.sub("#", line).split())
        table[f"line {i}"] = ("line", np.array(numbers))
        table[f"line {i} words"] = (path.stem, [words])
    return table

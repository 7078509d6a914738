#!/usr/bin/python3
"""Faults put into copies of measured data sets, and what `sinew data check` finds of them.

Every copy has one fault of a random kind, place and size. A fault counts as found if a remark that the untouched data do not
have names its channel (or the channel that it was compared with, or its grid, of a clock), its trial, and, of a
fault that is a part of a trial, its time. Sizes: those of SIZES, in terms of the channel's own range.

    run.py --sinew build/release/sinew --work data_check_work [--copies 200] [--seed 1]
    run.py ... --moves 30      # also: of faults in the servo data, how far they move a parameter, in 95 % intervals
"""
import argparse
import json
import shutil
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

import h5py
import numpy as np

import real_sets

KINDS = ("dropout", "spike", "stuck", "clipping", "displaced", "time_jump", "odd_cycle", "unit_57", "unit_1000", "sign", "axis",
         "lag", "drift", "two_feet")
# What a remark on each may be called: the same event can be seen in several ways.
NAMES = {"dropout": {"dropout", "spike", "displaced", "odd_cycle", "stuck"}, "spike": {"spike", "dropout", "displaced"},
         "stuck": {"stuck", "dropout", "displaced", "odd_cycle"}, "clipping": {"clipping"},
         "displaced": {"displaced", "spike", "odd_cycle"}, "time_jump": {"time_jump"}, "odd_cycle": {"odd_cycle", "odd_trial"},
         "unit_57": {"unit", "axis"}, "unit_1000": {"unit", "axis"}, "sign": {"sign"}, "axis": {"axis"},
         "lag": {"lag"}, "drift": {"drift"}, "two_feet": {"two_feet"}}


def check(sinew, path):
    began = time.time()
    done = subprocess.run([sinew, "data", "check", path, "--json", "-"], capture_output=True, text=True, check=False)
    if done.returncode == 2:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)["findings"], time.time() - began


def channels(file):
    for trial in file["trials"].values():
        for grid in trial.values():
            for channel in grid["channels"].values():
                yield trial.name.split("/")[-1], grid.name.split("/")[-1], channel.name.split("/")[-1]


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


class Fault:
    """One fault in one file; `make` returns False if the channel cannot have it."""

    def __init__(self, kind, rng, file, where, swing):
        self.kind, self.rng, self.file, self.swing = kind, rng, file, swing
        self.trial, self.grid, self.channel = where
        self.group = file[f"trials/{self.trial}/{self.grid}"]
        self.time = self.group["time"][()]
        self.data = self.group[f"channels/{self.channel}"]
        self.x = self.data[()].astype(float)
        self.names = {self.channel}
        self.span = None
        self.size = None

    def moving(self, samples):
        """Where a stretch of so many samples covers at least 40 % of the range: elsewhere a fault changes nothing."""
        low, high = np.nanquantile(self.x, (0.02, 0.98))
        for _ in range(200):
            first = int(self.rng.integers(5, max(6, len(self.x) - samples - 5)))
            part = self.x[first:first + samples]
            if np.all(np.isfinite(part)) and np.ptp(part) > 0.4 * (high - low):
                return first
        return None

    def make(self):
        x, n = self.x, len(self.x)
        finite = x[np.isfinite(x)]
        if len(finite) < 60 or np.ptp(finite) == 0:
            return False
        low, high = np.quantile(finite, (0.02, 0.98))
        spread = high - low
        if spread <= 0:
            return False
        return getattr(self, self.kind)(x, n, spread, low, high)

    def stretch(self, first, last):
        self.span = (self.time[first], self.time[last])

    def write(self, x):
        self.data[...] = x
        return True

    def dropout(self, x, n, spread, low, high):
        for _ in range(100):
            length = int(self.rng.integers(2, max(3, n // 40)))
            first = int(self.rng.integers(5, n - length - 5))
            part = x[first - 1:first + length + 1]
            if np.all(np.abs(part) > 0.5 * spread):
                x[first:first + length] = 0
                self.stretch(first, first + length - 1)
                self.size = spread
                return self.write(x)
        return False

    def spike(self, x, n, spread, low, high):
        i = int(self.rng.integers(5, n - 5))
        if not np.all(np.isfinite(x[i - 3:i + 4])):
            return False
        x[i] += self.rng.choice((-1, 1)) * self.rng.uniform(1, 3) * spread
        self.stretch(i, i)
        return self.write(x)

    def stuck(self, x, n, spread, low, high):
        length = max(10, int(self.rng.uniform(0.02, 0.08) * n))
        first = self.moving(length)
        if first is None or abs(x[first + length] - x[first]) < 0.3 * spread:
            return False
        x[first:first + length] = x[first]
        self.stretch(first, first + length - 1)
        return self.write(x)

    def clipping(self, x, n, spread, low, high):
        if text(self.data.attrs["kind"]) == "input":
            return False
        top = self.rng.random() < 0.5
        level = high - self.rng.uniform(0.1, 0.3) * spread if top else low + self.rng.uniform(0.1, 0.3) * spread
        clipped = np.minimum(x, level) if top else np.maximum(x, level)
        # A level that the signal rests at anyway cuts nothing off.
        if np.nansum(clipped != x) < 0.01 * n or level == 0:
            return False
        return self.write(clipped)

    def displaced(self, x, n, spread, low, high):
        length = max(8, int(self.rng.uniform(0.01, 0.05) * n))
        first = int(self.rng.integers(5, n - length - 5))
        if not np.all(np.isfinite(x[first - 3:first + length + 3])):
            return False
        x[first:first + length] += self.rng.choice((-1, 1)) * self.rng.uniform(0.7, 2) * spread
        self.stretch(first, first + length - 1)
        return self.write(x)

    def time_jump(self, x, n, spread, low, high):
        t = self.time
        i = int(self.rng.integers(n // 10, 9 * n // 10))
        t[i:] += self.rng.uniform(0.03, 0.2) * (t[-1] - t[0])
        self.group["time"][...] = t
        self.names = {""}
        return True

    def odd_cycle(self, x, n, spread, low, high):
        if not self.swing:
            return False
        duration = self.rng.uniform(0.2, 0.4) * self.swing
        t = self.time
        from_s = self.rng.uniform(t[0] + 3 * self.swing, t[-1] - 4 * self.swing)
        p = (t - from_s) / duration
        inside = (p > 0) & (p < 1)
        if inside.sum() < 5:
            return False
        x[inside] += self.rng.choice((-1, 1)) * self.rng.uniform(0.5, 1) * spread * np.sin(np.pi * p[inside]) ** 2
        self.stretch(*np.flatnonzero(inside)[[0, -1]])
        return self.write(x)

    def scaled(self, x, factor):
        self.names |= {self.channel.replace("_x", "_y").replace("_z", "_y")}
        return self.write(x * (factor if self.rng.random() < 0.5 else 1 / factor))

    def unit_57(self, x, n, spread, low, high):
        return text(self.data.attrs["unit"]).startswith("rad") and self.scaled(x, 180 / np.pi)

    def unit_1000(self, x, n, spread, low, high):
        return text(self.data.attrs["unit"]) in ("m", "N", "N*m", "V") and self.scaled(x, 1000)

    def sign(self, x, n, spread, low, high):
        return self.write(-x)

    def axis(self, x, n, spread, low, high):
        if not self.channel.endswith("_force_y"):
            return False
        other = self.group[f"channels/{self.channel[:-1]}{self.rng.choice(('x', 'z'))}"]
        y = other[()]
        other[...] = x
        return self.write(y)

    def lag(self, x, n, spread, low, high):
        step = np.median(np.diff(self.time))
        shift = max(5, int(self.rng.uniform(0.1, 0.25) / step))
        return self.write(np.concatenate([np.full(shift, x[0]), x[:-shift]])) if shift < n // 4 else False

    def drift(self, x, n, spread, low, high):
        if text(self.data.attrs["unit"]) not in ("N", "N*m", "V") or "_moment_" in self.channel or not (
                self.swing or self.channel.endswith("force_y")):
            return False
        return self.write(x + self.rng.choice((-1, 1)) * self.rng.uniform(0.1, 0.3) * spread * np.linspace(0, 1, n))

    def two_feet(self, x, n, spread, low, high):
        """The other foot comes down on this plate: its force and centre of pressure are added to this plate's."""
        if not self.channel.endswith("_force_y"):
            return False
        plate = self.channel[:-len("_force_y")]
        others = [c[:-len("_force_y")] for c in self.group["channels"] if c.endswith("_force_y") and c != self.channel]
        if not others:
            return False
        other = others[0]
        get = lambda name: self.group[f"channels/{name}"][()].astype(float)  # noqa: E731
        f = get(f"{other}_force_y")
        loaded = np.flatnonzero((f > 0.1 * f.max()) & (x > 0.1 * x.max()))
        if len(loaded) == 0:
            return False
        at = int(self.rng.choice(loaded))
        first = at
        while first > 0 and f[first] > 0.02 * f.max():
            first -= 1
        last = at
        while last < n - 1 and f[last] > 0.02 * f.max():
            last += 1
        if first == 0 or last == n - 1:
            return False
        part = slice(first, last)
        total = x[part] + f[part]
        for axis in "xz":
            mine, theirs = get(f"{plate}_cop_{axis}"), get(f"{other}_cop_{axis}")
            mine[part] = (x[part] * mine[part] + f[part] * theirs[part]) / np.maximum(total, 1)
            self.group[f"channels/{plate}_cop_{axis}"][...] = mine
        x[part] = total
        self.group[f"channels/{other}_force_y"][...] = np.where((np.arange(n) >= first) & (np.arange(n) < last), 0, f)
        self.stretch(first, last)
        return self.write(x)

    def found(self, remarks):
        for remark in remarks:
            if remark["kind"] not in NAMES[self.kind]:
                continue
            if not self.names & {remark["channel"], remark["other"]} and not (self.kind == "time_jump" and remark["grid"] == self.grid):
                continue
            if remark["trial"] != self.trial and self.trial not in remark["other"]:
                continue
            if self.span and not any(s["from_s"] <= self.span[1] + 0.05 and s["to_s"] >= self.span[0] - 0.05 for s in remark["spans"]):
                continue
            return True
        return False


def key(finding):
    return finding["kind"], finding["trial"], finding["channel"], tuple(round(s["from_s"], 2) for s in finding["spans"])


def moved(sinew, clean, spoilt):
    """Largest change of an identifiable parameter, in half-widths of its 95 % interval; None if nothing can be fitted."""
    answers = []
    for path in (clean, spoilt):
        done = subprocess.run([sinew, "identify", "drive", "--data", path, "--out", str(path) + ".run", "--quiet", "--intervals", "linear",
                               "--json", "-"], capture_output=True, text=True, check=False)
        if done.returncode == 2:
            return None
        answers.append({p["name"]: p for p in json.loads(done.stdout)["parameters"]})
    changes = []
    for name, p in answers[0].items():
        if p["verdict"] in ("identifiable", "weak") and p["ci95"]:
            half = 0.5 * (p["ci95"][1] - p["ci95"][0])
            changes.append(abs(answers[1][name]["value"] - p["value"]) / half if half > 0 else 0)
    return max(changes, default=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=real_sets.DATA)
    parser.add_argument("--copies", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--moves", type=int, default=0, help="so many faults of servo_xl330 are also fitted")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(options.seed)
    sets, before, swings = {}, {}, {}
    print("| untouched | remarks | s |\n|---|---|---|")
    for name in real_sets.SETS:
        sets[name] = real_sets.make(options.sinew, name, options.work / f"{name}.h5", options.data)
        findings, seconds = check(options.sinew, sets[name])
        before[name] = {key(f) for f in findings}
        print(f"| {name} | {len(findings)} | {seconds:.2f} |")
        if options.verbose:
            for f in findings:
                print("   ", f["sentence"], file=sys.stderr)
    swings["walking_emg"] = 1.15  # [s] a stride
    results = defaultdict(lambda: defaultdict(list))
    missed = []
    number = 0
    while number < options.copies:
        kind = KINDS[number % len(KINDS)]
        name = str(rng.choice(list(sets)))
        copy = options.work / "copy.h5"
        shutil.copy(sets[name], copy)
        with h5py.File(copy, "r+") as file:
            where = list(channels(file))
            fault = Fault(kind, rng, file, where[rng.integers(len(where))], swings.get(name))
            if "rat" in name and kind in ("spike",) or not fault.make():
                continue
        remarks, _ = check(options.sinew, copy)
        found = fault.found([f for f in remarks if key(f) not in before[name]])
        results[kind][name].append(found)
        if not found:
            missed.append((kind, name, fault.trial, fault.channel, fault.span))
        number += 1
    print("\n| fault | copies | found | by data set |\n|---|---|---|---|")
    for kind in KINDS:
        of = results[kind]
        every = [f for found in of.values() for f in found]
        if every:
            print(f"| {kind} | {len(every)} | {sum(every)} | " + ", ".join(f"{n} {sum(f)}/{len(f)}" for n, f in sorted(of.items())) + " |")
    every = [f for of in results.values() for found in of.values() for f in found]
    print(f"| all | {len(every)} | {sum(every)} ({100 * np.mean(every):.0f} %) | |")
    for entry in missed:
        print("missed:", *entry, file=sys.stderr)
    if options.moves:
        clean = sets["servo_xl330"]
        rows = []
        while len(rows) < options.moves:
            kind = str(rng.choice([k for k in KINDS if k not in ("two_feet", "axis", "odd_cycle", "drift")]))
            copy = options.work / "copy.h5"
            shutil.copy(clean, copy)
            with h5py.File(copy, "r+") as file:
                where = [w for w in channels(file) if w[2] != "supply_voltage" and w[0] not in ("run_7", "run_8")]
                fault = Fault(kind, rng, file, where[rng.integers(len(where))], None)
                if not fault.make():
                    continue
            remarks, _ = check(options.sinew, copy)
            rows.append((kind, moved(options.sinew, clean, copy), fault.found(remarks)))
        print("\n| fault in servo_xl330 | largest change of a parameter [half-widths] | found |\n|---|---|---|")
        for kind, change, found in sorted(rows, key=lambda r: r[0]):
            print(f"| {kind} | {'not fitted' if change is None else f'{change:.1f}'} | {'yes' if found else 'no'} |")
        moving = [found for _, change, found in rows if change is None or change > 1]
        print(f"| moved by more than an interval | {len(moving)} | {sum(moving)} |")


if __name__ == "__main__":
    main()

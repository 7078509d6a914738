#!/usr/bin/env python3
"""The thesis's study of chapter 6 on synthetic people: EMG predicted from speed and angle, and the moments it makes.

usage: run.py --sinew build/release/sinew [--jobs 2] [--dir D] [--out RESULTS.json] [--cycles 9] [--left-out no]

For five people: data (raw EMG of five muscles at six speeds, nine cycles to fit and three held out), the
thesis's averaging (a) and the identified model (b), the calibrated muscles (nms) driven by measured and by
predicted EMG. Prints Tables 14 to 18 with the thesis's figures, then every speed left out once.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor

import h5py
import numpy as np

from thesis import EMG_BY_MUSCLE, EMG_BY_SPEED, TORQUE_BETWEEN, TORQUE_MEASURED, TORQUE_PREDICTED

MUSCLES = {"lat_gas_r": "Gastrocnemius lateralis", "med_gas_r": "Gastrocnemius medialis", "per_long_r": "Peroneus longus",
           "soleus_r": "Soleus", "tib_ant_r": "Tibialis anterior"}
SPEEDS = [30, 45, 60, 75, 90, 120]
PEOPLE = range(5)
BOTH = ("validate", "train")  # of a speed that was left out, nothing was fitted
MOMENT = "ankle_angle_r_moment"


def compare(predicted, measured):
    """RMSE and the square of Pearson's correlation, as in the thesis."""
    rmse = float(np.sqrt(np.mean((predicted - measured) ** 2)))
    if np.std(predicted) == 0 or np.std(measured) == 0:
        return rmse, float("nan")
    return rmse, float(np.corrcoef(predicted, measured)[0, 1] ** 2)


class Person:
    def __init__(self, sinew, folder, number, cycles, left_out):
        self.sinew, self.folder, self.number = sinew, folder, number
        self.cycles, self.left_out = cycles, left_out
        self.seconds = {}

    def path(self, name):
        return os.path.join(self.folder, f"S{self.number}_{name}")

    def run(self, what, *words):
        began = time.time()
        done = subprocess.run([self.sinew, *words], capture_output=True, text=True)
        self.seconds[what] = self.seconds.get(what, 0) + time.time() - began
        if done.returncode != 0:
            sys.exit(f"{' '.join(words)}: {done.stdout}{done.stderr}")

    def config(self, model="", more=""):
        path = self.path("emg_shape.yaml")
        with open(path, "w") as file:
            file.write("emg_shape: {" + ", ".join(w for w in ("angle: ankle_angle_r", model, more) if w) + "}\n")
        return path

    def identify(self, data, out, more=""):
        """Model (b)."""
        self.run("identify emg_shape", "identify", "emg_shape", "--data", data, "--config", self.config("", more), "--solver", "lm", "--intervals", "linear",
                 "--quiet", "--out", out)

    def average(self, data, out, more=""):
        """Model (a): its starts are the thesis's averaging."""
        self.run("averaging", "simulate", "emg_shape", "--data", data, "--config", self.config("model: averaging", more), "--out", out)

    def study(self):
        data, shape, averaged, muscles = (self.path(n) for n in ("data.h5", "shape.h5", "a.h5", "nms.h5"))
        self.run("data", "data", "synthesize", "emg_shape", "--set", f"subject={self.number}",
                 "--set", f"train={self.cycles}", "--seed",
                 str(100 + self.number), "--out", data)
        self.identify(data, shape)
        self.average(data, averaged)
        predicted = self.path("b.h5")
        self.run("simulate", "simulate", "emg_shape", "--data", data, "--from", shape, "--out", predicted)
        self.run("nms", "identify", "nms", "--data", data, "--solver", "lm", "--intervals", "linear", "--quiet", "--out", muscles)
        torques = {}
        for name, words in (("measured", []), ("a", ["--excitations", averaged]), ("b", ["--excitations", predicted])):
            torques[name] = self.path(f"torque_{name}.h5")
            self.run("nms", "simulate", "nms", "--data", data, "--from", muscles, *words, "--out", torques[name])
        results = {"emg": {"a": self.emg(data, shape, averaged), "b": self.emg(data, shape, predicted)},
                   "torque": self.torques(data, shape, torques), "coverage": self.coverage(data, shape),
                   "left_out": self.leave_out(data) if self.left_out else {}}
        results["seconds"] = self.seconds
        return results

    @staticmethod
    def held_out_cycles(run, trial):
        trial = run[f"details/emg_shape/trials/{trial}"]
        return list(zip(trial["begin"][:], trial["end"][:]))

    def emg(self, data, shape, predicted, speeds=SPEEDS, kinds=("validate",)):
        """[(muscle, speed, rmse, r2)] of every held-out cycle."""
        rows = []
        with h5py.File(data) as d, h5py.File(shape) as run, h5py.File(predicted) as p:
            for speed, trial in ((s, f"{kind}_{s:03}") for s in speeds for kind in kinds):
                measured = d[f"trials/{trial}/excitations"]
                simulated = p[f"trials/{trial}/simulated"]
                at = measured["time"][:]
                for begin, end in self.held_out_cycles(run, trial):
                    inside = (at >= begin) & (at < end)
                    for muscle in MUSCLES:
                        value = np.interp(at[inside], simulated["time"][:], simulated["channels"][muscle][:])
                        rows.append((muscle, speed, *compare(value, measured["channels"][muscle][:][inside])))
        return rows

    def coverage(self, data, shape, speeds=SPEEDS, kinds=("validate",)):
        """{speed: share of held-out samples within the 95 % band}."""
        within = {speed: [] for speed in speeds}
        with h5py.File(data) as d, h5py.File(shape) as run:
            for speed, trial in ((s, f"{kind}_{s:03}") for s in speeds for kind in kinds):
                node = run[f"details/emg_shape/trials/{trial}"]
                at = node["time"][:]
                inside = np.zeros(len(at), bool)
                for begin, end in self.held_out_cycles(run, trial):
                    inside |= (at >= begin) & (at < end)
                for muscle in MUSCLES:
                    error = d[f"trials/{trial}/excitations/channels/{muscle}"][:] - node[f"{muscle}/predicted"][:]
                    within[speed].append(np.mean(np.abs(error[inside]) <= 1.96 * node[f"{muscle}/deviation"][:][inside]))
        return {speed: float(np.mean(shares)) for speed, shares in within.items()}

    def torques(self, data, shape, files):
        """{comparison: [(speed, rmse, r2)]} of every held-out cycle."""
        rows = {"measured": [], "a": [], "b": [], "between_a": [], "between_b": []}
        with h5py.File(data) as d, h5py.File(shape) as run:
            opened = {name: h5py.File(path) for name, path in files.items()}
            for speed in SPEEDS:
                trial = f"validate_{speed:03}"
                grid = d[f"trials/{trial}/moments"]
                at, truth = grid["time"][:], grid["channels"][MOMENT][:]
                made = {name: f[f"trials/{trial}/simulated/channels/{MOMENT}"][:] for name, f in opened.items()}
                for begin, end in self.held_out_cycles(run, trial):
                    inside = (at >= begin) & (at < end)
                    for name in files:
                        rows[name].append((speed, *compare(made[name][inside], truth[inside])))
                    for name in ("a", "b"):
                        rows[f"between_{name}"].append((speed, *compare(made[name][inside], made["measured"][inside])))
            for f in opened.values():
                f.close()
        return rows

    def leave_out(self, data):
        """Every speed once: fitted to the five others."""
        results = {}
        for speed in SPEEDS:
            shape, averaged, predicted = (self.path(f"without_{speed}_{n}.h5") for n in ("shape", "a", "b"))
            without = f"hold_out: [train_{speed:03}]"
            self.identify(data, shape, without)
            self.average(data, averaged, without)
            self.run("simulate", "simulate", "emg_shape", "--data", data, "--config", self.config("", without), "--from", shape,
                     "--out", predicted)
            results[speed] = {"a": self.emg(data, shape, averaged, [speed], BOTH), "b": self.emg(data, shape, predicted, [speed], BOTH),
                              "coverage": self.coverage(data, shape, [speed], BOTH)[speed]}
        return results


def mean_and_deviation(values):
    return float(np.nanmean(values)), float(np.nanstd(values, ddof=1))


def cell(rows, digits):
    rmse, rmse_std = mean_and_deviation([r[-2] for r in rows])
    r2, r2_std = mean_and_deviation([r[-1] for r in rows])
    return (f"{rmse:.{digits}f} ± {rmse_std:.{digits}f}", f"{r2:.3f} ± {r2_std:.3f}")


def table(title, keys, label, select, thesis, digits):
    print(f"\n### {title}\nOurs, and the thesis's in brackets.\n")
    print("| | | " + " | ".join(f"S{p}" for p in PEOPLE) + " |\n|" + "---|" * 7)
    for row, key in enumerate(keys):
        cells = [cell(select(p, key), digits) for p in PEOPLE]
        for line, name in enumerate(("RMSE", "R2")):
            said = [thesis[2 * row + line][p] for p in PEOPLE]
            print(f"| {label(key) if line == 0 else ''} | {name} | "
                  + " | ".join(f"{c[line]} ({t})" for c, t in zip(cells, said)) + " |")


def overall(rows):
    """Mean over people of each person's mean, and its scatter over people, as in the thesis."""
    rmse = [np.nanmean([r[-2] for r in of]) for of in rows]
    r2 = [np.nanmean([r[-1] for r in of]) for of in rows]
    return f"{np.mean(rmse):.3g} ± {np.std(rmse, ddof=1):.2g}, R2 {np.mean(r2):.3f} ± {np.std(r2, ddof=1):.3f}"


def tables(results):
    def emg(model, column):
        return lambda p, key: [r for r in results[p]["emg"][model] if r[column] == key]

    def torque(name):
        return lambda p, key: [r for r in results[p]["torque"][name] if r[0] == key]

    print("# EMG of a cyclic movement without electrodes\n"
          "Made-up people; 3 held-out cycles a speed (the thesis: 3 for EMG, 9 for moments).")
    names = {"a": "(a) averaging", "b": "(b) identified"}
    for model, name in names.items():
        table(f"Table 14, {name}: EMG by muscle", list(MUSCLES), MUSCLES.get, emg(model, 0), EMG_BY_MUSCLE, 3)
        table(f"Table 15, {name}: EMG by speed", SPEEDS, "{} deg/s".format, emg(model, 1), EMG_BY_SPEED, 3)
    table("Table 16: moments from measured EMG [N m]", SPEEDS, "{} deg/s".format, torque("measured"), TORQUE_MEASURED, 1)
    for model, name in names.items():
        table(f"Table 17, {name}: moments from predicted EMG [N m]", SPEEDS, "{} deg/s".format, torque(model), TORQUE_PREDICTED, 1)
        table(f"Table 18, {name}: between both [N m]", SPEEDS, "{} deg/s".format, torque(f"between_{model}"), TORQUE_BETWEEN, 1)

    print("\n### Over all people\n| | thesis | (a) | (b) |\n|---|---|---|---|")
    print("| EMG | 0.088 ± 0.017, R2 0.785 ± 0.094 | "
          + " | ".join(overall([results[p]["emg"][m] for p in PEOPLE]) for m in "ab") + " |")
    measured = overall([results[p]["torque"]["measured"] for p in PEOPLE])
    print(f"| moments, measured EMG [N m] | 11.6 ± 2.8, R2 0.885 ± 0.042 | {measured} | the same |")
    for name, said in (("{}", "12.6 ± 2.9, R2 0.857 ± 0.053"), ("between_{}", "5.93 ± 1.6, R2 0.963 ± 0.028")):
        words = "moments, predicted EMG" if name == "{}" else "between both"
        print(f"| {words} [N m] | {said} | "
              + " | ".join(overall([results[p]["torque"][name.format(m)] for p in PEOPLE]) for m in "ab") + " |")

    print("\n### Held-out EMG, (b) against (a)\n| person | phase shifts with speed | (a) | (b) | |\n|---|---|---|---|---|")
    for p in PEOPLE:
        a, b = (np.mean([r[2] for r in results[p]["emg"][m]]) for m in "ab")
        print(f"| S{p} | {'yes' if p in (0, 2, 4) else 'no'} | {a:.4f} | {b:.4f} | {100 * (b / a - 1):+.0f} % |")
    for name, people in (("who shift", (0, 2, 4)), ("who do not", (1, 3))):
        a, b = (np.mean([r[2] for p in people for r in results[p]["emg"][m]]) for m in "ab")
        print(f"| {name} | | {a:.4f} | {b:.4f} | {100 * (b / a - 1):+.0f} % |")
    print("\nCoverage of the 95 % band at measured speeds: "
          + ", ".join(f"{s} deg/s {100 * np.mean([results[p]['coverage'][s] for p in PEOPLE]):.0f} %" for s in SPEEDS))

    if results[0]["left_out"]:
        print("\n### One speed left out\n| deg/s | | (a) RMSE, R2 | (b) RMSE, R2 | who shift (a), (b) | who do not (a), (b) | in the 95 % band |"
              "\n|---|---|---|---|---|---|---|")
        for speed in SPEEDS:
            of = {m: [r for p in PEOPLE for r in results[p]["left_out"][speed][m]] for m in "ab"}
            words = [f"{np.mean([r[2] for r in of[m]]):.4f}, {np.nanmean([r[3] for r in of[m]]):.3f}" for m in "ab"]
            split = []
            for people in ((0, 2, 4), (1, 3)):
                split.append(", ".join(f"{np.mean([r[2] for p in people for r in results[p]['left_out'][speed][m]]):.4f}" for m in "ab"))
            band = np.mean([results[p]["left_out"][speed]["coverage"] for p in PEOPLE])
            kind = "extrapolated" if speed in (SPEEDS[0], SPEEDS[-1]) else "interpolated"
            print(f"| {speed} | {kind} | {' | '.join(words)} | {' | '.join(split)} | {100 * band:.0f} % |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--dir", help="keep all files there")
    parser.add_argument("--out", help="results as JSON")
    parser.add_argument("--cycles", type=int, default=9)
    parser.add_argument("--left-out", choices=["yes", "no"], default="yes")
    words = parser.parse_args()
    began = time.time()
    with tempfile.TemporaryDirectory() as scratch:
        folder = words.dir or scratch
        os.makedirs(folder, exist_ok=True)
        people = [Person(words.sinew, folder, p, words.cycles, words.left_out == "yes") for p in PEOPLE]
        with ProcessPoolExecutor(words.jobs) as pool:
            results = list(pool.map(Person.study, people))
    tables(results)
    took = {}
    for result in results:
        for what, seconds in result["seconds"].items():
            took[what] = took.get(what, 0) + seconds
    print(f"\nThe whole study took {time.time() - began:.0f} s with {words.jobs} jobs; work: "
          + ", ".join(f"{what} {seconds:.0f} s" for what, seconds in sorted(took.items(), key=lambda t: -t[1])))
    if words.out:
        with open(words.out, "w") as file:
            json.dump({"people": results, "seconds": time.time() - began}, file)


if __name__ == "__main__":
    main()

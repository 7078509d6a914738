#!/usr/bin/python3
"""A rat soleus, fully activated, under six amplitudes of stretch: force predicted by the three tendons, then diagnosed.

The problem nms needs joints: here the joint has a moment arm of 1 m, so that its moment in N m is the force in N.

usage: run.py --sinew PATH [--data DIR] [--work DIR] [--json F] [--no-diagnosis]
"""
import argparse
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
DATA = HERE.parents[2] / "shared" / "data" / "rat_soleus"
AMPLITUDES = [0.05, 0.1, 0.25, 0.5, 1.0, 2.0]  # [mm] of force_trial1..6
FITTED = {0.1, 0.5, 2.0}
ISOMETRIC, FIBRE, PENNATION, FASTEST = 1.2758948506, 0.0171, math.radians(6), 5.3156293513
OFFSET = -0.002  # [m] of the length before any displacement
RATE = 1000  # [1/s]
BEGIN = 0.25  # [s]: before, the force still rises after the first stimulus
TENDONS = ("rigid", "equilibrium", "elastic")
MILLARD = "3.3-8.9 %"


def table(path):
    lines = path.read_text().split("endheader")[1].strip().splitlines()[1:]
    return np.array([[float(word) for word in line.split()] for line in lines]).T


def spline(x, y, at):
    """Natural cubic spline."""
    n, h = len(x), np.diff(x)
    matrix, right = np.eye(n), np.zeros(n)
    for i in range(1, n - 1):
        matrix[i, i - 1:i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        right[i] = 6 * ((y[i + 1] - y[i]) / h[i] - (y[i] - y[i - 1]) / h[i - 1])
    bend = np.linalg.solve(matrix, right)
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, n - 2)
    a, b = (x[k + 1] - at) / h[k], (at - x[k]) / h[k]
    return a * y[k] + b * y[k + 1] + ((a**3 - a) * bend[k] + (b**3 - b) * bend[k + 1]) * h[k]**2 / 6


def curve(name, x, y):
    words = [" ".join(f"{v:.6g}" for v in values) for values in (x, y)]
    return f"<curve><name>{name}</name><xPoints>{words[0]}</xPoints><yPoints>{words[1]}</yPoints></curve>\n"


def ceinms_curves():
    """The curves of CEINMS's own subjects."""
    return (curve("activeForceLength",
                  [-5, 0, .401, .402, .4035, .52725, .62875, .71875, .86125, 1.045, 1.2175, 1.43875, 1.61875, 1.62, 1.621, 2.2, 5],
                  [0, 0, 0, 0, 0, .226667, .636667, .856667, .95, .993333, .77, .246667, 0, 0, 0, 0, 0])
            + curve("passiveForceLength", [-5, .998, .999, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.601, 1.602, 5],
                    [0, 0, 0, 0, .035, .12, .26, .55, 1.17, 2, 2, 2, 2])
            + curve("forceVelocity", [-10, -1, -.6, -.3, -.1, 0, .1, .3, .6, .8, 10],
                    [0, 0, .08, .2, .55, 1, 1.4, 1.6, 1.7, 1.75, 1.75])
            + curve("tendonForceStrain",
                    [-10, -.002, -.001, 0, .00131, .00281, .00431, .00581, .00731, .00881, .0103, .0118, .0123, 9.2, 9.201, 9.202, 20],
                    [0, 0, 0, 0, .0108, .0257, .0435, .0652, .0915, .123, .161, .208, .227, 345, 345, 345, 345]))


def textbook_curves():
    """From closed forms: Gaussian force-length (Thelen 2003), Hill's hyperbola with a plateau of 1.4 for lengthening (Zajac 1989),
    a tendon that strains 4.9 % at the greatest force with an exponential toe (Millard et al. 2013)."""
    length = np.linspace(0.4, 1.6, 25)
    active = np.exp(-(length - 1)**2 / 0.45) * np.clip((length - 0.4) / 0.1, 0, 1) * np.clip((1.6 - length) / 0.1, 0, 1)
    slow = np.linspace(-1, 0, 11)
    fast = np.array([0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0])
    hill = (1 + slow) / (1 - slow / 0.25)
    slope = 1 + 1 / 0.25  # of the hyperbola at rest
    stretch = 1 + 0.4 * fast * slope / (0.4 + fast * slope)
    stretched = np.linspace(1, 1.7, 15)
    passive = (np.exp(4 * (stretched - 1) / 0.6) - 1) / (np.exp(4) - 1)
    toe = 0.049 * 2 / 3
    strain = np.linspace(0, toe, 9)
    pull = (np.exp(3 * strain / toe) - 1) / (np.exp(3) - 1) / 3
    stiffness = (1 - 1 / 3) / (0.049 - toe)
    return (curve("activeForceLength", [-5, 0, .3, *length, 1.7, 2.2, 5], [0, 0, 0, *active, 0, 0, 0])
            + curve("passiveForceLength", [-5, .9, .95, *stretched, 5], [0, 0, 0, *passive, passive[-1]])
            + curve("forceVelocity", [-10, -1.2, *slow, *fast, 10], [0, 0, *hill, *stretch, 1.4])
            + curve("tendonForceStrain", [-10, -.01, *strain, .049, .08, .2, 1],
                    [0, 0, *pull, 1, *(1 + stiffness * (np.array([.08, .2, 1]) - .049))]))


CURVES = {"CEINMS": ceinms_curves, "textbook": textbook_curves}


def subject(curves):
    return f"""<subject><mtuDefault><percentageChange>0.15</percentageChange><damping>0.1</damping>
{CURVES[curves]()}</mtuDefault>
<mtuSet><mtu><name>soleus</name><c1>-0.5</c1><c2>-0.5</c2><shapeFactor>-0.1</shapeFactor>
<optimalFibreLength>{FIBRE}</optimalFibreLength><pennationAngle>{PENNATION}</pennationAngle><tendonSlackLength>{FIBRE}</tendonSlackLength>
<maxIsometricForce>{ISOMETRIC}</maxIsometricForce><maxContractionVelocity>{FASTEST}</maxContractionVelocity></mtu></mtuSet>
<dofSet><dof><name>pull</name><mtuNameSet>soleus</mtuNameSet></dof></dofSet></subject>
"""


def name_of(amplitude):
    return f"amplitude_{amplitude:.2f}mm"


def write_data(options, path, curves):
    """Displacement is positive where it lengthens the muscle; lengths lie at 1 kHz, and a force belongs to the sample next to it."""
    times, displacement = table(options.data / "displacement.dat")
    grid = np.arange(0, 2 * RATE + 1) / RATE
    shape = spline(times, displacement, grid) * 1e-3
    rest = FIBRE * math.cos(PENNATION) + FIBRE + OFFSET
    with h5py.File(path, "w") as file:
        file.attrs["sinew_schema"] = "dataset/1"
        file.attrs["title"] = "rat soleus, fully activated"
        file.attrs["source"] = "Krylow, Sandercock 1997, via ceinms2"
        file["files/subject.xml"] = subject(curves)
        for i, amplitude in enumerate(AMPLITUDES):
            trial = file.create_group(f"trials/{name_of(amplitude)}")
            trial.attrs["role"] = "train" if amplitude in FITTED else "validate"
            trial.attrs["amplitude_mm"] = amplitude
            length = rest + amplitude * shape
            at, force = table(options.data / f"force_trial{i + 1}.dat")
            at = np.round(at * RATE) / RATE
            keep = (at >= BEGIN) & np.append(True, np.diff(at) > 0)
            for grid_name, moments, name, values, unit, kind in (
                    ("excitations", grid, "soleus", np.ones_like(grid), "1", "input"),
                    ("lengths", grid, "soleus", length, "m", "input"),
                    ("moment_arms.pull", grid, "soleus", np.ones_like(grid), "m", "input"),
                    ("angle", grid, "pull", -amplitude * shape, "rad", "input"),
                    ("force", at[keep], "pull_moment", force[keep], "N*m", "measured")):
                trial[f"{grid_name}/time"] = moments
                channel = trial.create_dataset(f"{grid_name}/channels/{name}", data=values, compression="gzip")
                channel.attrs["unit"], channel.attrs["kind"] = unit, kind


def settings(tendon, *parameters):
    return "nms:\n  subject: subject.xml\n  tendon: " + tendon + "\n  parameters:\n" + "".join(f"    {p}\n" for p in parameters)


def sinew(options, *words):
    done = subprocess.run([str(w) for w in (options.sinew, *words)], capture_output=True, text=True, check=False)
    if done.returncode == 2:
        raise SystemExit(done.stderr)
    return done.stdout


def errors(data, simulated):
    """Mean absolute error by amplitude, % of the greatest isometric force."""
    found = {}
    with h5py.File(data) as measured, h5py.File(simulated) as file:
        for amplitude in AMPLITUDES:
            force = measured[f"trials/{name_of(amplitude)}/force"]
            trial = file[f"trials/{name_of(amplitude)}/simulated"]
            model = np.interp(force["time"][:], trial["time"][:], trial["channels/pull_moment"][:])
            found[amplitude] = 100 * np.mean(np.abs(model - force["channels/pull_moment"][:])) / ISOMETRIC
    return found


def row(words, found):
    values = [found[a] for a in AMPLITUDES]
    return f"| {words} | " + " | ".join(f"{v:.1f}" for v in values) + f" | {np.mean(values):.1f} |"


BASE = ("strength: {share: single, lower: 0.5, upper: 2}",
        "tendon_slack_length: {share: single, lower: 0.85, upper: 1.15, relative: true}",
        "damping: {share: single, lower: 0, upper: 2}")
RICH = BASE + ("largest_velocity: {share: single, lower: 1, upper: 30}",
               "optimal_length: {share: single, lower: 0.7, upper: 1.5, relative: true}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--no-diagnosis", action="store_true")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rat_soleus_") as folder:
        work = options.work or Path(folder)
        work.mkdir(parents=True, exist_ok=True)
        everything = {}
        head = "| mean absolute error, % of the greatest force | " + " | ".join(
            f"{a:g} mm{'' if a in FITTED else ' (held out)'}" for a in AMPLITUDES) + " | mean |"
        print(f"Millard et al. 2013, their models of this muscle: {MILLARD}\n\n{head}\n|{'---|' * (len(AMPLITUDES) + 2)}")

        def record(words, data, file):
            everything[words] = errors(data, file)
            print(row(words, everything[words]), flush=True)

        config, out = work / "nms.yaml", work / "simulated.h5"
        for curves in CURVES:
            data = work / f"rat_{curves}.h5"
            write_data(options, data, curves)
            for tendon in TENDONS:
                config.write_text(settings(tendon, *BASE))
                sinew(options, "simulate", "nms", "--data", data, "--config", config, "--out", out)
                record(f"forward, {curves} curves, {tendon}", data, out)
        said = []
        for curves in CURVES:
            data = work / f"rat_{curves}.h5"
            for words, free in (("3 numbers fitted", BASE), ("5 numbers fitted", RICH)):
                for tendon in ("rigid", "elastic"):
                    config.write_text(settings(tendon, *free))
                    run = work / f"run_{curves}_{len(free)}_{tendon}.h5"
                    text = sinew(options, "identify", "nms", "--data", data, "--config", config, "--solver", "hop", "--quiet", "--out", run)
                    sinew(options, "simulate", "nms", "--data", data, "--config", config, "--from", run, "--out", out)
                    record(f"{words}, {curves} curves, {tendon}", data, out)
                    said.append(f"\n### {words}, {curves} curves, {tendon}\n{text}")
        print("".join(said))
        if not options.no_diagnosis:
            for curves in CURVES:
                for tendon in ("rigid", "elastic"):
                    data = work / f"rat_{curves}.h5"
                    config.write_text(settings(tendon, *BASE))
                    begin = time.monotonic()
                    why = work / f"why_{curves}_{tendon}.h5"
                    text = sinew(options, "diagnose", "nms", "--data", data, "--config", config, "--from",
                                 work / f"run_{curves}_{len(BASE)}_{tendon}.h5", "--quiet", "--out", why)
                    print(f"\n### diagnosis, {curves} curves, {tendon}, {time.monotonic() - begin:.0f} s\n{text.split('Base model')[0]}\n{head}\n|{'---|' * (len(AMPLITUDES) + 2)}")
                    sinew(options, "simulate", "nms", "--data", data, "--config", config, "--from", why, "--out", out)
                    record(f"after the diagnosis, {curves} curves, {tendon}", data, out)
        if options.json:
            options.json.write_text(json.dumps(everything, indent=1) + "\n")


if __name__ == "__main__":
    main()

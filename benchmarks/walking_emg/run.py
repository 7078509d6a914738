#!/usr/bin/python3
"""EMG, kinematics and moments of one person's treadmill walking: ankle (and knee) calibrated on 3.6 km/h, held out on 4.5 km/h.

Fitted: 20 s of walk36. Held out: another 20 s of it, and 57 s of walk45. Every figure comes from the program; this script moves
files, takes floors off the EMG and bad steps out of the moments (which the program cannot yet), and prints tables.

usage: run.py --sinew PATH [--data DIR] [--work DIR] [--only TASK,...]
"""
import argparse
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
DATA = HERE.parents[2] / "shared" / "data" / "walking_emg"
MUSCLES = "tib_ant_r,soleus_r,med_gas_r,lat_gas_r,rect_fem_r,vas_med_r,vas_int_r,vas_lat_r,bifemlh_r,semimem_r,bifemsh_r"
JOINTS = "ankle_angle_r,knee_angle_r"
TRIALS = (("walk36_fit", "walk36", "5:25", "train"), ("walk36_held", "walk36", "35:55", "validate"),
          ("walk45_held", "walk45", "1:58", "validate"))
BOTH = (("walk36_fit", "walk36", "5:25", "train"), ("walk36_held", "walk36", "35:55", "validate"),
        ("walk45_fit", "walk45", "5:25", "train"), ("walk45_held", "walk45", "35:55", "validate"))
SPLIT = (("walk36_fit_1", "walk36", "5:12", "train"), ("walk36_fit_2", "walk36", "12:19", "train"),
         ("walk36_fit_3", "walk36", "19:25", "train"), *TRIALS[1:])
FLOOR = 1  # percentile of a recording that counts as its floor
LIFTED, BAD = 20, 0.5  # [N m, s]
READY = "floors off, bad steps out"
TASKS = ("inputs", "published", "calibrate", "knee", "diagnose", "split", "both")


def sinew(options, *words, limit=900):
    done = subprocess.run([str(w) for w in (options.sinew, *words)], capture_output=True, text=True, check=False, timeout=limit)
    if done.returncode == 2:
        raise SystemExit(f"sinew {' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def import_recordings(options):
    """One data set with both recordings whole. A grid is named after its file, and nms needs one called `excitations`."""
    out = options.work / "recordings.h5"
    subjects = []
    for file, name in (("gait2392_simbody_marker_ankle_knee_hip_r.xml", "before.xml"), ("subjectCalibrated.xml", "published.xml")):
        subjects.append(shutil.copy(options.data / file, options.work / name))
    for name in ("walk36", "walk45"):
        (options.work / name).mkdir(exist_ok=True)
        emg = shutil.copy(options.data / name / "emgFilt.sto", options.work / name / "excitations.sto")
        once = [options.data / "gait2392.osim", *subjects] if name == "walk36" else ["--append"]
        sinew(options, "data", "import", emg, options.data / name / "ik.sto", options.data / name / "id.sto", *once, "--trial", name,
              "--title", "treadmill walking, EMG and inverse dynamics", "--source", "doi 10.5281/zenodo.6457662", "--licence",
              "Apache-2.0", "--out", out)
    print(sinew(options, "data", "muscles", out, "--muscles", MUSCLES, "--joints", JOINTS))
    return out


def cut(options, recordings, trials, out):
    shutil.copy(recordings, out)
    for name, source, window, role in trials:
        sinew(options, "data", "cut", out, "--trial", source, "--window", window, "--as", name, "--role", role)
    for source in ("walk36", "walk45"):
        sinew(options, "data", "drop", out, "--trial", source)
    return out


def floors(recordings):
    with h5py.File(recordings) as file:
        return {name: {channel: np.percentile(values[:], FLOOR) for channel, values in trial["excitations/channels"].items()}
                for name, trial in file["trials"].items()}


def without_floors(recordings, data, out):
    """Each signal less the floor of its own recording, nothing below 0."""
    shutil.copy(data, out)
    low = floors(recordings)
    with h5py.File(out, "r+") as file:
        for name, trial in file["trials"].items():
            for channel, values in trial["excitations/channels"].items():
                values[...] = np.maximum(values[:] - low[name[:6]][channel], 0)


def without_bad_steps(recordings, data, out):
    """A gap in the moments of BAD s around every moment above LIFTED, which no dorsiflexors make in level walking: there the other
    foot stands on this foot's plate (its centre of pressure runs backwards). Returns the times."""
    shutil.copy(data, out)
    times = {}
    with h5py.File(recordings) as whole, h5py.File(out, "r+") as file:
        for name, trial in file["trials"].items():
            source = whole[f"trials/{name[:6]}/id"]
            time_, moment = source["time"][:], source["channels/ankle_angle_r_moment"][:]
            at, bad = trial["id/time"][:], time_[moment > LIFTED]
            far = np.array([np.min(np.abs(bad - t), initial=np.inf) for t in at])
            for joint in JOINTS.split(","):
                values = trial[f"id/channels/{joint}_moment"]
                values[...] = np.where(far < BAD, np.nan, values[:])
            inside = bad[(bad >= at[0]) & (bad <= at[-1])]
            times[name] = [t for i, t in enumerate(inside) if i == 0 or t - inside[i - 1] > BAD]
    return times


def errors(file):
    """RMSE [N m] and R2 by trial and channel of a run or simulation as the program writes it."""
    found = {}
    with h5py.File(file) as run:
        for trial, channels in run["prediction"].items():
            for channel, at in channels.items():
                found[trial, channel] = float(at.attrs["rmse"]), float(at.attrs["r2"])
    return found


def show(words, found, joints=("ankle_angle_r",), trials=TRIALS, rest=""):
    cells = [f"{found[name, joint + '_moment'][0]:.2f} ({found[name, joint + '_moment'][1]:.3f})"
             for joint in joints for name, _, _, _ in trials]
    print(f"| {words} | " + " | ".join(cells) + f" | {rest} |", flush=True)


def head(joints=("ankle_angle_r",), trials=TRIALS):
    names = [f"{joint.split('_')[0]} {name}" for joint in joints for name, _, _, _ in trials]
    print("\n| RMSE N m (R2) | " + " | ".join(names) + f" | |\n|{'---|' * (len(names) + 2)}")


def simulated(text):
    """The table that `simulate` prints."""
    found = {}
    for line in text.splitlines():
        words = line.split()
        if len(words) == 6 and words[1] in ("train", "validate"):
            found[words[0], words[2]] = float(words[3]), float(words[5])
    return found


def settings(options, name, **replace):
    text = (HERE / name).read_text()
    for key, value in replace.items():
        before = next(line for line in text.splitlines() if line.strip().startswith(key + ":"))
        text = text.replace(before, f"  {key}: {value}")
    path = options.work / "nms.yaml"
    path.write_text(text)
    return path


def inputs(options, recordings, variants):
    low = floors(recordings)
    print(f"\nfloors ({FLOOR} % of the samples lie below): channel, walk36, walk45")
    for channel in low["walk36"]:
        print(f"  {channel:11} {low['walk36'][channel]:.3f} {low['walk45'][channel]:.3f}")
    for name in ("walk36", "walk45"):
        plates = np.loadtxt(options.data / name / "XLD.mot", skiprows=7)
        print(f"  {name}: mean vertical force of both plates is the weight of {(plates[:, 2] + plates[:, 8]).mean() / 9.80665:.1f} kg")


def published(options, recordings, variants):
    head()
    for words, subject in (("before calibration", "before.xml"), ("published calibration", "published.xml")):
        for tendon in ("rigid", "elastic"):
            for emg, file in variants.items():
                config = settings(options, "ankle.yaml", subject=subject, tendon=tendon)
                text = sinew(options, "simulate", "nms", "--data", file, "--config", config, "--set", "all.delay=0.1", "--out",
                             options.work / "simulated.h5")
                show(f"{words}, {tendon}, EMG {emg}, delay 0.1 s", simulated(text))


def identify(options, words, data, config, out, solver, joints=("ankle_angle_r",), trials=TRIALS):
    begin = time.monotonic()
    text = sinew(options, "identify", "nms", "--data", data, "--config", config, "--solver", solver, "--quiet", "--out", out)
    with h5py.File(out) as run:
        rest = (f"{run['run'].attrs['seconds']:.1f} s, with intervals {time.monotonic() - begin:.0f} s; "
                f"cost {run['run'].attrs['cost']:.1f}")
    show(words, errors(out), joints, trials, rest)
    return text


def calibrate(options, recordings, variants):
    head()
    said = ""
    for emg, file in variants.items():
        for name, words in (("ankle_speed_fixed.yaml", "speed and damping from the file"), ("ankle.yaml", "speed and damping free"),
                            ("ankle_grouped.yaml", "the same, one strength of gastrocnemius")):
            for tendon, solvers in (("rigid", ("lm", "ceres", "hop")), ("equilibrium", ("lm",)), ("elastic", ("lm", "hop"))):
                if tendon != "rigid" and not (name == "ankle.yaml" and emg == READY):
                    continue
                if name == "ankle_grouped.yaml" and emg != READY:
                    continue
                for solver in solvers if name != "ankle_grouped.yaml" else ("hop",):
                    out = options.work / f"run_{name[:-5]}_{tendon}_{solver}_{len(emg)}.h5"
                    text = identify(options, f"{words}, EMG {emg}, {tendon}, {solver}", file,
                                    settings(options, name, tendon=tendon), out, solver)
                    if solver == "hop":
                        said += f"\n### {words}, EMG {emg}, {tendon}, {solver}\n{text}"
    print(said)


def knee(options, recordings, variants):
    joints = ("ankle_angle_r", "knee_angle_r")
    head(joints)
    text = ""
    for emg, file in variants.items():
        text = identify(options, f"ankle and knee, EMG {emg}, rigid, hop", file, settings(options, "ankle_knee.yaml"),
                        options.work / f"knee_{len(emg)}.h5", "hop", joints)
    print(text)


def ask(options, words, data, config, start, trials=TRIALS):
    out = options.work / "why.h5"
    begin = time.monotonic()
    text = sinew(options, "diagnose", "nms", "--data", data, "--config", config, *start, "--quiet", "--out", out)
    print(f"\n### {words}, {time.monotonic() - begin:.0f} s\n{text}")
    after = sinew(options, "simulate", "nms", "--data", data, "--config", config, "--from", out, "--out", options.work / "after.h5")
    head(trials=trials)
    show("after the diagnosis", simulated(after), trials=trials)


def diagnose(options, recordings, variants):
    for name, emg in (("ankle.yaml", READY), ("ankle_speed_fixed.yaml", READY), ("ankle.yaml", "floors off"), ("ankle.yaml", "as recorded")):
        config = settings(options, name)
        start = options.work / "start.h5"
        sinew(options, "identify", "nms", "--data", variants[emg], "--config", config, "--solver", "hop", "--quiet", "--out", start)
        ask(options, f"{name}, EMG {emg}, rigid, from hop's answer", variants[emg], config, ("--from", start))


def split(options, recordings, variants):
    """The same 20 s as three trials: a dominating misfit is then judged by cross-validation over trials (docs/diagnosis.md)."""
    parts, clean, ready = (options.work / f"split{i}.h5" for i in range(3))
    cut(options, recordings, SPLIT, parts)
    without_floors(recordings, parts, clean)
    without_bad_steps(recordings, clean, ready)
    for name in ("ankle_speed_fixed.yaml", "ankle.yaml"):
        config = settings(options, name)
        start = options.work / "start_split.h5"
        head(trials=SPLIT)
        identify(options, f"{name}, three trials fitted, hop", ready, config, start, "hop", trials=SPLIT)
        ask(options, f"{name}, three trials fitted, {READY}", ready, config, ("--from", start), SPLIT)


def both(options, recordings, variants):
    pair = cut(options, recordings, BOTH, options.work / "both.h5")
    config = settings(options, "ankle.yaml")
    clean, ready = options.work / "both_clean.h5", options.work / "both_ready.h5"
    without_floors(recordings, pair, clean)
    without_bad_steps(recordings, clean, ready)
    for emg, file in (("as recorded", pair), (READY, ready)):
        start = options.work / "start_both.h5"
        head(trials=BOTH)
        identify(options, f"both recordings fitted, EMG {emg}, rigid, hop", file, config, start, "hop", trials=BOTH)
        ask(options, f"both recordings fitted, EMG {emg}", file, config, ("--from", start), BOTH)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--only", type=lambda text: text.split(","), default=TASKS)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="walking_emg_") as folder:
        options.work = options.work or Path(folder)
        options.work.mkdir(parents=True, exist_ok=True)
        recordings = import_recordings(options)
        data = cut(options, recordings, TRIALS, options.work / "walking.h5")
        clean, ready = options.work / "walking_clean.h5", options.work / "walking_ready.h5"
        without_floors(recordings, data, clean)
        print("bad steps at", {name: [f"{t:.2f} s" for t in at] for name, at in without_bad_steps(recordings, clean, ready).items()})
        variants = {"as recorded": data, "floors off": clean, READY: ready}
        for task in TASKS:
            if task in options.only:
                globals()[task](options, recordings, variants)


if __name__ == "__main__":
    main()

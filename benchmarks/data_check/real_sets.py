"""The measured data sets of the shared folder, imported by the program as the documents say."""
import subprocess
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data"
MAPS = ROOT / "docs" / "examples" / "servo_pendulum"


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)
    if done.returncode == 2:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done


def gait_subject01(sinew, data, out, kinematics=True):
    folder = data / "gait_subject01"
    walk = folder / "ExperimentalData_subject01_walk"
    run(sinew, "data", "import", f"{walk}.trc", f"{walk}_grf.mot", folder / "Gait10dof18musc_subject01.osim",
        "--external-loads", f"{walk}_grf.xml", "--trial", "walk", "--out", out)
    if kinematics:
        run(sinew, "data", "kinematics", out, "--weights", folder / "IK_walk_Setup_IK.xml", "--quiet")


def gait_walk3d(sinew, data, out, kinematics=True):
    folder = data / "gait_walk3d"
    run(sinew, "data", "import", folder / "markers_walk.trc", folder / "grf_walk.mot", folder / "subject_walk_scaled.osim",
        folder / "electromyography.sto", "--external-loads", folder / "grf_walk.xml", "--trial", "walk", "--out", out)
    if kinematics:
        run(sinew, "data", "kinematics", out, "--weights", folder / "ik_tasks_walk.xml", "--quiet")


def walking_emg(sinew, data, out):
    folder = data / "walking_emg"
    for i, trial in enumerate(("walk36", "walk45")):
        files = [folder / trial / name for name in ("emgFilt.sto", "ik.sto", "id.sto", "XLD.mot")]
        more = ["--append"] if i else [folder / "gait2392.osim"]
        run(sinew, "data", "import", *files, *more, "--plates", "left=l_ground_,right=ground_", "--trial", trial, "--role",
            "validate" if i else "train", "--out", out)


def servo(sinew, data, out, kind, gains):
    for i, (file, gain) in enumerate(zip(sorted((data / "servo_pendulum" / kind).glob("*.csv")), gains)):
        config = [MAPS / ("drive.yaml" if kind == "xl330" else "sts3250/drive.yaml")] if i == 0 else ["--append"]
        table = MAPS / (f"xl330_kp{gain}.yaml" if gain else "sts3250.yaml")
        run(sinew, "data", "import", file, *config, "--map", table, "--trial", f"run_{i + 1}", "--role",
            "validate" if gain == 800 or (not gain and i == 3) else "train", "--out", out)


def servo_xl330(sinew, data, out):
    servo(sinew, data, out, "xl330", (100, 100, 200, 200, 400, 400, 800, 800))


def servo_sts3250(sinew, data, out):
    servo(sinew, data, out, "sts3250", (0, 0, 0, 0))


def cube_tosses(sinew, data, out, step=1):
    """Every step-th toss. Of all of them ten of 19 are fitted, of a part of them every other one."""
    folder = ROOT / "benchmarks" / "cube_tosses"
    for i, file in enumerate(sorted((data / "cube_tosses").glob("*.csv"), key=lambda f: int(f.stem))[::step]):
        more = ["--append"] if i else [folder / "free_body.yaml"]
        run(sinew, "data", "import", file, *more, "--map", folder / "pose.yaml", "--trial", f"toss_{int(file.stem):03d}",
            "--role", "train" if (i % 19 < 10 if step == 1 else i % 2 == 0) else "validate", "--out", out)


def write(out, title, trials):
    """trials: {name: (role, {grid: (time, {channel: (values, unit, kind)})})}."""
    with h5py.File(out, "w") as file:
        file.attrs["sinew_schema"] = "dataset/1"
        file.attrs["title"] = title
        for name, (role, grids) in trials.items():
            group = file.create_group(f"trials/{name}")
            group.attrs["role"] = role
            for grid, (time, channels) in grids.items():
                group[f"{grid}/time"] = time
                for channel, (values, unit, kind) in channels.items():
                    made = group.create_dataset(f"{grid}/channels/{channel}", data=values)
                    made.attrs["unit"] = unit
                    made.attrs["kind"] = kind


def dynamometer_ankle(_, data, out):
    trials = {}
    for i, path in enumerate(sorted((data / "dynamometer_ankle").glob("*.mat"))):
        with h5py.File(path) as file:
            grids = {}
            for grid, key, channel, unit, sign in (("dynamometer", "Angle", "ankle_angle", "deg", -1),
                                                   ("torque", "Torque", "ankle_torque", "N*m", 1), ("emg", "EMG_TA", "tib_ant", "V", 1)):
                values = sign * np.asarray(file[key]["values"]).ravel()
                times = file[key]["start"][0, 0] + file[key]["interval"][0, 0] * np.arange(len(values))
                grids[grid] = (times, {channel: (values, unit, "measured")})
            trials[path.stem] = ("validate" if i % 4 == 3 else "train", grids)
    write(out, "ankle on a dynamometer", trials)


def rat_soleus(_, data, out):
    def table(name):
        text = (data / "rat_soleus" / name).read_text().split("endheader")[1].splitlines()[2:]
        return np.array([[float(word) for word in line.replace(",", " ").split()] for line in text if line.strip()])

    moved = table("displacement.dat")
    trials = {}
    for i, amplitude in enumerate((0.05, 0.1, 0.25, 0.5, 1, 2)):
        time, force = table(f"force_trial{i + 1}.dat").T
        trials[f"amplitude_{i + 1}"] = ("train" if i % 2 else "validate", {
            "motion": (moved[:, 0], {"length": (17.1e-3 * 2 - 2e-3 + 1e-3 * amplitude * moved[:, 1], "m", "input")}),
            "muscle": (time, {"force": (force, "N", "measured")})})
    write(out, "rat soleus", trials)


SETS = {f.__name__: f for f in (gait_subject01, gait_walk3d, walking_emg, servo_xl330, servo_sts3250, cube_tosses,
                                dynamometer_ankle, rat_soleus)}


def make(sinew, name, out, data=DATA):
    """Makes the data set `name` at `out`, unless it is there."""
    out = Path(out)
    if not out.exists():
        out.parent.mkdir(parents=True, exist_ok=True)
        SETS[name](sinew, Path(data), out)
    return out

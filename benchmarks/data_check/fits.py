"""What is fitted to each measured data set: the channels that the fit uses, the way from the recordings to the fit, the fit itself."""
import json
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Optional

import h5py
import numpy as np

import real_sets

ROOT = real_sets.ROOT
sys.path += [str(ROOT / "benchmarks" / "rat_soleus"), str(ROOT / "benchmarks" / "walking_emg")]
HERE = Path(__file__).resolve().parent
LIMIT = 60  # [s] for one command; with untouched data the longest takes 7 s


def words_of(module):
    """run.py of another benchmark: all of them have that name."""
    import importlib.util
    spec = importlib.util.spec_from_file_location(module, ROOT / "benchmarks" / module / "run.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


class CannotUse(Exception):
    """The program refused the data; its reason."""


def run(*words):
    try:
        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        raise CannotUse(f"no answer within {LIMIT} s") from None
    if done.returncode == 2:
        raise CannotUse(done.stderr)
    return done.stdout


@dataclass
class Pair:
    """A data set and a problem.

    raw(sinew, data, out) imports the recordings; prepare(sinew, raw, out) makes of them what is fitted.
    uses: grid and channel patterns that the fit depends on. windows: fitted part of each trial [s], and the trials cut out of it."""
    name: str
    problem: str
    raw: Callable
    uses: tuple
    windows: dict
    prepare: Callable
    words: tuple
    swing: Optional[float] = None
    from_clean: bool = False
    cut: dict = field(default_factory=dict)
    renamed: dict = field(default_factory=dict)  # channels of the recordings under their names in what is fitted

    def places(self, file):
        for trial, window in self.windows.items():
            if trial not in file["trials"]:
                continue
            for grid, group in file[f"trials/{trial}"].items():
                if not isinstance(group, h5py.Group) or "channels" not in group:
                    continue
                for channel in group["channels"]:
                    if any(re.fullmatch(g, grid) and re.fullmatch(c, channel) for g, c in self.uses):
                        yield (trial, grid, channel), window

    def fit(self, sinew, prepared, clean=None):
        """{parameter: (value, half-width of the 95 % interval or None)}, and the trials that the fit of the others contradicts.

        From several starts where they are needed; given the answer `clean` of the untouched data, from there, so that a change is the
        fault's and not the search's."""
        words = self.words
        if clean and self.from_clean:
            words += ("--solver", "lm", *(w for n, (v, _) in clean.items() for w in ("--start", f"{n}={v!r}")))
        out = Path(f"{prepared}.run")
        text = run(sinew, "identify", self.problem, "--data", prepared, "--out", out, "--quiet", "--intervals", "linear", "--threads", "1",
                   "--json", "-", *words)
        out.unlink(missing_ok=True)
        answer = {}
        result = json.loads(text)
        odd = [w["names"][1] for w in result["warning_facts"] if w["kind"] == "odd_trial"]
        for p in result["parameters"]:
            ends = p.get("ci95")
            half = 0.5 * (ends[1] - ends[0]) if ends and None not in ends else None
            answer[p["name"]] = (p["value"], half if half and p["verdict"] in ("identifiable", "weak") else None)
        return answer, odd


def largest_move(clean, spoilt):
    """Largest change of a parameter in half-widths of its 95 % interval, and whose."""
    changes = [(abs(spoilt[n][0] - v) / h, n) for n, (v, h) in clean.items() if h and n in spoilt]
    return max(changes, default=(0, ""))


def gait(sinew, raw, out, weights, cuts):
    shutil.copy(raw, out)
    run(sinew, "data", "kinematics", out, "--weights", weights, "--quiet")
    for window, name, role, plate in cuts:
        run(sinew, "data", "cut", out, "--trial", "walk", "--window", window, "--as", name, "--role", role, "--plate", plate)
    run(sinew, "data", "drop", out, "--trial", "walk")


def used_markers(weights):
    """Pattern of the markers that inverse kinematics uses."""
    names = re.findall(r'<IKMarkerTask name="([^"]+)">\s*(?:<!--.*?-->\s*)*<apply>\s*true', Path(weights).read_text(), re.DOTALL)
    return "(" + "|".join(re.escape(n) for n in names) + ")_[xyz]"


def gait_subject01(data):
    folder = data / "gait_subject01"
    weights = folder / "IK_walk_Setup_IK.xml"
    cuts = (("0.60:1.43", "right_stance", "train", "right"), ("1.23:2.04", "left_stance", "validate", "left"))
    return Pair("gait_subject01", "contact", lambda s, d, o: real_sets.gait_subject01(s, d, o, False),
                (("markers", used_markers(weights)), ("forces", "right_force_y")), {"walk": (0.6, 1.43)},
                lambda s, r, o: gait(s, r, o, weights, cuts),
                ("--config", ROOT / "docs" / "examples" / "gait_subject01.yaml"), cut={"walk": ("right_stance",)})


def gait_walk3d(data):
    weights = data / "gait_walk3d" / "ik_tasks_walk.xml"
    cuts = (("0.26:1.03", "right_1", "train", "Right_GRF"), ("0.83:1.59", "left_1", "train", "Left_GRF"),
            ("1.41:2.17", "right_2", "validate", "Right_GRF"))
    return Pair("gait_walk3d", "contact", lambda s, d, o: real_sets.gait_walk3d(s, d, o, False),
                (("markers", used_markers(weights)), ("forces", "(Left|Right)_GRF_force_y")), {"walk": (0.26, 1.59)},
                lambda s, r, o: gait(s, r, o, weights, cuts), ("--config", HERE / "gait_walk3d.yaml"),
                cut={"walk": ("right_1", "left_1")})


def copied(_, raw, out):
    shutil.copy(raw, out)


DRIVE = ((".*", "position|reference|supply_voltage"),)


def servo_xl330(_):
    return Pair("servo_xl330", "drive", real_sets.servo_xl330, DRIVE, {f"run_{i}": None for i in range(1, 7)}, copied,
                ("--solver", "lm", "--fix", "torque_constant=0.3232", "--fix", "resistance=4.764", "--release", "coulomb_friction"))


def servo_sts3250(_):
    def prepare(sinew, raw, out):
        # In the rest of run_2 the servo is switched off: problems/drive has no such thing.
        shutil.copy(raw, out)
        run(sinew, "data", "cut", out, "--trial", "run_2", "--window", "0:2", "--as", "lift", "--role", "train")
        run(sinew, "data", "drop", out, "--trial", "run_2")

    return Pair("servo_sts3250", "drive", real_sets.servo_sts3250, DRIVE, {"run_1": None, "run_2": (0, 2), "run_3": None}, prepare,
                ("--solver", "lm", "--fix", "resistance=2.0"), cut={"run_2": ("lift",)})


def cube_tosses(data):
    files = sorted((data / "cube_tosses").glob("*.csv"), key=lambda f: int(f.stem))[::8]
    fitted = {f"toss_{int(f.stem):03d}": None for i, f in enumerate(files) if i % 2 == 0}
    return Pair("cube_tosses", "free_body", lambda s, d, o: real_sets.cube_tosses(s, d, o, 8),
                ((".*", "position_[xyz]|orientation_[wxyz]"),), fitted, copied, ("--solver", "lm"))


def walking_emg(data):
    walking = words_of("walking_emg")
    folder = data / "walking_emg"

    def raw(sinew, _, out):
        for i, trial in enumerate(("walk36", "walk45")):
            emg = Path(out).parent / trial / "excitations.sto"  # a grid is named after its file
            emg.parent.mkdir(exist_ok=True)
            shutil.copy(folder / trial / "emgFilt.sto", emg)
            subject = Path(out).parent / "before.xml"
            shutil.copy(folder / "gait2392_simbody_marker_ankle_knee_hip_r.xml", subject)
            run(sinew, "data", "import", emg, folder / trial / "ik.sto", folder / trial / "id.sto", folder / trial / "XLD.mot",
                *(["--append"] if i else [folder / "gait2392.osim", subject]), "--plates", "left=l_ground_,right=ground_", "--trial",
                trial, "--role", "validate" if i else "train", "--out", out)

    def prepare(sinew, recordings, out):
        shutil.copy(recordings, out)
        for name, source, window, role in walking.TRIALS[:1]:
            run(sinew, "data", "cut", out, "--trial", source, "--window", window, "--as", name, "--role", role)
        for source in ("walk36", "walk45"):
            run(sinew, "data", "drop", out, "--trial", source)
        run(sinew, "data", "muscles", out, "--muscles", walking.MUSCLES, "--joints", "ankle_angle_r,knee_angle_r")

    return Pair("walking_emg", "nms", raw, (("excitations", "tib_ant_r|soleus_r|med_gas_r|lat_gas_r"), ("coordinates", "(ankle|knee)_angle_r"),
                                            ("id", "ankle_angle_r_moment")), {"walk36": (5, 25)}, prepare,
                ("--config", ROOT / "benchmarks" / "walking_emg" / "ankle.yaml"), swing=1.15, from_clean=True, cut={"walk36": ("walk36_fit",)})


def rat_soleus(_):
    rat = words_of("rat_soleus")

    def prepare(_, raw, out):
        grid = np.arange(0, 2 * rat.RATE + 1) / rat.RATE
        with h5py.File(raw) as recordings, h5py.File(out, "w") as file:
            file.attrs["sinew_schema"] = "dataset/1"
            file["files/subject.xml"] = rat.subject("textbook")
            file["files/nms.yaml"] = rat.settings("rigid", *rat.RICH)
            for name, trial in recordings["trials"].items():
                if trial.attrs["role"] not in ("train", b"train"):
                    continue
                moved, pulled = trial["motion"], trial["muscle"]
                at, places = np.unique(moved["time"][()], return_index=True)
                length = rat.spline(at, moved["channels/length"][()][places], grid)
                group = file.create_group(f"trials/{name}")
                group.attrs["role"] = "train"
                at, force = np.round(pulled["time"][()] * rat.RATE) / rat.RATE, pulled["channels/force"][()]
                keep = (at >= rat.BEGIN) & np.append(True, np.diff(at) > 0)
                for grid_name, moments, channel, values, unit, kind in (
                        ("excitations", grid, "soleus", np.ones_like(grid), "1", "input"),
                        ("lengths", grid, "soleus", length, "m", "input"),
                        ("moment_arms.pull", grid, "soleus", np.ones_like(grid), "m", "input"),
                        ("angle", grid, "pull", -length, "rad", "input"),
                        ("force", at[keep], "pull_moment", force[keep], "N*m", "measured")):
                    group[f"{grid_name}/time"] = moments
                    made = group.create_dataset(f"{grid_name}/channels/{channel}", data=values)
                    made.attrs["unit"] = unit
                    made.attrs["kind"] = kind

    return Pair("rat_soleus", "nms", real_sets.rat_soleus, (("motion", "length"), ("muscle", "force")),
                {f"amplitude_{i}": None for i in (2, 4, 6)}, prepare, ("--solver", "lm"), renamed={"force": "pull_moment", "length": "soleus"})


PAIRS = (gait_subject01, gait_walk3d, servo_xl330, servo_sts3250, cube_tosses, walking_emg, rat_soleus)

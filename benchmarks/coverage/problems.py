"""Truths and data of the coverage study: one function per problem, by seed. Nothing here is seen by the fit but the data."""
import re
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "benchmarks"), str(ROOT / "benchmarks" / "starts")]
from ceinms_truths import draw  # noqa: E402
from contact_coverage import SETTINGS  # noqa: E402

CEINMS = ROOT.parent / "shared" / "data" / "ceinms_example"

@dataclass
class Case:
    problem: str
    data: Path
    truth: dict
    words: list = field(default_factory=list)  # of identify
    samples: int = 0                           # fitted


def synthesize(sinew, problem, seed, data, values):
    sinew("data", "synthesize", problem, "--seed", seed, "--out", data, "--quiet",
          *[word for name, value in values.items() for word in ("--set", f"{name}={value!r}")])


def count(data, channels):
    """Finite samples of the training trials' channels."""
    total = 0
    with h5py.File(data) as file:
        for trial in file["trials"].values():
            if trial.attrs["role"] != "train":
                continue

            def add(path, node):
                nonlocal total
                if isinstance(node, h5py.Dataset) and re.fullmatch(channels, path):
                    total += int(np.isfinite(node[:]).sum())
            trial.visititems(add)
    return total


def contact(name, seed, folder, sinew, options):
    random = np.random.default_rng([1, seed])
    truth = {"stiffness": 10 ** random.uniform(5.7, 6.3), "dissipation": random.uniform(10, 100),
             "static_friction": random.uniform(0.7, 1.2)}
    truth["dynamic_friction"] = truth["static_friction"] * random.uniform(0.5, 0.9)
    truth["viscous_friction"] = random.uniform(0.3, 1.0)
    data, settings = folder / "data.h5", folder / "contact.yaml"
    settings.write_text(SETTINGS)
    synthesize(sinew, "contact", seed, data, {**truth, "slip": 0.2, "marker_noise": 0.0, "force_noise": 0.9})
    sinew("data", "kinematics", data, "--quiet")
    return Case("contact", data, truth, ["--config", settings], count(data, "plates/.*force_.*|.*/channels/.*force_.*"))


def drive(name, seed, folder, sinew, options):
    random = np.random.default_rng([2, seed])
    truth = {"inertia": 0.02 * 3 ** random.uniform(), "viscous_friction": random.uniform(0.02, 0.1),
             "gravity_torque": random.uniform(0.2, 1)}
    correlations = {"drive": [0, 0, 0.5, 0.8, 0.9], "drive_white": [0], "drive_ar": [0.5, 0.8, 0.9]}[name]
    noise = {"noise_rho": float(random.choice(correlations)), "known_noise": 0}
    data = folder / "data.h5"
    synthesize(sinew, "drive", seed, data, {**truth, **noise, "position_noise": 0.003})
    return Case("drive", data, truth, [], count(data, ".*/channels/position"))


def emg_shape(name, seed, folder, sinew, options):
    random = np.random.default_rng([3, seed])
    muscles = ["lat_gas_r", "med_gas_r", "per_long_r", "soleus_r", "tib_ant_r"]
    truth = {f"{muscle}.amplitude_exponent": random.uniform(-0.3, 0.8) for muscle in muscles}
    truth["lead"] = random.uniform(0.0, 0.3)
    data = folder / "data.h5"
    size = {"speeds": 4, "muscles": 2, "train": 5, "validate": 1} if name == "emg_shape_small" else {}
    synthesize(sinew, "emg_shape", seed, data, {**truth, **size, "subject": 1000 + seed, "moments": 0, "raw": 0})
    for muscle in muscles[size.get("muscles", 5):]:
        del truth[f"{muscle}.amplitude_exponent"]
    return Case("emg_shape", data, truth, [], count(data, "excitations/channels/.*"))


def nms_study(name, seed, folder, sinew, options):
    """The ankle of `data synthesize nms`: seven parameters, four trials."""
    random = np.random.default_rng([4, seed])
    truth = {"triceps.strength": random.uniform(0.6, 1.4), "peronei.strength": random.uniform(0.6, 1.4),
             "dorsiflexors.strength": random.uniform(0.6, 1.4), "plantarflexors.shape": random.uniform(-2.9, -0.1),
             "dorsiflexors.shape": random.uniform(-2.9, -0.1), "triceps.tendon_slack_length": random.uniform(0.96, 1.04),
             "dorsiflexors.tendon_slack_length": random.uniform(0.96, 1.04)}
    data = folder / "data.h5"
    synthesize(sinew, "nms", seed, data, {**truth, "electrodes": 0})
    return Case("nms", data, truth, [], count(data, "moments/channels/.*"))


ONE_AT_A_TIME = threading.Lock()


def import_ceinms(folder, tendon, sinew, options):
    """The project as a data set, and the ranges of its parameters; made once."""
    if tendon in options.projects:
        return options.projects[tendon]
    folder = options.work
    data, run = folder / f"project_{tendon}.h5", folder / f"start_{tendon}.h5"
    sinew("data", "ceinms", options.ceinms / "csetup_stiff.xml", "--validate", options.ceinms / "trial3" / "trial3.xml", "--out", data)
    with h5py.File(data, "r+") as file:
        settings = file["files/nms.yaml"][()].decode()
        del file["files/nms.yaml"]
        file["files/nms.yaml"] = settings.replace("tendon: rigid", f"tendon: {tendon}")
    sinew("identify", "nms", "--data", data, "--solver", "lm", "--max-evaluations", 1, "--intervals", "linear", "--quiet", "--out", run)
    with h5py.File(run) as file:
        table = file["parameters"]
        rows = zip(table["name"][:], table["lower"][:], table["upper"][:], table["free"][:])
        options.projects[tendon] = data, {name.decode(): (lower, upper) for name, lower, upper, free in rows if free}
    return options.projects[tendon]


def ceinms(name, seed, folder, sinew, options):
    """nms_TENDON_NOISE: the CEINMS example, 50 parameters, torques of the fitted model with white noise."""
    _, tendon, noise = name.split("_")
    tendon = {"elastic": "equilibrium"}.get(tendon, tendon)
    with ONE_AT_A_TIME:
        project, bounds = import_ceinms(folder, tendon, sinew, options)
    random = np.random.default_rng([20, int(float(noise) * 1000), seed])
    simulated, case = folder / "simulated.h5", folder / "case.h5"
    for _ in range(20):  # some drawn tendons have no equilibrium
        truth = draw(bounds, random)
        sets = [word for key, value in truth.items() for word in ("--set", f"{key}={value:.17g}")]
        try:
            sinew("simulate", "nms", "--data", project, *sets, "--out", simulated)
        except RuntimeError:
            continue
        if simulated.exists():
            break
    else:
        return None
    case.write_bytes(project.read_bytes())
    with h5py.File(simulated) as source, h5py.File(case, "r+") as target:
        for trial in target["trials"]:
            moments = target[f"trials/{trial}/moments/channels"]
            for channel in moments:
                exact = source[f"trials/{trial}/simulated/channels/{channel}"][:]
                moments[channel][...] = exact + float(noise) * random.standard_normal(len(exact))
    return Case("nms", case, truth, [], count(case, "moments/channels/.*"))


def make(name, seed, folder, sinew, options):
    """A Case, or None where no truth could be drawn."""
    if re.fullmatch(r"nms_(rigid|elastic)_[0-9.]+", name):
        return ceinms(name, seed, folder, sinew, options)
    functions = {"contact": contact, "drive": drive, "drive_white": drive, "drive_ar": drive, "emg_shape": emg_shape,
                 "emg_shape_small": emg_shape, "nms_study": nms_study}
    return functions[name](name, seed, folder, sinew, options)

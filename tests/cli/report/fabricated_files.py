"""Run and study files made up for tests, following docs/run_file.md; nothing in them was measured or simulated."""
import h5py
import numpy as np

TEXT = h5py.string_dtype("utf-8")


def put_texts(file, path, values):
    file.create_dataset(path, data=np.array(list(values), dtype=object), dtype=TEXT)


def write_run(path, trials=("stance_1", "stance_2", "stance_3"), validate=("stance_3",), seed=7, finished=1, usable=1,
              contact=("sole",), instants=33, faces=(8, 3), evaluations=60, starts=0, findings=None, stiffness=8.97e5,
              unused=True, title="made-up stances & <nothing measured>"):
    """A run of `contact` on made-up stances: two parameters determined, three not.

    contact: names of regions, each on a body of its own; unused: whether a channel is measured that is not fitted.
    """
    rng = np.random.default_rng(seed)
    with h5py.File(path, "w") as file:
        run = file.create_group("run")
        run.attrs.update({
            "sinew_schema": "run/1", "problem": "contact", "solver": "multistart+ceres" if starts else "sa+ceres",
            "seed": seed, "version": "0.1.0",
            "data_file": "stances.h5", "data_hash": "0123abcd", "finished": finished,
            "stop_reason": "converged" if usable else "budget spent", "stop_test": "relative cost change 2e-13 < 1e-10",
            "converged": usable, "usable": usable, "evaluations": evaluations, "failures": 2, "iterations": 14,
            "seconds": 0.0034, "cost": 161.2, "objective": "half the sum of squared force errors (N²)", "synthetic": 1,
            "title": title})
        put_texts(file, "run/findings", findings or [
            "The vertical force is matched to 2.1 N on fitted stances and 2.4 N on stances that were not fitted.",
            "Stiffness and dissipation are determined; static, dynamic and viscous friction are not: the vertical "
            "force on level ground does not depend on them.",
            "Measuring the tangential force would determine all three friction parameters."])
        put_texts(file, "run/warnings", ["2 simulations failed < 1 % of the time: depth beyond the mesh."])
        file["run"].create_dataset("config", data="solver: sa+ceres\nseed: 7\n", dtype=TEXT)
        _write_parameters(file, stiffness)
        _write_search(file, rng, evaluations, starts)
        for i, trial in enumerate(trials):
            _write_fit(file, rng, trial, "validate" if trial in validate else "train", instants, i, unused)
        for region in contact:
            _write_contact(file, trials[0], region, instants, faces)


def _write_parameters(file, stiffness):
    rows = [("stiffness", "N/m3", "pressure per depth", "base", "log", 1e4, 1e6, 1e5, stiffness, 1),
            ("dissipation", "s/m", "damping per depth rate", "base", "linear", 10, 600, 100, 106.4, 1),
            ("static_friction", "1", "friction before sliding", "base", "linear", 0.1, 15, 1, 1.0, 1),
            ("dynamic_friction", "1", "friction while sliding", "base", "linear", 0.1, 15, 1, 1.0, 1),
            ("viscous_friction", "s/m", "friction per sliding speed", "base", "linear", 0.1, 15, 1, 1.0, 1),
            ("transition_velocity", "m/s", "where sliding begins", "base", "linear", 1e-3, 0.1, 0.01, 0.01, 0),
            ("force_delay", "s", "force plate behind the markers", "effect", "linear", -0.1, 0.1, 0, 0, 0)]
    columns = list(zip(*rows))
    for key, column in zip(("name", "unit", "meaning", "kind", "scale"), columns[:5]):
        put_texts(file, f"parameters/{key}", column)
    for key, column in zip(("lower", "upper", "start", "value", "free"), columns[5:]):
        file[f"parameters/{key}"] = np.array(column, float)
    put_texts(file, "parameters/source", [""] * len(rows))
    put_texts(file, "parameters/effect", ["force_delay" if row[3] == "effect" else "" for row in rows])
    put_texts(file, "parameters/trial", [""] * len(rows))

    nan = np.nan
    put_texts(file, "uncertainty/name", columns[0][:5])
    put_texts(file, "uncertainty/verdict", ["identifiable"] * 2 + ["not_identifiable"] * 3)
    put_texts(file, "uncertainty/reason", ["", ""] + ["no measured channel depends on it"] * 3)
    put_texts(file, "uncertainty/reason_kind", ["determined"] * 2 + ["no_response"] * 3)
    put_texts(file, "uncertainty/remedy", ["", ""] + ["measuring right_force_x would determine it"] * 2
              + ["nothing that could be measured would"])
    put_texts(file, "uncertainty/remedy_kind", ["none"] * 2 + ["additions"] * 2 + ["no_channel"])
    put_texts(file, "uncertainty/interval", ["profile", "profile", "none", "none", "none"])
    file["uncertainty/std_error"] = [5.6e3, 3.1, nan, nan, nan]
    file["uncertainty/std_error_robust"] = [7.0e3, 3.9, nan, nan, nan]
    file["uncertainty/ci95_lower"] = [stiffness - 1.1e4, 100.1, nan, nan, nan]
    file["uncertainty/ci95_upper"] = [stiffness + 1.1e4, 112.9, nan, nan, nan]
    correlation = np.full((5, 5), nan)
    correlation[:2, :2] = [[1, -0.62], [-0.62, 1]]
    file["uncertainty/correlation"] = correlation
    file["uncertainty/covariance"] = correlation
    file["uncertainty/singular_values"] = [12.0, 3.0, 0.0, 0.0, 0.0]
    put_texts(file, "uncertainty/directions", ["any mixture of static, dynamic and viscous friction"])


def _write_search(file, rng, evaluations, starts):
    cost = 161.2 + 5e4 * np.exp(-np.arange(evaluations) / (evaluations / 8)) * rng.lognormal(0, 0.8, evaluations)
    cost[-1] = 161.2
    cost[[3, 9]] = np.inf
    file["trace/seconds"] = np.linspace(0, 0.0034, evaluations)
    file["trace/cost"] = cost
    file["trace/x"] = rng.random((evaluations, 5))
    file["trace"].attrs["variables"] = "stiffness,dissipation,static_friction,dynamic_friction,viscous_friction"
    solvers = ["ceres"] * starts if starts else ["sa", "ceres"]
    share = evaluations // len(solvers)
    put_texts(file, "stages/solver", solvers)
    put_texts(file, "stages/stop_reason", ["converged"] * len(solvers))
    ends = 161.2 + np.where(rng.random(len(solvers)) < 0.7, 1e-6, 400 * rng.random(len(solvers)))
    file["stages/cost"] = ends if starts else [900.0, 161.2]
    used = np.full(len(solvers), float(share))
    file["stages/evaluations"] = used if starts else [0.8 * evaluations, 0.2 * evaluations]
    file["stages/x"] = rng.random((len(solvers), 5))


def _force(phase):
    return 57 * np.clip(np.sin(np.pi * phase), 0, None) ** 0.6 * (1 + 0.25 * np.cos(4 * np.pi * phase))


def _write_fit(file, rng, trial, role, instants, index, unused):
    """The vertical force fitted, the sideways force measured only (if `unused`), the forward force not even that."""
    time = np.linspace(0, 0.6, instants) + 0.02 * index
    simulated = _force((time - time[0]) / 0.6) * (1 + 0.03 * index)
    measured = _force((time - time[0] - 0.008) / 0.6) * (1 + 0.03 * index) + rng.normal(0, 0.9, instants)
    measured[instants // 2] = np.nan
    _write_channel(file, trial, "right_force_y", "vertical force", role, time, simulated, measured)
    nothing = np.full(instants, np.nan)
    _write_channel(file, trial, "right_force_x", "forward force", "predicted", time, 6 * np.sin(9 * time), nothing)
    if unused:
        _write_channel(file, trial, "right_force_z", "sideways force", "predicted", time, 0.1 * simulated,
                       0.3 * measured)


def _write_channel(file, trial, channel, quantity, role, time, simulated, measured):
    ok = np.isfinite(measured)
    residual = (simulated - measured)[ok]
    node = file.create_group(f"prediction/{trial}/{channel}")
    node.attrs.update({"unit": "N", "quantity": quantity, "role": role, "n": int(ok.sum()),
                       "rmse": np.nan, "r2": np.nan})
    node["time"], node["simulated"], node["measured"] = time, simulated, measured
    if ok.any():
        node.attrs["rmse"] = np.sqrt(np.mean(residual ** 2))
        node.attrs["r2"] = 1 - np.mean(residual ** 2) / measured[ok].var()
        left = file.create_group(f"residual/{trial}/{channel}")
        left.attrs.update({"unit": "N", "role": role})
        left["time"], left["residual"] = time[ok], residual


def _write_contact(file, trial, region, instants, faces):
    """A sole of 0.16 m x 0.07 m that rolls from heel to toe; a region named left carries nothing but its edge."""
    rows, columns = faces
    side = -1 if "left" in region else 1
    x, z = np.meshgrid(np.linspace(-0.05, 0.11, rows + 1), np.linspace(-0.035, 0.035, columns + 1), indexing="ij")
    z = z * (0.75 + 0.35 * np.sin(np.pi * (x + 0.05) / 0.2)) + side * 0.006 * np.sin(np.pi * (x + 0.05) / 0.16)
    corner = np.stack([x, z], axis=-1)
    lower = np.stack([corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:]], axis=2).reshape(-1, 3, 2)
    upper = np.stack([corner[:-1, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=2).reshape(-1, 3, 2)
    outline = np.concatenate([lower, upper])
    centre = outline.mean(axis=1)
    time = np.linspace(0, 0.6, instants)
    phase = time[:, None] / 0.6
    load = _force(phase if side > 0 else np.clip(phase - 0.6, 0, 1))
    rolling = -0.03 + 0.11 * (phase if side > 0 else np.clip(phase - 0.6, 0, 1))
    bulge = np.exp(-((centre[:, 0] - rolling) / 0.03) ** 2 - (centre[:, 1] / 0.03) ** 2)
    area = 0.5 * np.abs(np.cross(outline[:, 1] - outline[:, 0], outline[:, 2] - outline[:, 0]))
    pressure = np.where(bulge > 0.05, bulge, 0)
    pressure = load * pressure / (pressure @ area)[:, None]
    node = file.create_group(f"details/contact/{trial}/{region}")
    node.attrs.update({"body": region, "plate": "right", "group": "sole"})
    weights = pressure * area
    total = weights.sum(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        node["centre_of_pressure"] = np.where(total > 0.5, weights @ centre / total, np.nan)
    node["time"], node["outline"], node["pressure"], node["slip"] = time, outline, pressure, 0.004 * bulge


def write_study(path, seed=3, repeats=10):
    """Three solvers on one problem: one always succeeds, one sometimes, one never."""
    rng = np.random.default_rng(seed)
    solvers = np.repeat(["ceres", "sa", "nlopt:LN_COBYLA"], repeats)
    hit = np.concatenate([np.ones(repeats), rng.random(repeats) < 0.7, np.zeros(repeats)])
    count = len(solvers)
    used = np.where(solvers == "ceres", 22, np.where(solvers == "sa", 5000, 900)) * rng.lognormal(0, 0.2, count)
    with h5py.File(path, "w") as file:
        study = file.create_group("study")
        study.attrs.update({"sinew_schema": "study/1", "problem": "contact", "target": 162.8})
        put_texts(file, "study/parameters/name", ["stiffness", "dissipation", "static_friction"])
        put_texts(file, "study/runs/solver", solvers)
        put_texts(file, "study/runs/stop_reason", ["converged"] * count)
        file["study/runs/seed"] = np.tile(np.arange(repeats, dtype=float), 3)
        file["study/runs/cost"] = np.where(hit > 0, 161.2 + 1.2 * rng.random(count), 170 + 900 * rng.random(count))
        file["study/runs/success"] = hit
        file["study/runs/evaluations"] = used
        file["study/runs/evaluations_to_target"] = np.where(hit > 0, 0.7 * used, np.nan)
        file["study/runs/seconds"] = 1.5e-4 * used
        file["study/runs/seconds_to_target"] = np.where(hit > 0, 1.05e-4 * used, np.nan)
        file["study/runs/values"] = np.column_stack([8.97e5 * rng.lognormal(0, 0.01, count), rng.normal(106, 2, count),
                                                     rng.uniform(0.1, 15, count)])

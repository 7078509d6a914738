"""A diagnosis file made up for tests, following docs/run_file.md; nothing in it was measured or simulated."""
import h5py
import numpy as np

from fabricated_files import put_texts

PARAMETERS = [("inertia", "kg*m2", "of link and rotor", "base", "", 0.001, 0.1, 0.01, 0.0121),
              ("viscous_friction", "N*m*s/rad", "torque per speed", "base", "", 0, 1, 0.05, 0.034),
              ("coulomb_torque", "N*m", "torque against any motion", "effect", "coulomb", 0, 2, 0, 0.31),
              ("stribeck_velocity", "rad/s", "where sticking ends", "effect", "stribeck", 0.001, 1, 0.05, 0.05)]
SCORES = [("coulomb", "robot", "cause", 1, 312.0, 1e-40, 0.0005, 1, 1, 301.0, 293.2, "coulomb_torque", "N*m", 0.012),
          ("stribeck", "robot", "alternative", 2, 305.0, 1e-38, 0.0005, 1, 1, 297.9, 284.0, "", "", np.nan),
          ("torque(velocity)", "robot", "unknown_term", 4, 180.0, 1e-30, 0.0005, 0, 1, 170.0, 140.0, "", "", np.nan),
          ("position.gain", "sensor", "withdrawn", 1, 60.0, 1e-9, 0.0005, 1, 1, 44.0, 36.0, "position.gain", "1", 0.02),
          ("position.time_offset", "sensor", "ruled_out", 1, 5.2, 0.02, 0.4, 1, 0, np.nan, np.nan,
           "position.time_offset", "s", 0.004),
          ("gravity_imbalance", "robot", "ruled_out", 2, 2.0, 0.36, 1.0, 1, 0, np.nan, np.nan, "imbalance", "N*m", 0.05),
          ("position.drift", "sensor", "not_judged", 1, 0.0, 1.0, 1.0, 1, 0, np.nan, np.nan, "", "", np.nan)]
MANY = [(f"effect_{i:02}", "sensor", "ruled_out", 1, 2.0 / (i + 1), 0.5, 1.0, 1, 0, np.nan, np.nan, f"size_{i:02}", "N", 0.1)
        for i in range(40)]

LADDER = (("", 1.0), ("coulomb", 0.41), ("coulomb,position.gain", 0.38), ("coulomb,stribeck,position.gain", 0.40))
SHARES = (("coulomb", 0.97), ("position.gain", 0.31), ("stribeck", 0.03), ("position.time_offset", 0.004))


def put_table(file, path, **columns):
    for name, values in columns.items():
        if all(isinstance(value, str) for value in values):
            put_texts(file, f"{path}/{name}", values)
        else:
            file[f"{path}/{name}"] = np.array(values, float)


def put_diagnosed(file, path, rows):
    """rows: (effect, name, unit, value, standard error, before)"""
    effect, name, unit, value, error, before = zip(*rows) if rows else [[]] * 6
    put_texts(file, f"{path}/effect", effect)
    put_texts(file, f"{path}/name", name)
    put_texts(file, f"{path}/unit", unit)
    value, error = np.array(value, float), np.array(error, float)
    put_table(file, path, value=value, std_error=error, ci95_lower=value - 1.96 * error,
              ci95_upper=value + 1.96 * error, before=np.array(before, float))


def write_diagnosis(path, verdict="ambiguous", trials=("slow", "fast", "check"), validate=("check",), usable=1, found=True,
                    channels=("position", "speed"), many=False, ladder=LADDER,
                    title="made-up joint & <nothing measured>"):
    """A joint whose Coulomb friction was forgotten; found=False: nothing is wrong. usable=0: no base fit. ladder: of a
    choice by cross-validation; (): there was none."""
    rng = np.random.default_rng(3)
    with h5py.File(path, "w") as file:
        run = file.create_group("run")
        run.attrs.update({
            "sinew_schema": "run/1", "problem": "drive", "solver": "diagnose", "seed": 7, "version": "0.1.0",
            "data_file": "joint.h5", "data_hash": "0123abcd", "finished": 1, "synthetic": 1, "title": title,
            "stop_reason": "cost_change" if usable else "max_evaluations", "stop_test": "relative cost change 2e-13 < 1e-12",
            "converged": usable, "usable": 1, "iterations": 14, "seconds": 2.3, "cost": 161.2,
            "objective": "half the sum of squared weighted residuals"})
        diagnosis = file.create_group("diagnosis")
        diagnosis.attrs.update({"sinew_schema": "diagnosis/1", "verdict": verdict if usable else "unexplained",
                                "alarm_level": 0.05, "threshold": 2.95, "family_p_value": 0.0005 if found else 0.41})
        put_texts(file, "run/config", [])
        del file["run/config"]
        sentences = ["Misfit beyond chance (family-wise p < 0.001): more than one known cause could explain it.",
                     "Cause [robot]: dry friction brakes the joint (coulomb); coulomb_torque = 0.31 N*m +-0.02.",
                     "Could also be [robot]: friction that falls with speed (stribeck); delta LR 3.1. To distinguish them: "
                     "a trial with very slow motion.",
                     "Held-out trials, position: 0.0312 -> 0.0041 rad RMSE (-87 %, 95 % interval -91 .. -82 %)."]
        kinds = ["verdict", "cause", "alternative", "gain"]
        if not found:
            sentences, kinds = ["Adequate: no effect in the library improves the fit beyond chance (family-wise p = 0.41)."], ["verdict"]
        if not usable:
            sentences, kinds = ["Nothing can be concluded: the base fit did not converge."], ["inconclusive"]
        for group in ("run/findings", "diagnosis/sentences"):
            put_texts(file, group, sentences)
        put_texts(file, "diagnosis/sentence_kinds", kinds)
        for group in ("run/warnings", "diagnosis/warnings"):
            put_texts(file, group, ["position of 'fast' saturates < 1 % of the time"])
        put_table(file, "trace", seconds=[], cost=[])
        file["trace/x"] = np.zeros((0, 2))
        scores = (SCORES + MANY * many if found else [(*row[:2], "ruled_out", *row[3:4], 1.5, 0.3, 0.6, *row[7:])
                                                      for row in SCORES]) * usable
        columns = list(zip(*scores)) if scores else [[]] * 14
        for key, column in zip(("effect", "level", "finding"), columns[:3]):
            put_texts(file, f"diagnosis/scores/{key}", column)
        for key, column in zip(("degrees", "statistic", "p_value", "family_p_value", "known", "refitted", "delta_lr",
                                "delta_bic"), columns[3:11]):
            file[f"diagnosis/scores/{key}"] = np.array(column, float)
        put_texts(file, "diagnosis/scores/detectable_parameter", columns[11])
        put_texts(file, "diagnosis/scores/detectable_unit", columns[12])
        file["diagnosis/scores/smallest_detectable"] = np.array(columns[13], float)
        file["diagnosis/scores/judged"] = np.array([finding != "not_judged" for finding in columns[2]], float)
        put_texts(file, "diagnosis/scores/probe", [""] * len(scores))
        put_texts(file, "diagnosis/scores/why_not", ["the base parameters compensate it fully" if finding == "not_judged" else ""
                                                     for finding in columns[2]])
        _write_findings(file, bool(found and usable), channels)
        for name, column, number, rows in (("ladder", "effects", "error", ladder),
                                           ("chosen_shares", "effect", "share", ladder and SHARES)):
            put_texts(file, f"diagnosis/{name}/{column}", [row[0] for row in rows])
            file[f"diagnosis/{name}/{number}"] = np.array([row[1] for row in rows], float)
        if usable:
            _write_extended(file, rng, bool(found), trials, validate, channels)


def _write_findings(file, found, channels):
    put_texts(file, "diagnosis/causes/effect", ["coulomb"] * found)
    put_texts(file, "diagnosis/causes/level", ["robot"] * found)
    put_texts(file, "diagnosis/causes/sentence", ["dry friction brakes the joint"] * found)
    for key, value in (("p_value", 1e-40), ("delta_lr", 301.0), ("delta_bic", 293.2), ("size", 4.8)):
        file[f"diagnosis/causes/{key}"] = np.array([value] * found, float)
    put_diagnosed(file, "diagnosis/cause_parameters", [("coulomb", "coulomb_torque", "N*m", 0.31, 0.01, 0)] * found)
    put_texts(file, "diagnosis/alternatives/instead_of", ["coulomb"] * found)
    put_texts(file, "diagnosis/alternatives/effect", ["stribeck"] * found)
    put_texts(file, "diagnosis/alternatives/level", ["robot"] * found)
    put_texts(file, "diagnosis/alternatives/sentence", ["friction that falls with speed"] * found)
    put_texts(file, "diagnosis/alternatives/separated_by", ["a trial with very slow motion"] * found)
    for key, value in (("delta_lr", 3.1), ("delta_bic", 9.0), ("correlation", 0.96), ("same_class", 0),
                       ("separating_size", np.inf)):
        file[f"diagnosis/alternatives/{key}"] = np.array([value] * found, float)
    put_diagnosed(file, "diagnosis/alternative_parameters", [("stribeck", "stribeck_torque", "N*m", 0.33, 0.02, 0)] * found)
    put_texts(file, "diagnosis/withdrawn/effect", ["position.gain"] * found)
    put_texts(file, "diagnosis/withdrawn/reason", ["it does not generalise to the held-out trials"] * found)
    if found:
        knots = np.linspace(-3, 3, 13)
        for i, (signal, share) in enumerate((("velocity", 0.63), ("position", 0.08))):
            group = file.create_group(f"diagnosis/structure/{i + 1}")
            group.attrs.update({"channel": channels[0], "signal": signal, "signal_unit": "rad/s", "shape": "odd, step at zero",
                                "explained_fraction": share})
            group["knots"], group["curve"] = knots, 0.03 * np.tanh(4 * knots) * share
        group = file.create_group("diagnosis/unknown_terms/1")
        group.attrs.update({"port": "torque", "signal": "velocity", "signal_unit": "rad/s", "unit": "N*m", "p_value": 1e-12,
                            "shape": "odd, step at zero", "nearest_law": "Coulomb friction", "held_out_reduction": 0.22})
        group["knots"], group["curve"], group["deviation"] = knots, 0.3 * np.tanh(4 * knots), 0.02 + 0.004 * knots ** 2


def _write_extended(file, rng, found, trials, validate, channels):
    rows = PARAMETERS
    columns = list(zip(*rows))
    for key, column in zip(("name", "unit", "meaning", "kind", "effect"), columns[:5]):
        put_texts(file, f"parameters/{key}", column)
    for key, column in zip(("lower", "upper", "start", "value"), columns[5:]):
        file[f"parameters/{key}"] = np.array(column, float)
    for key in ("source", "trial"):
        put_texts(file, f"parameters/{key}", [""] * len(rows))
    put_texts(file, "parameters/scale", ["linear"] * len(rows))
    file["parameters/free"] = np.array([1, 1, found, 0], float)
    file["parameters/before"] = np.array([0.0124, 0.081, 0, 0.05])
    if not found:  # nothing was added: the extended model is the base model
        file["parameters/value"][:] = file["parameters/before"][:]
    base = [("", "inertia", "kg*m2", 0.0124, 0.0002, 0.0124), ("", "viscous_friction", "N*m*s/rad", 0.081, 0.004, 0.081)]
    after = [("", "inertia", "kg*m2", 0.0121, 0.0002, 0.0124), ("", "viscous_friction", "N*m*s/rad", 0.034, 0.003, 0.081),
             ("", "coulomb_torque", "N*m", 0.31, 0.01, 0)]
    put_diagnosed(file, "diagnosis/base_parameters", base)
    put_diagnosed(file, "diagnosis/extended_parameters", after if found else base)
    for group, errors in (("base_fit", (0.028, 0.031)), ("extended_fit", (0.0035, 0.0041))):
        errors = errors if found else (0.0035, 0.0041)
        put_texts(file, f"diagnosis/{group}/role", ["train", "validate"] * len(channels))
        put_texts(file, f"diagnosis/{group}/channel", [channel for channel in channels for _ in range(2)])
        put_texts(file, f"diagnosis/{group}/unit", ["rad"] * 2 * len(channels))
        put_table(file, f"diagnosis/{group}", rmse=list(errors) * len(channels), r2=[0.95, 0.94] * len(channels),
                  n=[400, 200] * len(channels))
    put_texts(file, "diagnosis/noise/channel", channels)
    put_texts(file, "diagnosis/noise/unit", ["rad"] * len(channels))
    put_texts(file, "diagnosis/noise/basis", ["stated by the data"] * len(channels))
    put_table(file, "diagnosis/noise", sigma=[0.003] * len(channels), rmse=[0.028] * len(channels))
    put_texts(file, "diagnosis/tests/channel", channels)
    put_texts(file, "diagnosis/tests/test", ["Ljung-Box"] * len(channels))
    put_table(file, "diagnosis/tests", statistic=[400.0] * len(channels), p_value=[1e-30] * len(channels))
    held_out = len(channels) if validate else 0
    put_texts(file, "diagnosis/gain/channel", channels[:held_out])
    put_texts(file, "diagnosis/gain/unit", ["rad"] * held_out)
    put_table(file, "diagnosis/gain", before=[0.0312] * held_out, after=[0.0041 if found else 0.0312] * held_out,
              reduction=[0.87 * found] * held_out, ci95_lower=[0.82 * found] * held_out,
              ci95_upper=[0.91 * found] * held_out, gap_closed=[0.98 if found else np.nan] * held_out)
    for i, trial in enumerate(trials):
        for channel in channels:
            time = np.linspace(0, 10, 200)
            truth = np.sin((0.6 + 0.4 * i) * time)
            measured = truth + 0.003 * rng.standard_normal(time.size)
            before = truth + 0.03 * found * np.sign(np.cos((0.6 + 0.4 * i) * time))
            role = "validate" if trial in validate else "train"
            group = file.create_group(f"diagnosis/traces/{trial}/{channel}")
            group.attrs.update({"role": role, "unit": "rad"})
            group["time"], group["measured"], group["before"], group["after"] = time, measured, before, truth
            group = file.create_group(f"prediction/{trial}/{channel}")
            group.attrs.update({"unit": "rad", "quantity": channel, "role": role, "n": time.size, "rmse": 0.003, "r2": 0.99})
            group["time"], group["simulated"], group["measured"] = time, truth, measured

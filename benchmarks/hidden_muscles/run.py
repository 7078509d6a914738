#!/usr/bin/python3
"""Hides effects in the synthetic ankle study (problem nms), runs the diagnosis on the files, and counts.

Each case: the program synthesizes a data set (electrodes and moment noise at their defaults) with one effect whose size is
known here and nowhere in the file; `sinew diagnose nms` sees the data only. A size is in units of what an oracle just detects:
the change of what the fitted model leaves over, by the effect and without noise, taken off the span of the base parameters,
has norm 3.605 times the noise (see ../hidden_effects/README.md, whose counts these are).

usage: run.py --sinew PATH [--kind none,single,outsider,further] [--cases 100] [--sizes 1,2,3] [--jobs 2] [--first-seed 1]
              [--out results.json]        run.py --merge results.json...
"""
import random
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "hidden_effects"))
from counting import compare, run  # noqa: E402
from studies import diagnose, run_studies, study_parser, synthesize  # noqa: E402

UNIT = 3.605
JOINT = "ankle_angle_r"
CHANNEL = JOINT + "_moment"
NOISE = 1.0  # [N m], the study's default
BASE = ("triceps.strength", "peronei.strength", "dorsiflexors.strength", "plantarflexors.shape", "dorsiflexors.shape",
        "triceps.tendon_slack_length", "dorsiflexors.tendon_slack_length")
# Effect: its parameters with a small amplitude, and whether it has two signs.
EFFECTS = {
    "emg_drift": ({"emg_drift": 0.003}, True),
    "co_contraction": ({"co_contraction": 0.003}, True),
    "cross_talk": ({"cross_talk": 0.02}, False),
    "longer_delay": ({"longer_delay": 0.002}, True),
    "slower_activation": ({"slower_activation": 0.05}, True),
    "force_enhancement": ({"force_enhancement": 0.05}, False),
    "force_depression": ({"force_depression": 0.05}, False),
    "compliant_tendon": ({"compliant_tendon": 0.1}, False),
    "contraction_velocity": ({"contraction_velocity": 0.03}, True),
    "length_by_activation": ({"length_by_activation": 0.02}, True),
    "fibre_length": ({"fibre_length": 0.02}, True),
    "arm_offset." + JOINT: ({"arm_offset." + JOINT: 0.001}, True),
    "angle_offset." + JOINT: ({"angle_offset." + JOINT: 0.01}, True),
    "missing_muscle_plus." + JOINT: ({"missing_muscle_plus." + JOINT: 2}, False),
    "missing_muscle_minus." + JOINT: ({"missing_muscle_minus." + JOINT: 5}, False),
    "passive_stiffness." + JOINT: ({"passive_stiffness." + JOINT: 1}, False),
    "joint_damping." + JOINT: ({"joint_damping." + JOINT: 0.2}, False),
    "inertial_moment." + JOINT: ({"inertial_moment." + JOINT: 0.02}, True),
    "segment_weight." + JOINT: ({"weight_sine." + JOINT: 1, "weight_cosine." + JOINT: 0.3}, True),
    "machine_friction." + JOINT: ({"machine_friction." + JOINT: 0.3}, False),
    "emg_gain@train_90": ({"emg_gain@train_90": 0.02}, True),
    "emg_offset@train_90": ({"emg_offset@train_90": 0.003}, True),
    CHANNEL + ".offset": ({CHANNEL + ".offset": 0.3}, True),
    CHANNEL + ".drift": ({CHANNEL + ".drift": 0.05}, True),
    CHANNEL + ".time_offset": ({CHANNEL + ".time_offset": 0.002}, True),
    CHANNEL + ".low_pass": ({CHANNEL + ".low_pass": 0.002}, False),
}
OUTSIDERS = {"ripple": 0.5, "tension_curve": 10, "tremor": 0.5, "soleus_fades": 0.005, "loose_electrode": 0.02}
# Added after the rules of the diagnosis had been chosen.
FURTHER_OUTSIDERS = {"bent_arms": 0.01, "directional_force": 0.01}


class Sizing:
    """Change of the residual of the model with the true base parameters by an amplitude."""

    def __init__(self, options, folder, seed):
        self.options, self.folder, self.seed = options, folder, seed
        self.base = draw_base(seed)

    def prepare(self):
        clean = self.recorded(None, 0, noise=False)
        self.trials = [t for t in sorted(clean) if t.startswith("train")]
        at = self.model(self.data, self.base)
        columns = []
        for name, value in self.base.items():
            step = 1e-4 * abs(value)
            columns.append((self.model(self.data, {**self.base, name: value + step}) - at) / step)
        self.directions, _ = np.linalg.qr(np.array(columns).T)
        self.left = self.stack(clean) - at

    def stack(self, moments):
        return np.concatenate([moments[t] for t in self.trials])

    def recorded(self, effect, amplitude, noise):
        """Synthesizes; leaves the file at self.data."""
        self.data = self.folder / ("case.h5" if noise else "clean.h5")
        words = [f"--set={n}={v!r}" for n, v in self.base.items()]
        if not noise:
            words += ["--set=moment_noise=0", "--set=electrodes=0"]
        for name, number in parameters_of(effect, amplitude).items():
            words += ["--effect", f"{effect}:{name}={number!r}"]
        self.data.unlink(missing_ok=True)
        synthesize(self.options, "nms", self.seed, words, self.data)
        with h5py.File(self.data) as file:
            return {t: file[f"trials/{t}/moments/channels/{CHANNEL}"][:] for t in file["trials"]}

    def model(self, data, base):
        out = self.folder / "model.h5"
        out.unlink(missing_ok=True)
        status, _, message = run(self.options.sinew, "simulate", "nms", "--data", data, "--out", out,
                                 *[w for n, v in base.items() for w in ("--set", f"{n}={v!r}")])
        if status != 0:
            raise ValueError(message)
        with h5py.File(out) as file:
            return np.concatenate([file[f"trials/{t}/simulated/channels/{CHANNEL}"][:] for t in self.trials])

    def signature(self, effect, amplitude):
        change = self.stack(self.recorded(effect, amplitude, noise=False)) - self.model(self.data, self.base) - self.left
        return change - self.directions @ (self.directions.T @ change)

    def size(self, effect, amplitude):
        return float(np.linalg.norm(self.signature(effect, amplitude))) / NOISE / UNIT

    def amplitude(self, effect, size, sign):
        """Of the wanted size: secants on a curve that is nearly a straight line."""
        guess = sign
        for _ in range(8):
            got = self.size(effect, guess)
            if got == 0:
                raise ValueError(f"{effect} does not show")
            if abs(got / size - 1) < 0.02:
                return guess
            guess *= min(5.0, max(0.2, size / got))
        raise ValueError(f"{effect} does not reach the size {size}")


def parameters_of(effect, amplitude):
    if effect is None:
        return {}
    outsiders = {**OUTSIDERS, **FURTHER_OUTSIDERS}
    if effect in outsiders:
        return {effect: amplitude * outsiders[effect]}
    null = 1.0 if effect.endswith(".gain") else 0.0
    return {name: null + amplitude * unit for name, unit in EFFECTS[effect][0].items()}


def draw_base(seed):
    own = random.Random(seed)
    return {"triceps.strength": own.uniform(0.7, 1.1), "peronei.strength": own.uniform(0.8, 1.25),
            "dorsiflexors.strength": own.uniform(0.8, 1.2), "plantarflexors.shape": own.uniform(-2, -0.6),
            "dorsiflexors.shape": own.uniform(-2, -0.6), "triceps.tendon_slack_length": own.uniform(0.98, 1.02),
            "dorsiflexors.tendon_slack_length": own.uniform(0.97, 1.02)}


def correlations(options):
    """Of every two effects' signatures, in the study of the first seed, for the pairs that cannot be distinguished."""
    with tempfile.TemporaryDirectory(prefix="hidden_muscles_") as folder:
        sizing = Sizing(options, Path(folder), options.first_seed)
        sizing.prepare()
        lines = {}
        for name in EFFECTS:
            line = sizing.signature(name, 1)
            lines[name] = line / np.linalg.norm(line)
    return {a: {b: abs(float(lines[a] @ lines[b])) for b in lines if b != a} for a in lines}


def study(options, kind, size, seed):
    case = {"kind": "outsider" if kind == "further" else kind, "size": size, "noise": "white", "seed": seed}
    own = random.Random(1000003 * seed + int(100 * size) + {"none": 0, "single": 1, "outsider": 2, "further": 3}[kind])
    drawn = {"none": {}, "single": EFFECTS, "outsider": OUTSIDERS, "further": FURTHER_OUTSIDERS}[kind]
    with tempfile.TemporaryDirectory(prefix="hidden_muscles_") as folder:
        folder = Path(folder)
        sizing = Sizing(options, folder, seed)
        if kind != "none":
            sizing.prepare()
        effect, amplitude = None, 0
        while kind != "none":
            effect = own.choice(options.effect or sorted(drawn))
            sign = own.choice([-1, 1]) if kind == "single" and EFFECTS[effect][1] else 1
            try:
                amplitude = sizing.amplitude(effect, size, sign)
                break
            except ValueError as error:  # a size that sensible values cannot reach: another effect
                case.setdefault("drawn_again", []).append(f"{effect}: {error}")
        sizing.recorded(effect, amplitude, noise=True)
        truth = {"base": sizing.base, "effects": []}
        if effect is not None:
            truth["effects"].append({"name": effect, "parameters": parameters_of(effect, amplitude), "statistic": UNIT * size,
                                     "correlations": options.correlations.get(effect, {})})
        case["truth"] = truth
        try:
            found, case["seconds"] = diagnose(options, "nms", sizing.data, folder)
        except ValueError as error:
            case["failure"] = str(error)
            return case
        compare(case, truth, found)
    return case


def find_correlations(options, _):
    options.correlations = correlations(options)


def main():
    parser = study_parser(__doc__, "an oracle")
    options = parser.parse_args()
    run_studies(parser, options, "hidden_muscles", study, find_correlations)


if __name__ == "__main__":
    sys.exit(main())

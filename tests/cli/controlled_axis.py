"""A linear axis behind a position controller, simulated here: neither the program nor its laboratory takes part.

M dv/dt = F - b v - c sign(v) + offset, F = kp e + kd (e - e_before) / period of e = reference + reference_offset - position.
"""
import h5py
import numpy as np

PERIOD = 0.005  # [s] of the controller
MASS, VISCOUS, KP, KD = 8.0, 30.0, 900.0, 100.0
SETTINGS = ("drive:\n  fit: [{fit}]\n  hold: zero\n  controller: {{kind: pid_position, kp: 900, ki: 0, kd: 100, "
            "control_period: 0.005, output: torque}}\n")


def reference(t, trial):
    """A sum of sines [m] that is 0 at first."""
    sines = ((0.05, 3.1), (0.03, 7.3), (0.01, 17.9))
    return sum(a * np.sin(w * (1 + 0.07 * trial) * t + 0.4 * trial * k) - a * np.sin(0.4 * trial * k)
               for k, (a, w) in enumerate(sines))


def simulated(trial, duration, coulomb, offset, reference_offset):
    """(time, reference, position, force), sampled at the ticks."""
    time = np.arange(round(duration / PERIOD)) * PERIOD
    asked = reference(time, trial)
    position, speed, before = 0.0, 0.0, None
    positions, forces = [], []
    steps = 20
    for goal in asked:
        error = goal + reference_offset - position
        force = KP * error + (KD * (error - before) / PERIOD if before is not None else 0)
        before = error
        positions.append(position)
        forces.append(force)
        for _ in range(steps):
            h = PERIOD / steps
            friction = coulomb * np.sign(speed) if coulomb else 0
            middle = speed + h / 2 * (force - VISCOUS * speed - friction + offset) / MASS
            position += h * middle
            speed += h * (force - VISCOUS * middle - friction + offset) / MASS
    return time, asked, np.array(positions), np.array(forces)


def write_axis(path, fit="position, force", train=3, validate=2, duration=4, coulomb=0.0, offset=0.0, reference_offset=0.0,
               seed=1, noise=1e-4, force_noise=0.5, settings=None):
    """A data set of such an axis. Noise is stated: `noise` [m] of the position, `force_noise` [N]."""
    random = np.random.default_rng(seed)
    with h5py.File(path, "w") as file:
        file.attrs.update(sinew_schema="dataset/1", title="axis", subject="", source="simulated", licence="", synthetic=1)
        file.create_group("constants")
        file["files/drive.yaml"] = settings or SETTINGS.format(fit=fit)
        for i in range(train + validate):
            time, asked, position, force = simulated(i, duration, coulomb, offset, reference_offset)
            trial = file.create_group(f"trials/{'train' if i < train else 'validate'}_{i + 1}")
            trial.attrs["role"] = "train" if i < train else "validate"
            trial.attrs["task"] = "axis"
            grid = trial.create_group("axis")
            grid["time"] = time
            for name, unit, kind, values, sigma in (
                    ("reference", "m", "input", asked, None),
                    ("position", "m", "measured", position + noise * random.standard_normal(time.size), noise),
                    ("force", "N", "measured", force + force_noise * random.standard_normal(time.size), force_noise)):
                grid[f"channels/{name}"] = values
                grid[f"channels/{name}"].attrs.update(unit=unit, kind=kind)
                if sigma is not None:
                    grid[f"channels/{name}"].attrs["sigma"] = sigma
    return path

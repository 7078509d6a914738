"""Joints with several things wrong at once, drawn by seed. The laboratory's simulator (`sinew data synthesize drive`) shares no code with
the fitted model."""
import math
import random
from dataclasses import dataclass, field

# Effects that nothing which can be measured here tells apart, or only by their size: a name of a class stands for all of it.
CLASSES = (
    {"command_delay", "torque.time_offset", "position.time_offset", "position.low_pass", "torque.low_pass", "hold"},
    {"torque_offset", "torque.offset"},
    {"position.offset", "gravity_imbalance"},
    {"coulomb_friction", "asymmetric_friction"},  # the second contains the first
    {"supply_sag"},
)
OUTSIDERS = ("wear", "tight_spot", "hysteretic_spring", "end_stop", "torque_bump", "lost_load", "eccentric_encoder",
             "drifting_damping", "coarse_command", "hum")
# Sizes of the drawn joint, filled in by joint().
TORQUE = "gravity_torque"


@dataclass
class Case:
    seed: int
    settings: dict
    effects: dict = field(default_factory=dict)   # name -> {parameter: value}, of the library
    outsider: dict = field(default_factory=dict)  # the same, at most one

    def words(self):
        words = ["--seed", self.seed, "--set", *(f"{name}={value:.9g}" for name, value in self.settings.items())]
        for name, values in {**self.effects, **self.outsider}.items():
            words += ["--effect", name + ":" + ",".join(f"{key}={value:.9g}" for key, value in values.items())]
        return words


def class_of(effect):
    return next((group for group in CLASSES if effect in group), {effect})


def _either(draw, value):
    return value if draw.random() < 0.5 else -value


def _effect(name, draw, joint):
    """Sizes that a real joint might have, as shares of its gravity torque, friction and range."""
    torque = joint[TORQUE]
    u = draw.uniform
    speed = math.sqrt(torque / joint["inertia"])  # [rad/s] of a swing of about 1 rad
    if name == "coulomb_friction":
        return {"coulomb_torque": u(0.03, 0.15) * torque}
    if name == "asymmetric_friction":
        sides = [u(0.05, 0.15) * torque, u(0, 0.03) * torque]
        draw.shuffle(sides)
        return dict(zip(("forward_friction", "backward_friction"), sides))
    if name == "stribeck_friction":
        return {"stribeck_torque": u(0.05, 0.15) * torque, "stribeck_velocity": u(0.05, 0.15) * speed}
    if name == "load_friction":
        return {"load_friction_coefficient": u(0.05, 0.2)}
    if name == "directional_friction":
        return {"motor_load_friction": u(0.08, 0.25), "external_load_friction": 0.0}
    if name == "quadratic_drag":
        return {"drag_coefficient": u(0.02, 0.1) * torque / speed ** 2}
    if name == "asymmetric_viscous_friction":
        return {"viscous_asymmetry": _either(draw, u(0.3, 0.8)) * joint["viscous_friction"]}
    if name == "cogging":
        size, phase = u(0.03, 0.12) * torque, u(0, 2 * math.pi)
        return {"cogging_cos": size * math.cos(phase), "cogging_sin": size * math.sin(phase),
                "cogging_period": 2 * math.pi / draw.choice((2, 3, 4, 6, 8))}
    if name == "torque_offset":
        return {"offset_torque": _either(draw, u(0.05, 0.2)) * torque}
    if name == "position.offset":
        return {"position.offset": _either(draw, u(0.03, 0.12))}
    if name == "gain_compression":
        return {"compression": u(0.1, 0.4)}
    if name == "dead_zone":
        return {"dead_zone_width": u(0.03, 0.12) * torque}
    if name == "supply_sag":
        return {"thermal_rate": _either(draw, u(0.1, 0.3)) / joint["duration"]}
    if name == "command_delay":
        return {"command_delay": u(0.01, 0.06)}
    if name == "compliance":
        return {"transmission_compliance": u(0.02, 0.1) / torque}
    assert name == "backlash", name
    return {"backlash_width": u(0.02, 0.08)}


LIBRARY = ("coulomb_friction", "asymmetric_friction", "stribeck_friction", "load_friction", "directional_friction", "quadratic_drag",
           "asymmetric_viscous_friction", "cogging", "torque_offset", "position.offset", "gain_compression", "dead_zone", "supply_sag",
           "command_delay", "compliance", "backlash")


def _outsider(name, draw, joint):
    torque = joint[TORQUE]
    u = draw.uniform
    return {
        "wear": lambda: {"wear_rate": u(0.1, 0.3) * torque / (4 * joint["duration"])},
        "tight_spot": lambda: {"tight_spot_torque": u(0.1, 0.4) * torque, "tight_spot_position": u(-0.4, 0.4),
                               "tight_spot_width": u(0.05, 0.2)},
        "hysteretic_spring": lambda: {"hysteresis_torque": u(0.05, 0.2) * torque, "hysteresis_width": u(0.1, 0.4)},
        "end_stop": lambda: {"stop_stiffness": u(0.5, 3) * torque, "stop_position": u(0.1, 0.5)},
        "torque_bump": lambda: {"bump_torque": _either(draw, u(0.1, 0.3)) * torque, "bump_position": u(-0.4, 0.4),
                                "bump_width": u(0.05, 0.2)},
        "lost_load": lambda: {"lost_load": u(0.05, 0.2), "lost_time": u(0.3, 0.7) * joint["duration"]},
        "eccentric_encoder": lambda: {"eccentricity": u(0.02, 0.06), "eccentricity_phase": u(0, 2 * math.pi)},
        "drifting_damping": lambda: {"damping_rate": u(0.3, 1) * joint["viscous_friction"] / joint["duration"]},
        "coarse_command": lambda: {"command_step": u(0.1, 0.3) * torque},
        "hum": lambda: {"hum_torque": u(0.03, 0.1) * torque, "hum_frequency": u(0.5, 5), "hum_phase": u(0, 2 * math.pi)},
    }[name]()


def draw_case(seed):
    """1 to 8 trials of 6 to 12 s, 100 to 1000 Hz, open or closed loop, 2 to 6 effects; an outsider in a third of the cases."""
    draw = random.Random(f"large misfits {seed}")
    joint = {"inertia": draw.uniform(0.02, 0.08), "viscous_friction": draw.uniform(0.02, 0.1), TORQUE: draw.uniform(0.3, 1.2),
             "train": draw.choice((1, 1, 2, 3, 4, 6, 8)), "validate": 2, "duration": draw.uniform(6, 12),
             "rate": draw.choice((100, 100, 200, 500, 1000)), "position_noise": draw.uniform(0.0005, 0.002),
             "known_noise": draw.choice((0, 1)), "excitation": draw.choice((0, 1))}
    case = Case(seed, joint)
    count = draw.choice((2, 2, 3, 3, 4, 5, 6))
    taken = set()
    while len(case.effects) < count:
        name = draw.choice(LIBRARY)
        if name not in taken:
            taken |= class_of(name)
            case.effects[name] = _effect(name, draw, joint)
    if draw.random() < 1 / 3:
        name = draw.choice(OUTSIDERS)
        case.outsider[name] = _outsider(name, draw, joint)
    return case

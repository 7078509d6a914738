#!/usr/bin/python3
"""Is a person in an exoskeleton told as a spring with an angle of rest? README.md describes the cases.

usage: run.py --sinew PATH --seeds 1:20 [--without-spring] --out RESULTS.json
       run.py --report RESULTS.json [--each]
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import arms  # noqa: E402
import one_diagnosis  # noqa: E402
from one_diagnosis import share  # noqa: E402

# The torque of the spring at position 0 is a constant of the joint, or of the torque's sensor.
OFFSETS = {"torque_offset", "torque.offset"}


def examine(sinew, seed, without_spring):
    arm = arms.draw_arm(seed, without_spring)
    case = {"seed": seed, "stiffness": arm.stiffness, "rest": arm.rest}
    answer, case["seconds"] = one_diagnosis.diagnose(sinew, lambda path: arms.write(arm, path))
    if answer is None:
        return {**case, "verdict": "not ended"}
    case["verdict"] = answer["verdict"]
    case["causes"] = [cause["effect"] for cause in answer["causes"]]
    case["told"] = "parallel_spring" in case["causes"] and bool(OFFSETS & set(case["causes"]))
    truths = {"inertia": arm.inertia, "viscous_friction": arm.viscous, "drive_gain": arm.gain}
    if case["told"]:
        truths.update(spring_stiffness=arm.stiffness, offset_torque=arm.stiffness * arm.rest)
    case["inside"] = one_diagnosis.inside(answer, truths)
    return case


def report(cases):
    clean, hidden = [c for c in cases if not c["stiffness"]], [c for c in cases if c["stiffness"]]
    if clean:
        print("no spring, adequate:", share(sum(c["verdict"] == "adequate" for c in clean), len(clean)))
    if hidden:
        told = [c for c in hidden if c.get("told")]
        print("spring and offset named:", share(len(told), len(hidden)))
        print("... and nothing else:", share(sum(len(c["causes"]) == 2 for c in told), len(hidden)))
    one_diagnosis.report_common(cases)


if __name__ == "__main__":
    one_diagnosis.study(__doc__, "--without-spring", "no spring: nothing is hidden", examine, report)

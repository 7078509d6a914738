#!/usr/bin/python3
"""Does a diagnosis take noise of a recorded force for a misfit of the model? README.md describes the cases.

usage: run.py --sinew PATH --seeds 100:119 [--friction] --out RESULTS.json
       run.py --report RESULTS.json [--each]
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import axes  # noqa: E402
import one_diagnosis  # noqa: E402
from one_diagnosis import share  # noqa: E402

# What says the same: dry friction by direction has the equal one as a special case.
FRICTION = {"coulomb_friction": ["coulomb_torque"], "asymmetric_friction": ["forward_friction", "backward_friction"]}


def examine(sinew, seed, friction):
    axis = axes.draw_axis(seed, friction)
    case = {"seed": seed, "friction": axis.coulomb, "noise_share": axis.force_noise / axis.force, "samples": sum(len(r[0]) for r in axis.records)}
    answer, case["seconds"] = one_diagnosis.diagnose(sinew, lambda path: axes.write(axis, path))
    if answer is None:
        return {**case, "verdict": "not ended"}
    case["verdict"] = answer["verdict"]
    case["causes"] = [cause["effect"] for cause in answer["causes"]]
    truths = {"inertia": axis.mass, "viscous_friction": axis.viscous}
    for effect in set(case["causes"]) & set(FRICTION):
        truths.update({name: axis.coulomb for name in FRICTION[effect]})
    case["inside"] = one_diagnosis.inside(answer, truths)
    return case


def report(cases):
    clean, hidden = [c for c in cases if not c["friction"]], [c for c in cases if c["friction"]]
    if clean:
        print("nothing hidden, adequate:", share(sum(c["verdict"] == "adequate" for c in clean), len(clean)))
    if hidden:
        named = [c for c in hidden if set(c.get("causes", [])) & set(FRICTION)]
        print("friction hidden, named:", share(len(named), len(hidden)))
        print("... and nothing else:", share(sum(len(c["causes"]) == 1 for c in named), len(hidden)))
    one_diagnosis.report_common(cases)


if __name__ == "__main__":
    one_diagnosis.study(__doc__, "--friction", "dry friction of 0.3 of the force's root mean square is hidden", examine, report)

"""Commands that are interrupted: of every kind that takes long, on small problems.

A case has the words of the command without its output, the option for that, and what it is called. `resumes` is false for a
command that is simply given again.
"""
from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    name: str
    words: tuple
    out: str
    option: str = "--out"
    resumes: bool = True

    def command(self):
        return (*self.words, self.option, self.out) if self.option else self.words


DATA = (
    ("nms.h5", "data synthesize nms --seed 2 --set cycles=3"),
    ("contact.h5", "data synthesize contact --seed 4 --set encoders=1"),
    ("drive.h5", "data synthesize drive --seed 7 --set duration=5 --effect asymmetric_friction:forward_friction=0.16,backward_friction=0.08"),
    ("misfit.h5", "data synthesize drive --seed 8 --set train=2 --set validate=1 --set duration=2 --set rate=100 --set "
                  "position_noise=0.0001 --effect coulomb_friction:value=0.2 --effect position.time_offset:value=0.02"),
    ("toss.h5", "data synthesize free_body --seed 2 --set train=4 --set validate=2"),
    ("walk.h5", "data synthesize contact --seed 6 --set person=1 --set encoders=1 --set train=1 --set validate=1 --set slip=0.1 "
                "--set motion_error=0.005 --set rotation_error=0.0262"),
)
COHORT = """subjects: {anna: {seed: 1}, bert: {seed: 2}}
out: results
steps:
  data: data synthesize contact --seed {seed} --set encoders=1 --out {out}/data.h5
  fit: identify contact --data {data} --solver sa --max-evaluations 20000 --out {out}/run.h5
  why: diagnose contact --data {data} --out {out}/why.h5
"""
SOLES = """contact:
  objective: likelihood
  fit: [force_x, force_y, force_z, cop_x, cop_z, moment_y]
  motion_errors: {position: 0.005, rotation: 0.0262}
  regions:
    - {name: right_sole, body: calcn_r, plate: right, position: [0.0325, -0.07343375, 0.0],
       mesh: {box: {size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}}
    - {name: left_sole, body: calcn_l, plate: left, position: [0.0325, -0.07343375, 0.0],
       mesh: {box: {size: [0.26, 0.0325, 0.14625], strips: [18, 10]}}}
"""
SETTINGS = (("cohort.yaml", COHORT), ("soles.yaml", SOLES))
# What `report` draws.
DRAWN = (
    ("drawn_1.h5", "identify contact --data contact.h5 --solver lm --quiet --out drawn_1.h5"),
    ("drawn_2.h5", "diagnose drive --data drive.h5 --quiet --out drawn_2.h5"),
)


def solvers(listed):
    """Every solver, on the calibration of a small muscle model; chains and other problems beside them."""
    names = [*listed, "sa+lm", "cmaes+ceres"]
    return [Case("identify " + name, ("identify", "nms", "--data", "nms.h5", "--solver", name, "--max-evaluations", "600",
                                      "--threads", "1", "--quiet"), "run.h5") for name in names]


def others():
    work = ("--quiet", "--threads", "2")
    return [
        Case("identify, contact", ("identify", "contact", "--data", "contact.h5", *work), "run.h5"),
        Case("identify, tosses", ("identify", "free_body", "--data", "toss.h5", "--solver", "lm", *work), "run.h5"),
        Case("diagnose, drive", ("diagnose", "drive", "--data", "drive.h5", *work), "why.h5"),
        Case("diagnose, contact", ("diagnose", "contact", "--data", "contact.h5", *work), "why.h5"),
        Case("diagnose, large misfit", ("diagnose", "drive", "--data", "misfit.h5", *work), "why.h5"),
        Case("identify, motion errors", ("identify", "contact", "--data", "walk.h5", "--config", "soles.yaml", *work), "run.h5"),
        Case("diagnose, motion errors", ("diagnose", "contact", "--data", "walk.h5", "--config", "soles.yaml", *work), "why.h5"),
        Case("compare", ("compare", "nms", "--data", "nms.h5", "--solvers", "sa,lm,restarts", "--repeats", "3",
                         "--max-evaluations", "400", *work), "study.h5"),
        Case("report", ("report", "drawn_1.h5", "drawn_2.h5", *work), "page", "--out-dir", resumes=False),
        Case("run", ("run", "cohort.yaml", *work), "results", "", resumes=False),
    ]

"""The commands on measured data (work/shared/data, not part of this repository); words as in commands.py."""

GAIT = "measured/gait_subject01"
WALKING = "measured/walking_emg"
CEINMS = "measured/ceinms_example"
SERVO = "examples/servo_pendulum"
STS = "measured/servo_pendulum/sts3250"
TOSSES = (0, 60, 120, 180, 240, 300)
CUBE = "--map benchmarks/cube_tosses/pose.yaml --trial toss_{0} --role {1}"
MUSCLES = "soleus_r,med_gas_r,lat_gas_r,tib_ant_r"

GAIT_COMMANDS = [
    ("gait_import", f"data import {GAIT}/ExperimentalData_subject01_walk.trc {GAIT}/ExperimentalData_subject01_walk_grf.mot "
                    f"{GAIT}/Gait10dof18musc_subject01.osim --external-loads {GAIT}/ExperimentalData_subject01_walk_grf.xml "
                    "--trial walk"),
    ("gait_kinematics", f"data kinematics {{out}} --weights {GAIT}/IK_walk_Setup_IK.xml --quiet", "@gait_import"),
    ("gait_right", "data cut {out} --trial walk --window 0.60:1.43 --as right_stance --role train --plate right",
     "@gait_kinematics"),
    ("gait_left", "data cut {out} --trial walk --window 1.23:2.04 --as left_stance --role validate --plate left", "@gait_right"),
    ("gait_stances", "data drop {out} --trial walk", "@gait_left"),
    ("gait_identify", "identify contact --data @gait_stances --config examples/gait_subject01.yaml"),
    ("gait_why", "diagnose contact --data @gait_stances --config examples/gait_subject01.yaml"),
    ("gait_angles", f"data import {GAIT}/IK_subject01_walk_IK.mot {GAIT}/Gait10dof18musc_subject01.osim --trial walk"),
    ("gait_muscles", "data muscles {out} --joints ankle_angle_r,knee_angle_r,hip_flexion_r", "@gait_angles"),
]

WALKING_COMMANDS = [
    ("walking_import", f"data import {WALKING}/walk36/ik.sto {WALKING}/walk36/id.sto {WALKING}/gait2392.osim --trial walk36"),
    ("walking_cut", "data cut {out} --trial walk36 --window 5:15 --as fit", "@walking_import"),
    ("walking_drop", "data drop {out} --trial walk36", "@walking_cut"),
    ("walking_muscles", f"data muscles {{out}} --muscles {MUSCLES} --joints ankle_angle_r,knee_angle_r", "@walking_drop"),
    ("walking_ceinms_rt", f"data ceinms {WALKING}/Calibration.xml --validate walk36:35:45"),
    ("walking_why", "diagnose nms --data @walking_ceinms_rt --solver lm"),
    ("walking_lm", "identify nms --data @walking_ceinms_rt --solver lm --max-evaluations 60 --intervals linear"),
]

CEINMS_COMMANDS = [
    ("ceinms_import", f"data ceinms {CEINMS}/csetup_stiff.xml --validate {CEINMS}/trial3/trial3.xml"),
    ("ceinms_hybrid", f"data ceinms {CEINMS}/setup_true_hybrid_1.xml"),
    ("ceinms_hybrid_simulate", "simulate nms --data @ceinms_hybrid"),
    ("ceinms_equilibrium", f"data ceinms {CEINMS}/setup_true_equilibriumElastic_1.xml"),
    ("ceinms_equilibrium_simulate", "simulate nms --data @ceinms_equilibrium"),
    *((f"ceinms_{solver}", f"identify nms --data @ceinms_import --solver {solver} --max-evaluations {most} --intervals linear "
                           "--seed 2") for solver, most in (("lm", 200), ("hop", 300), ("ceres", 100), ("ipopt", 60),
                                                            ("multistart", 600), ("cmaes", 1000), ("sa", 1000))),
    ("ceinms_profile", "identify nms --data @ceinms_import --solver lm --free soleus_r.shape,tib_ant_r.filter_mean,group_1.strength"),
    ("ceinms_subject", "data subject @ceinms_lm --out {here}/subject.xml"),
]

SERVO_COMMANDS = [
    ("servo_sin", f"data import {STS}/2024-10-26_12h23m27.csv {SERVO}/sts3250/drive.yaml --map {SERVO}/sts3250.yaml --trial sin_sin"),
    ("servo_lift", f"data import {STS}/2024-10-26_12h23m42.csv --map {SERVO}/sts3250.yaml --trial lift_and_drop --append", "@servo_sin"),
    ("servo_up", f"data import {STS}/2024-10-26_12h27m27.csv --map {SERVO}/sts3250.yaml --trial up --role validate --append", "@servo_lift"),
    ("servo_cut", "data cut {out} --trial lift_and_drop --window 0:2.0 --as lift --role train", "@servo_up"),
    ("servo_data", "data drop {out} --trial lift_and_drop", "@servo_cut"),
    ("servo_why", "diagnose drive --data @servo_data"),
    ("servo_identify", "identify drive --data @servo_data --intervals linear --max-evaluations 40"),
]

# The misfit is much larger than the noise here: sets of causes are chosen by cross-validation over trials.
PENDULUM_COMMANDS = []
before = ""
for name, file, gain, role in (("slow", "2026-01-15_10h28m10", 100, "train"), ("fast", "2026-01-15_10h28m42", 200, "train"),
                               ("held", "2026-01-15_10h29m47", 800, "validate")):
    PENDULUM_COMMANDS += [
        (f"pendulum_{name}_import", f"data import measured/servo_pendulum/xl330/{file}.csv {SERVO}/drive.yaml --map "
                                    f"{SERVO}/xl330_kp{gain}.yaml --trial whole --role {role}" + (" --append" if before else ""), before),
        (f"pendulum_{name}_cut", f"data cut {{out}} --trial whole --window 0:1.5 --as {name}", f"@pendulum_{name}_import"),
        (f"pendulum_{name}", "data drop {out} --trial whole", f"@pendulum_{name}_cut")]
    before = f"@pendulum_{name}"
PENDULUM_COMMANDS += [("pendulum_why", f"diagnose drive --data {before}")]

CUBE_COMMANDS = [
    (f"cube_{number}", f"data import measured/cube_tosses/{number}.csv " + ("benchmarks/cube_tosses/free_body.yaml " if i == 0 else "")
     + CUBE.format(number, "validate" if i % 3 == 2 else "train") + (" --append" if i else ""),
     f"@cube_{TOSSES[i - 1]}" if i else "") for i, number in enumerate(TOSSES)]
CUBE_COMMANDS += [("cube_identify", f"identify free_body --data @cube_{TOSSES[-1]} --max-evaluations 15 --intervals linear "
                                    "--release mass_centre_offset,length_scale")]

REFERENCES = [("mbs_reference", "mbs A01 --accuracy 1e-8 --reference measured/mbs_benchmark --json -")]

MEASURED = GAIT_COMMANDS + WALKING_COMMANDS + CEINMS_COMMANDS + SERVO_COMMANDS + PENDULUM_COMMANDS + CUBE_COMMANDS + REFERENCES

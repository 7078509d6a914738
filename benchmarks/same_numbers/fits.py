"""The commands that fit, diagnose and compare, on data of commands.py; words as there."""

CONTACT = "identify contact --data data/nao_stance.h5 "
DRIVE = "identify drive --data @drive_short "

SOLVERS = [("solver_" + solver.lower().replace(":", "_").replace("+", "_"),
            f"{CONTACT}--solver {solver} --max-evaluations 200 --intervals linear --seed 3") for solver in (
                "sa", "cmaes", "multistart", "hop", "lm", "ipopt", "ipopt-lbfgs", "nlopt:LN_BOBYQA", "nlopt:LN_COBYLA",
                "nlopt:LN_NELDERMEAD", "nlopt:LN_SBPLX", "nlopt:LN_PRAXIS", "nlopt:LD_LBFGS", "nlopt:LD_SLSQP", "nlopt:LD_MMA",
                "nlopt:LD_CCSAQ", "nlopt:LD_TNEWTON_PRECOND_RESTART", "nlopt:LD_VAR2", "nlopt:GN_DIRECT_L", "nlopt:GN_CRS2_LM",
                "nlopt:GN_ISRES", "nlopt:GN_ESCH", "nlopt:GN_AGS", "nlopt:GN_MLSL_LDS", "nlopt:GD_MLSL_LDS", "nlopt:GD_STOGO",
                "sa+ceres", "cmaes+lm")]
SOLVERS += [("drive_" + solver.lower().replace(":", "_"), f"{DRIVE}--solver {solver} --max-evaluations 150 --seed 4")
            for solver in ("sa", "cmaes", "multistart", "hop", "lm", "ipopt", "nlopt:LN_BOBYQA", "nlopt:LD_SLSQP")]

IDENTIFY = [
    ("contact_ceres", CONTACT),
    ("contact_resumed", CONTACT + "--solver sa --max-evaluations 500 --intervals linear --seed 3 --resume", "@solver_sa"),
    ("contact_channels", "identify contact --data @contact_data --config settings/contact_channels.yaml"),
    ("contact_groups", "identify contact --data @contact_data --config settings/contact_groups.yaml --solver lm"),
    ("contact_release", "identify contact --data @contact_kinematics --release height_offset,right_force_y.offset"),
    ("contact_words", CONTACT + "--free stiffness,dissipation --fix static_friction=1 --bounds stiffness=5e5:2e6 --start "
                                "stiffness=6e5"),
    ("contact_not_usable", CONTACT + "--max-evaluations 0", "", 1),
    ("contact_from", "simulate contact --data @contact_kinematics --from @contact_release"),
    ("drive_ceres", "identify drive --data data/knee_drive.h5"),
    ("drive_release", "identify drive --data @drive_data --release coulomb_friction,position.time_offset --solver lm"),
    ("drive_controller", "identify drive --data @drive_orthosis --release command_delay,coulomb_friction --intervals linear"),
    ("free_body_ceres", "identify free_body --data @free_body_data --max-evaluations 30 --intervals linear"),
    ("free_body_springs", "identify free_body --data @free_body_faces --solver lm --max-evaluations 6 --intervals linear"),
    ("nms_ceres", "identify nms --data data/ankle_study.h5 --release passive_stiffness.ankle_angle_r"),
    ("nms_stepwise", "identify nms --data data/ankle_study.h5 --config settings/nms_steps.yaml --stepwise"),
    ("nms_penalty", "identify nms --data @nms_data --config settings/nms_penalty.yaml --solver hop --max-evaluations 200 "
                    "--intervals linear --seed 2"),
    ("nms_constraint", "identify nms --data @nms_data --config settings/nms_constraint.yaml --solver ipopt --max-evaluations 60 "
                       "--intervals linear"),
    ("nms_slsqp", "identify nms --data @nms_data --config settings/nms_constraint.yaml --solver nlopt:LD_SLSQP "
                  "--max-evaluations 60 --intervals linear"),
    ("nms_elastic_fit", "identify nms --data @nms_data --config settings/nms_elastic.yaml --solver lm --max-evaluations 20 "
                        "--intervals linear"),
    ("nms_subject", "data subject @nms_ceres --out {here}/subject.xml"),
    ("emg_lm", "identify emg_shape --data @emg_data --solver lm --intervals linear"),
    ("emg_ceres", "identify emg_shape --data @emg_none --max-evaluations 20 --intervals linear"),
    ("emg_factors", "identify emg_shape --data @emg_data --config settings/emg_averaging.yaml --intervals linear"),
    ("emg_clean", "identify emg_shape --data @emg_raw --solver lm --intervals linear"),
    ("emg_left_out", "identify emg_shape --data @emg_data --config settings/emg_left_out.yaml --solver lm --intervals linear"),
    ("emg_from", "simulate emg_shape --data @emg_data --from @emg_lm"),
    ("emg_muscles", "identify nms --data @emg_data --solver lm --intervals linear"),
    ("emg_moments", "simulate nms --data @emg_data --from @emg_muscles --excitations @emg_from"),
]

DIAGNOSE = [
    ("contact_why_none", "diagnose contact --data data/nao_stance.h5"),
    ("contact_why", "diagnose contact --data @contact_kinematics"),
    ("contact_why_from", "diagnose contact --data @contact_kinematics --from @contact_release --solver lm --seed 5"),
    ("drive_why", "diagnose drive --data data/knee_drive.h5"),
    ("drive_why_from", "diagnose drive --data data/knee_drive.h5 --from @drive_ceres --fix gravity_torque=4"),
    ("drive_why_two", "diagnose drive --data @drive_data"),
    ("drive_why_short", "diagnose drive --data @drive_short"),
    ("drive_why_none", "diagnose drive --data @drive_none --solver lm"),
    ("drive_why_outside", "diagnose drive --data @drive_outside"),
    ("drive_why_hum", "diagnose drive --data @drive_hum"),
    ("drive_why_drift", "diagnose drive --data @drive_drift"),
    ("drive_why_three", "diagnose drive --data @drive_three"),
    ("drive_why_orthosis", "diagnose drive --data @drive_orthosis"),
    ("free_body_why_none", "diagnose free_body --data @free_body_data"),
    ("free_body_why", "diagnose free_body --data @free_body_hidden"),
    ("free_body_why_gravity", "diagnose free_body --data @free_body_gravity"),
    ("nms_why", "diagnose nms --data data/ankle_study.h5"),
    ("nms_why_none", "diagnose nms --data @nms_data --solver lm"),
    ("nms_why_outside", "diagnose nms --data @nms_outside"),
    ("nms_why_hidden", "diagnose nms --data @nms_hidden"),
    ("emg_why_none", "diagnose emg_shape --data @emg_none --solver lm"),
    ("emg_why", "diagnose emg_shape --data @emg_hidden --solver lm"),
    ("emg_why_outside", "diagnose emg_shape --data @emg_outside --solver lm"),
    ("drive_why_from_file", "simulate drive --data data/knee_drive.h5 --from @drive_why"),
]

COMPARE = [
    ("contact_compare", "compare contact --data data/nao_stance.h5 --solvers ceres,sa --repeats 2 --max-evaluations 300 --seed 2"),
    ("drive_compare", "compare drive --data @drive_short --solvers lm,nlopt:LN_BOBYQA --repeats 3 --max-evaluations 100"),
]

MECHANISMS = [
    ("mbs_all", "mbs all --accuracy 1e-6 --json -"),
    ("mbs_cpodes", "mbs A05 --integrator cpodes_bdf --json -"),
    ("mbs_middle", "mbs A04 --formulation middle --integrator rk_feldberg --accuracy 1e-8 --json -"),
]

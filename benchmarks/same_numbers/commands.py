"""The commands on data that the program makes up or that lie in datasets/data: name, words[, file to start from[, status]].

The words of run.py (ADDED) come on top. @NAME is the out.h5 of an earlier command. A command that changes a file starts from
a copy of it. Budgets are evaluations, never seconds. The order matters.
"""
from fits import COMPARE, DIAGNOSE, IDENTIFY, MECHANISMS, SOLVERS

PERSON = "--set subject=101 --set speeds=3 --set muscles=2 --set validate=2 --set raw=0 --set moments=0 --set laws=0"
LIST = [("list_" + line.replace(" ", "_").replace("_--data_", "_of_"), f"list {line}") for line in (
    "problems", "solvers", "integrators", "formats", *(f"{what} {problem}" for problem in (
        "contact", "drive", "free_body", "nms", "emg_shape") for what in ("parameters", "channels")))]
LIST += [(f"list_effects_{problem}", f"list effects {problem} --data {data}") for problem, data in (
    ("contact", "data/nao_stance.h5"), ("drive", "data/knee_drive.h5"), ("free_body", "@free_body_data"),
    ("nms", "data/ankle_study.h5"), ("emg_shape", "@emg_data"))]

DATA = [
    ("contact_data", "data synthesize contact --seed 4 --set encoders=1"),
    ("contact_hidden", "data synthesize contact --seed 11 --set train=4 --set slip=0.1 --set stiffness=7e5 --noise 0.5 "
                       "--effect height_offset:value=5e-4 --effect right_force_y.offset:value=5"),
    ("contact_kinematics", "data kinematics {out} --quiet", "@contact_hidden"),
    ("contact_cut", "data cut {out} --trial train_1 --window 0.1:0.4 --as part --role validate --plate right",
     "data/nao_stance.h5"),
    ("contact_drop", "data drop {out} --trial train_1", "@contact_cut"),
    ("contact_info", "data info data/nao_stance.h5 --json"),
    ("drive_data", "data synthesize drive --seed 3 --set duration=5 --set speed=1 --effect coulomb_friction:coulomb_torque=0.02 "
                   "--effect position.time_offset:value=0.01"),
    ("drive_short", "data synthesize drive --seed 5 --set train=1 --set validate=1 --set duration=4"),
    ("drive_none", "data synthesize drive --seed 6 --set duration=5 --set noise_rho=0.6 --set known_noise=0"),
    ("drive_outside", "data synthesize drive --seed 7 --set duration=5 --effect "
                      "torque_bump:bump_torque=0.03,bump_position=0.2,bump_width=0.15"),
    ("drive_hum", "data synthesize drive --seed 7 --set duration=5 --effect hum:hum_torque=0.03,hum_frequency=3"),
    ("drive_drift", "data synthesize drive --seed 7 --set duration=5 --effect drifting_damping:damping_rate=0.005"),
    ("drive_three", "data synthesize drive --seed 8 --set train=2 --set validate=1 --set duration=3 --set rate=200 --set "
                    "position_noise=0.0001 --effect coulomb_friction:value=0.2 --effect position.time_offset:value=0.02 --effect "
                    "stribeck_load_friction:stribeck_load_coefficient=0.3,stribeck_load_velocity=0.5"),
    ("drive_orthosis", "data synthesize drive --seed 9 --set mafo=1 --set hidden=1 --noise 2"),
    ("drive_table", "data import settings/bench.csv --map settings/bench.yaml --trial slow --role validate"),
    ("free_body_data", "data synthesize free_body --seed 2 --set train=4 --set validate=2"),
    ("free_body_hidden", "data synthesize free_body --seed 2 --set train=4 --set validate=2 --effect "
                         "inertia_error:inertia_error=0.05"),
    ("free_body_gravity", "data synthesize free_body --seed 2 --set train=4 --set validate=2 --effect "
                          "gravity_error:gravity_error=0.01"),
    ("free_body_faces", "data synthesize free_body --seed 3 --set train=1 --set validate=1 --set duration=0.3 --set "
                        "elastic_foundation=1"),
    ("nms_data", "data synthesize nms --seed 2 --set cycles=2 --set raw=1"),
    ("nms_outside", "data synthesize nms --seed 3 --set cycles=2 --effect tremor:tremor=1.5 --noise 1.5"),
    ("nms_hidden", "data synthesize nms --seed 3 --set cycles=2 --effect co_contraction:co_contraction=0.03"),
    ("nms_envelope", "data envelope {out} --grid emg --normalise all --low-pass 8", "@nms_data"),
    ("nms_envelope_given", "data envelope data/ankle_study.h5 --grid emg --channels soleus_r,tib_ant_r --order 8 --rate 100 "
                           "--normalise trials:train_60,train_90 --high-pass 100 --out {out}"),
    ("emg_data", "data synthesize emg_shape --seed 12 --set subject=2 --set speeds=4 --set train=4 --set validate=2 --set raw=0"),
    ("emg_none", f"data synthesize emg_shape --seed 13 {PERSON} --set train=4"),
    ("emg_hidden", f"data synthesize emg_shape --seed 14 {PERSON} --set train=6 --effect phase_shift_with_speed:lead=0.2"),
    ("emg_outside", f"data synthesize emg_shape --seed 15 {PERSON} --set train=4 --effect hum:hum=0.04"),
    ("emg_raw", "data synthesize emg_shape --seed 16 --set subject=1 --set speeds=2 --set train=3 --set validate=1 --set raw=1"),
    ("emg_envelope", "data envelope {out} --grid emg --normalise none --rate 0 --longest-gap 0.1", "@emg_raw"),
    ("emg_info", "data info @emg_data --json"),
]

SIMULATE = [
    ("contact_simulate", "simulate contact --data data/nao_stance.h5 --set stiffness=8e5,dissipation=25"),
    ("contact_sensor", "simulate contact --data @contact_data --set right_force_y.time_offset=0.004,tilted_floor=1", "", 2),
    ("contact_late", "simulate contact --data @contact_data --set right_force_y.time_offset=0.004,floor_slope_x=0.01"),
    ("contact_storage", "simulate contact --data data/nao_stance.h5 --out {here}/out.sto"),
    ("contact_import", "data import contact_storage/out_train_1.sto"),
    ("drive_simulate", "simulate drive --data data/knee_drive.h5 --set inertia=0.13,coulomb_torque=0.1,command_delay=0.003"),
    ("free_body_simulate", "simulate free_body --data @free_body_hidden --set friction=0.25,corner_radius=0.001"),
    ("nms_simulate", "simulate nms --data data/ankle_study.h5 --set triceps.strength=0.9"),
    ("nms_assisted", "simulate nms --data @nms_data --mode assisted --gamma 10"),
    ("nms_hybrid", "simulate nms --data @nms_data --mode hybrid --synthesise tib_ant_r --adjust soleus_r --alpha 2"),
    ("nms_optimised", "simulate nms --data @nms_data --mode optimised --beta 0.5"),
    ("nms_elastic", "simulate nms --data @nms_data --config settings/nms_elastic.yaml"),
    ("nms_equilibrium", "simulate nms --data @nms_data --config settings/nms_equilibrium.yaml"),
    ("emg_averaging", "simulate emg_shape --data @emg_data --config settings/emg_averaging.yaml"),
]

COMMANDS = DATA + LIST + SIMULATE + SOLVERS + IDENTIFY + DIAGNOSE + COMPARE + MECHANISMS

"""Makes the seed corpora of the fuzzers, tests/fuzz/corpus, from texts that the tree's tests have, and by hand where they have none.

    /usr/bin/python3 tests/fuzz/make_seeds.py

Made once and kept: the ordinary tests replay them. No seed is taken from data that are not part of the tree.
"""
import re
import shutil
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
TESTS = HERE.parent
sys.path.insert(0, str(TESTS / "cli"))
import laboratory_files  # noqa: E402
import mat_files  # noqa: E402
import test_cohort  # noqa: E402

CORPUS = HERE / "corpus"
SEPARATOR = "\n====\n"


def raw(path, name):
    """The raw string that a C++ file of the tests gives this name."""
    text = (TESTS / path).read_text()
    return re.search(re.escape(name) + r'\s*=\s*R"\((.*?)\)"', text, re.DOTALL).group(1)


def seed(target, name, data):
    folder = CORPUS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())


def recordings():
    seed("trc", "walk", laboratory_files.trc())
    seed("trc", "gaps_in_m", laboratory_files.trc(markers=("A",), units="m", changed={1: "2\t0.01667\t\t\t", 2: "3\t0.03333\t1e-3\tnan\t2"}))
    seed("trc", "announces_more", laboratory_files.trc(announced_frames=9, announced_markers=3))
    seed("storage", "motion", laboratory_files.mot())
    seed("storage", "degrees", laboratory_files.mot(in_degrees="yes", announced_rows=9, announced_columns=4))
    seed("storage", "empty_cells", "forces\nnRows=2\nnColumns=3\nendheader\ntime\ta b\tc\n0.000\t\t2\n0.017\tNA\t-1.#IND\n")
    seed("storage", "no_header", "nRows=1\nendheader\ntime knee\n0 1\n")
    table = '# log\n"time, s",q,mode\n0,1.5,on\n1,,off\n2,nan,"o""n"\n3,4e-2,on\n'
    seed("csv", "commas", table)
    seed("csv", "semicolons", "t;q\n0,0;1,5\n0,1;2,5\n")
    seed("csv", "tabs", "t\tq\n0\t1\n1\t2\n")
    mapped = ("time: {column: t, unit: ms}\nchannels:\n  position: {column: qm, unit: deg, kind: measured, scale: 2.0, sigma: 0.1}\n"
              "  torque:\n    column: tau\n    unit: N*m\n    kind: input\n"
              'constants: {gear_ratio: {value: 120, unit: "1"}}\nconditions: {speed_rad_per_s: 0.52}\ntitle: a leg\ntask: walking\n')
    seed("csv_import", "map_and_table", mapped + SEPARATOR + "t,qm,tau\n0,1,2\n10,2,3\n20,nan,4\n")
    seed("csv_import", "rate", "time: {rate: 100}\nchannels: {q: {unit: m}}\n" + SEPARATOR + "q\n1\n2\n")
    seed("import_map", "all", mapped)
    seed("import_map", "markers", "markers: {R.ASIS: RASI}\ntime: {rate: fs}\nchannels: {a: {column: 'data(:,2)', unit: V, time: {column: t, unit: s}}}\n")
    seed("import_map", "aliases", "time: &t {column: t, unit: s}\nchannels: {a: {unit: m, time: *t}, b: {<<: *t}}\n")
    force = ('<ExternalForce name="right"><isDisabled>false</isDisabled><applied_to_body>calcn_r</applied_to_body>\n'
             "<force_expressed_in_body>ground</force_expressed_in_body><point_expressed_in_body>ground</point_expressed_in_body>\n"
             "<force_identifier>ground_force_v</force_identifier><point_identifier>ground_force_p</point_identifier>\n"
             "<torque_identifier>ground_torque_</torque_identifier></ExternalForce>")
    seed("external_loads", "version3", f'<?xml version="1.0"?>\n<OpenSimDocument Version="30000"><ExternalLoads name="g"><objects>\n{force}\n'
         "</objects></ExternalLoads></OpenSimDocument>\n")
    seed("external_loads", "version4", '<OpenSimDocument Version="40000"><ExternalLoads><objects><ExternalForce name="l"><appliesForce>true'
         "</appliesForce><applied_to_body>/bodyset/calcn_l</applied_to_body><force_identifier>1_v</force_identifier></ExternalForce>"
         "</objects></ExternalLoads></OpenSimDocument>\n")
    for name, text in {"torque": "N*m/(rad/s)^2", "temperature": "degC", "plates": "right=ground_,left=1_ground_", "mat": "F.R(2).x{3}",
                       "column": "data(:,3)", "power": "m^-2"}.items():
        seed("units", name, text)


def models():
    axis = "0.1 0.1 0.9"
    seed("osim", "pendulum3", raw("models/multibody/test_models.h", "kPendulum3").replace("AXIS", axis))
    seed("osim", "pendulum4", raw("models/multibody/test_models.h", "kPendulum4").replace("AXIS", axis))
    seed("osim", "leg", raw("models/multibody/test_models.h", "kLeg"))
    muscles = raw("models/multibody/test_muscles.h", "kMuscles3").replace("QUADRANT", "+y").replace("LENGTH", "1").replace("RANGE", "-1 -1")
    for shape in ("drum", "ball"):
        seed("osim", f"muscles_{shape}", muscles.replace("OBJECT", shape))
    seed("ik_setup", "tool", raw("models/multibody/ik_setup_test.cpp", "kSetup"))
    seed("ik_setup", "task_set", '<OpenSimDocument Version="40000"><IKTaskSet><objects><IKMarkerTask name="A"/></objects></IKTaskSet></OpenSimDocument>')
    seed("obj", "tetrahedron", "# sole\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n")
    seed("obj", "textured", "v 0 0 0\nv 1 0 0 1.0\nv 0 0 1\nv 0 1 0\nvn 0 1 0\nf 1/1/1 2/2 3\nf -4 -1 -3\nf 2 4 3\nf 1 3 4\n")
    seed("mechanism_reference", "curve", "t_s,value_m\n0,-1\n0.5,-0.9\n1,-0.5\n")


def ceinms():
    curves = raw("problems/nms/ceinms/subject_test.cpp", "kCurves")
    tendon = "<curve><name>tendonForceStrain</name><xPoints>-1 0 0.05</xPoints><yPoints>0 0 1</yPoints></curve>"
    muscle = ("<mtu><name>soleus</name><c1>-0.4</c1><c2>-0.6</c2><shapeFactor>-0.5</shapeFactor><optimalFibreLength>0.05</optimalFibreLength>"
              "<pennationAngle>0.4</pennationAngle><tendonSlackLength>0.25</tendonSlackLength><maxIsometricForce>3549</maxIsometricForce>"
              "<strengthCoefficient>1.3</strengthCoefficient></mtu>")
    subject = (f'<?xml version="1.0"?>\n<subject>\n<mtuDefault><emDelay>0.02</emDelay><percentageChange>0.1</percentageChange><damping>0.05</damping>'
               f"{curves}{tendon}</mtuDefault>\n<!-- kept -->\n<mtuSet>{muscle}</mtuSet>\n<dofSet><dof><name>ankle</name><mtuNameSet>soleus</mtuNameSet>"
               "</dof></dofSet>\n</subject>\n")
    seed("ceinms_subject", "ceinms", subject)
    realtime = subject
    for old, new in (("mtuDefault", "muscleDefault"), ("mtuSet", "muscles"), ("<mtu>", "<muscle>"), ("</mtu>", "</muscle>"), ("curve>", "Curve>"),
                     ("FibreLength", "FiberLength"), ("dofSet", "DoFs"), ("dof>", "DoF>"), ("mtuNameSet", "muscleSequence"), ("c1>", "C1>"), ("c2>", "C2>")):
        realtime = realtime.replace(old, new)
    channels = "<Channels><Channel><name>emg</name><muscleSequence>soleus</muscleSequence></Channel></Channels></subject>"
    seed("ceinms_subject", "realtime", realtime.replace("</subject>", channels))
    model = "<NMSmodel><type><openLoop/></type><tendon><equilibriumElastic/></tendon><activation><exponential/></activation></NMSmodel>"
    steps = ("<calibrationSteps><step><dofs>knee ankle</dofs><objectiveFunction><minimizeTorqueError/></objectiveFunction><parameterSet>"
             "<parameter><name>c1</name><single/><absolute><range>-0.95 -0.05</range></absolute></parameter>"
             "<parameter><name>tendonSlackLength</name><global/><relativeToSubjectValue><range>0.85 1.15</range></relativeToSubjectValue></parameter>"
             "<parameter><name>strengthCoefficient</name><muscleGroups><muscles>a b</muscles><muscles>c</muscles></muscleGroups>"
             "<absolute><range>0.5 2.5</range></absolute></parameter></parameterSet></step></calibrationSteps>")
    seed("ceinms_calibration", "calibration", f"<calibration><algorithm><simulatedAnnealing><T>20</T></simulatedAnnealing></algorithm>{model}{steps}"
         "<trialSet>trial1/trial1.xml trial2.xml</trialSet></calibration>")
    hybrid = model.replace("<openLoop/>", "<hybrid><alpha>1</alpha><beta>2</beta><gamma>3</gamma><synthMTUs>a</synthMTUs><adjustMTUs>b c</adjustMTUs>"
                           "<dofSet>ankle</dofSet></hybrid>")
    seed("ceinms_calibration", "execution", f"<execution>{hybrid}<online/></execution>")
    setup = ("<ceinmsCalibration><subjectFile>subject.xml</subjectFile><excitationGeneratorFile>generator.xml</excitationGeneratorFile>"
             "<calibrationFile>calibration.xml</calibrationFile><outputSubjectFile>o.xml</outputSubjectFile></ceinmsCalibration>")
    generator = ('<excitationGenerator><inputSignals type="EMG">sol_emg</inputSignals><mapping><excitation id="sol"><input weight="0.5">sol_emg</input>'
                 "<input>sol_emg</input></excitation></mapping></excitationGenerator>")
    trial = ("<inputData><muscleTendonLengthFile>lengths.sto</muscleTendonLengthFile><excitationsFile>emg.mot</excitationsFile><momentArmsFiles>"
             '<momentArmsFile dofName="ankle">arms.sto</momentArmsFile></momentArmsFiles><externalTorquesFile>id.sto</externalTorquesFile></inputData>')
    seed("ceinms_project", "calibration", SEPARATOR.join((setup, generator, trial)))
    run = setup.replace("ceinmsCalibration", "ceinms").replace("calibrationFile", "executionFile").replace(
        "<outputSubjectFile>", "<inputDataFile>trial.xml</inputDataFile><outputSubjectFile>")
    seed("ceinms_project", "execution", SEPARATOR.join((run, generator, trial)))
    seed("ceinms_rt_calibration", "calibration", raw("problems/nms/ceinms/rt_test.cpp", "kCalibration"))
    seed("ceinms_rt_emg", "emg", raw("problems/nms/ceinms/rt_test.cpp", "kEmg"))
    for tendon_model in ("stiff", "equilibriumElastic"):
        seed("ceinms_rt_execution", tendon_model, "<execution>\n<NMSmodel><type><realTime><openLoop/></realTime></type><tendon>\n"
             f"<{tendon_model}/></tendon>\n<activation><exponential/></activation></NMSmodel></execution>")


def settings():
    examples = TESTS.parent / "docs" / "examples"
    seed("ankle_settings", "bench", raw("problems/ankle_on_dynamometer/ankle_bench.h", "kAnkleYaml").replace("kAnkleYaml", ""))
    seed("ankle_settings", "person", (examples / "dynamometer_ankle" / "ankle_on_dynamometer.yaml").read_text())
    seed("contact_settings", "two_soles", raw("problems/contact/settings_test.cpp", "kSettings"))
    seed("contact_settings", "obj", "contact:\n  motion_errors: {}\n  accuracy: {force: 2, cop: 0.01}\n  regions:\n"
         "    - {name: a, body: b, plate: p, mesh: {obj: {file: sole.obj, scale: 0.001}}}\n")
    seed("drive_settings", "servo", (examples / "servo_pendulum" / "drive.yaml").read_text())
    seed("drive_settings", "sts3250", (examples / "servo_pendulum" / "sts3250.yaml").read_text().replace("time:", "#time:"))
    seed("emg_shape_settings", "all", "emg_shape:\n  angle: knee\n  muscles: [a, b]\n  model: averaging\n"
         "  cycles: {begins_at: lowest, swing: 0.4, shortest: 0.5}\n  laws: [lead]\n  timing: shared\n  cycle_scatter: false\n  knots: 20\n  rate: 50\n"
         "  same_speed: 0.1\n  hold_out: [fast]\n  reference: {speed: 1.2, period: 0.9}\n")
    seed("free_body_settings", "cube", "free_body:\n  table: 0\n")
    nms = ("nms:\n  subject: subject.xml\n  as_ceinms: true\n  objective: thesis\n  joints: [ankle]\n  parameters:\n"
           "    filter_mean: {share: single, lower: -0.95, upper: -0.05}\n    shape: {share: single, lower: -2.9, upper: -0.1}\n"
           "    tendon_slack_length: {share: single, lower: 0.85, upper: 1.15, relative: true}\n"
           "    strength:\n      groups: {triceps: [soleus], front: [tibialis]}\n      lower: 0.5\n      upper: 2.5\n")
    seed("nms_settings", "thesis", nms)
    seed("nms_settings", "hybrid", nms + "  mode: {type: hybrid, alpha: 1, beta: 2, gamma: 3, synthesise: [soleus], adjust: [tibialis]}\n"
         "  steps:\n    - {joints: [ankle], parameters: [shape]}\n  fibre_range: {lower: 0.5, upper: 1.5}\n")


def add(file, path, value=None, **attributes):
    item = file.require_group(path) if value is None else file.create_dataset(path, data=value)
    for name, text in attributes.items():
        item.attrs[name] = text


DATASET = """ @sinew_schema "dataset/1
 @title "a knee
 @synthetic 1
trials/one @role "train
trials/one @task "swing
trials/one @speed_rad_per_s 0.5
trials/one/g/time 4 = 0 0.1 0.2 0.3
trials/one/g/channels/position 4 = 0 1 2 nan
trials/one/g/channels/position @unit "deg
trials/one/g/channels/position @kind "measured
trials/one/g/channels/position @sigma 0.1
trials/one/g/channels/torque 4 1 = 1 2 3 4
trials/one/g/channels/torque @unit "N*m
trials/one/g/channels/torque @kind "input
constants/gear_ratio = 120
constants/gear_ratio @unit "1
files/drive.yaml "drive:\\n  controller: {kind: none}\\n
"""
RUN = """run @sinew_schema "run/1
run @problem "drive
run @solver "lm
run @data_hash "0123
run @seed 3
run @version "0.1.0
run @cost 1.5
run @steps 2
run @finished 0
run/config "drive: {}
parameters/name ["inertia,"friction
parameters/value 2 = 1 2
parameters/kind ["base,"nuisance
parameters/trial [","one
parameters/free 2 = 1 1
parameters/prior_deviation 2 = nan 0.1
parameters/null 2 = nan 0
trace @variables "inertia,friction
trace/cost 2 = 3 1.5
trace/seconds 2 = 0.1 0.2
trace/x 2 2 = 0.1 0.2 0.3 0.4
trace/failures/reason ["no end
trace/failures/evaluation 1 = 1
searches/cost 1 = 1.5
searches/iterations 1 = 3
searches/max_evaluations 1 = inf
searches/first 1 = 0
searches/evaluations 1 = 2
searches/failures 1 = 1
searches/infeasible 1 = 0
searches/solver ["lm
searches/first_failure ["no end
searches/stop_reason ["cost_change
searches/stop_test ["gradient
searches/start 1 2 = 0.5 0.5
searches/x 1 2 = 0.3 0.4
resume/residuals/evaluation 1 = 1
resume/residuals/count 1 = 2
resume/residuals/numbers 2 = 1 2
resume/fits/question ["00112233445566778899aabbccddeeff
resume/fits/text ["channel
resume/fits/count 1 = 3
resume/fits/numbers 3 = 1 2 3
"""
STUDY = """study @sinew_schema "study/1
study/origin @problem "drive
study/origin @data_hash "0123
study/origin/config "drive: {}
study/origin/parameters/name ["a,"b
study/runs/solver ["lm,"sa
study/runs/stop_reason ["cost_change,"max_evaluations
study/runs/stop_test ["gradient,"500
study/runs/seed 2 = 1 2
study/runs/cost 2 = 1.5 2
study/runs/seconds 2 = 0.1 0.2
study/runs/evaluations 2 = 10 500
study/runs/values 2 2 = 1 2 3 4
study/improvements/run 2 = 0 1
study/improvements/evaluation 2 = 1 5
study/improvements/cost 2 = 3 2
study/improvements/seconds 2 = 0.05 0.1
"""


def hdf5():
    seed("dataset_file", "knee", DATASET)
    seed("run_file", "unfinished", RUN)
    seed("run_file", "diagnosis", RUN.replace('@solver "lm', '@solver "diagnose') + "diagnosis @verdict \"explained\n")
    seed("study_file", "two_runs", STUDY)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.h5"
        for name, settings_ in {"small": {}, "latest": {"libver": "latest"}}.items():
            with h5py.File(path, "w", **settings_) as file:
                add(file, "g", sinew_schema="dataset/1", number=np.int64(3), part=0.5)
                add(file, "g/vector", np.arange(4.0))
                add(file, "g/text", "one\ntwo")
            seed("hdf5_file", name, path.read_bytes())
        with h5py.File(path, "w") as file:
            file.create_dataset("deflated", data=np.arange(600.0), chunks=(300,), compression="gzip", shuffle=True)
            file.create_dataset("texts", data=["a", "bc"], dtype=h5py.string_dtype())
            file["soft"] = h5py.SoftLink("/deflated")
        seed("hdf5_file", "compressed", path.read_bytes())
        y, t = np.arange(5.0), 0.01 * np.arange(5.0)
        seed("mat_file", "version5", mat_files.version5(mat_files.numbers("t", t), mat_files.numbers("y", y),
                                                        mat_files.struct5("S", values=y, unit="V")))
        seed("mat_file", "spike2", mat_files.version5(mat_files.struct5("C1", **mat_files.channel("Torque", list(y)))))
        seed("mat_file", "table", mat_files.version5(mat_files.table("T")))
        seed("mat_file", "big_endian", mat_files.big_endian("y", y))
        path = Path(folder) / "x.mat"
        mat_files.write_version73(path, t=t, y=y, S={"values": y, "unit": "V"})
        seed("mat_file", "version73", path.read_bytes())


def words():
    seed("pipeline", "cohort", test_cohort.SUBJECTS + test_cohort.STEPS)
    seed("pipeline", "list", "subjects: [a, b]\nout: r\nsteps:\n  fit: {run: identify drive --data {subject}.h5 --out {out}/f.h5, reads: [x.yaml]}\n"
         .replace("{run: identify drive --data {subject}.h5 --out {out}/f.h5,", "{run: 'identify drive --data {subject}.h5 --out {out}/f.h5',"))
    for name, line in {"identify": "identify drive --data d.h5 --out r.h5 --free a,b --fix c=1 --bounds a=0:1e3 --seed 3 --json -",
                       "synthesize": "data synthesize contact --out x.h5 --set train=3 --effect drag:drag_coefficient=0.1,b=2 --noise 0",
                       "misspelt": "idetify drive --thrads=2 --solvers ,", "compare": "compare nms --data d.h5 --solvers sa+ceres,lm --repeats 2 --out s.h5",
                       "bounds": "a=1:2\nb=nan:inf\nc:x=1,y=2\n=\n:"}.items():
        seed("words", name, line.replace(" ", "\n"))
    seed("step_states", "two", '{"schema": "sinew.steps/1", "steps": {"data": {"progress": "done", "question": "00ff", "seconds": 1.5, "written": '
         '{"a.h5": "00"}}, "fit": {"progress": "failed", "question": "", "seconds": 0, "written": {}, "reason": "no"}}}\n')


if __name__ == "__main__":
    shutil.rmtree(CORPUS, ignore_errors=True)
    for make in (recordings, models, ceinms, settings, hdf5, words):
        make()
    sizes = [path.stat().st_size for path in CORPUS.rglob("*") if path.is_file()]
    print(f"{len(sizes)} seeds, {sum(sizes)} bytes")

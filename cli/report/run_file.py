"""What the report needs to find in a run, diagnosis or study file, checked before anything is drawn (docs/run_file.md)."""
import multiprocessing
import os
import pickle
from dataclasses import dataclass

import h5py

DIAGNOSIS, RUN, STUDY = "diagnosis", "run", "study"
SCHEMAS = {DIAGNOSIS: "diagnosis/1", RUN: "run/1", STUDY: "study/1"}  # a diagnosis is a run file as well: it goes first
RUN_ATTRIBUTES = ("problem", "solver", "seed", "version", "data_file", "data_hash", "finished",
                  "stop_reason", "stop_test", "converged", "usable", "evaluations", "failures", "iterations", "seconds",
                  "cost", "objective", "synthetic", "title")
DIAGNOSIS_ATTRIBUTES = ("problem", "seed", "version", "data_file", "data_hash", "finished", "stop_reason", "stop_test",
                        "converged", "usable", "seconds", "objective", "synthetic", "title")
DIAGNOSIS_VERDICTS = ("adequate", "explained", "ambiguous", "unexplained")
FINDINGS = ("cause", "alternative", "withdrawn", "unknown_term", "ruled_out", "not_judged")
DIAGNOSED_COLUMNS = ("effect", "name", "unit", "value", "std_error", "ci95_lower", "ci95_upper", "before")
DIAGNOSIS_TABLES = {
    "scores": ("effect", "level", "finding", "probe", "why_not", "detectable_parameter", "detectable_unit", "known", "judged",
               "refitted", "statistic", "p_value", "family_p_value", "delta_lr", "delta_bic", "smallest_detectable"),
    "causes": ("effect", "level", "sentence", "p_value", "delta_bic", "size"), "cause_parameters": DIAGNOSED_COLUMNS,
    "alternatives": ("instead_of", "effect", "level", "sentence", "separated_by", "delta_lr", "correlation"),
    "alternative_parameters": DIAGNOSED_COLUMNS, "withdrawn": ("effect", "reason")}
FITTED_TABLES = {  # only with a base fit
    "base_parameters": DIAGNOSED_COLUMNS, "extended_parameters": DIAGNOSED_COLUMNS,
    "base_fit": ("role", "channel", "unit", "rmse", "r2", "n"), "extended_fit": ("role", "channel", "unit", "rmse", "r2", "n"),
    "noise": ("channel", "unit", "basis", "sigma", "rmse"), "tests": ("channel", "test", "statistic", "p_value"),
    "gain": ("channel", "unit", "before", "after", "reduction", "ci95_lower", "ci95_upper", "gap_closed")}
CHOICE_TABLES = {"ladder": ("effects", "error"), "chosen_shares": ("effect", "share")}  # files of earlier versions have none
CURVES = {"structure": (("knots", "curve"), ("channel", "signal", "signal_unit", "explained_fraction", "shape")),
          "unknown_terms": (("knots", "curve", "deviation"),
                            ("port", "signal", "signal_unit", "unit", "shape", "nearest_law", "p_value",
                             "held_out_reduction"))}
PARAMETER_COLUMNS = ("name", "unit", "meaning", "kind", "scale", "lower", "upper", "start", "value", "free")
UNCERTAINTY_COLUMNS = ("name", "verdict", "reason", "remedy", "interval", "std_error", "ci95_lower", "ci95_upper")
VERDICTS = ("identifiable", "weak", "not_identifiable", "at_bound")
DETERMINED = ("identifiable", "weak")  # has a value of its own: correlations with it mean something
STUDY_COLUMNS = ("solver", "seed", "cost", "success", "evaluations", "evaluations_to_target", "seconds",
                 "seconds_to_target", "stop_reason", "values")
DYNAMOMETER_COLUMNS = ("time", "machine_angle", "machine_torque", "torque_of_attachment", "torque_of_sole", "torque_of_straps",
                       "interaction_torque", "ankle_angle", "moment_of_muscles", "moment_passive", "power_of_muscles",
                       "power_to_machine", "power_lost_in_boundary")
CONTACT_ARRAYS = ("time", "outline", "pressure", "slip", "centre_of_pressure")
DEEPEST = 32
CHECK_SECONDS = 30  # a check reads names and sizes, not data: it takes milliseconds


class BadInput(Exception):
    """A file that cannot be reported on; the message is one line for a person."""


@dataclass
class ReportFile:
    """A checked file: what it is, and which parts of it there are to draw."""
    path: str
    kind: str          # RUN, DIAGNOSIS or STUDY
    title: str
    has: frozenset     # of the parts in publish.RUN_PARTS or publish.DIAGNOSIS_PARTS


def read_all(paths):
    """Checks files of which each is given once. Raises BadInput as `read` does, and for a file that is given twice."""
    files = [read(path) for path in paths]
    seen = set()
    for file in files:
        if os.path.realpath(file.path) in seen:
            raise BadInput(f"{file.path}: is given twice")
        seen.add(os.path.realpath(file.path))
    return files


def read(path):
    """Checks a file.

    Raises BadInput: no such file, not HDF5, damaged, not a run or study file, a part missing or misshapen.
    """
    if not os.path.exists(path):
        raise BadInput(f"{path}: no such file")
    if os.path.isdir(path):
        raise BadInput(f"{path}: is a folder, expected a file that sinew identify, diagnose or compare wrote")
    if not os.path.isfile(path):
        raise BadInput(f"{path}: is a device, a pipe or a socket, expected a file that sinew identify, diagnose or compare wrote")
    answer = _in_own_process(_look, path)
    if answer is None:
        raise BadInput(f"{path}: is damaged: the HDF5 library cannot read it")
    if isinstance(answer, str):
        raise BadInput(answer)
    return answer


def _look(path):
    """The checked file, or the sentence that says what is wrong with it."""
    try:
        with h5py.File(path, "r") as file:
            _refuse_other_files(path, file)
            return _check(path, file)
    except BadInput as error:
        return _one_line(error)
    except Exception as error:  # whatever damaged bytes make the library raise
        return f"{path}: cannot be read as HDF5: {_one_line(error)}"


def _refuse_other_files(path, group, depth=0):
    """A file of somebody else may lead to any file of the user: by links, or as the home of its numbers."""
    if depth > DEEPEST:
        raise BadInput(f"{path}: groups nested more than {DEEPEST} deep")
    for name in group:
        link = group.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            raise BadInput(f"{path}: {group.name}: member '{name}' is a link, expected the data themselves")
        node = group[name]
        if isinstance(node, h5py.Group):
            _refuse_other_files(path, node, depth + 1)
        elif isinstance(node, h5py.Dataset):
            made = node.id.get_create_plist()
            if made.get_external_count() > 0 or made.get_layout() == h5py.h5d.VIRTUAL:
                raise BadInput(f"{path}: {node.name}: its numbers are in another file, expected them in this one")


def _in_own_process(function, argument):
    """function(argument), or None where it crashes or hangs: the HDF5 library does both on damaged bytes."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=lambda: sender.send(function(argument)))
    process.start()
    sender.close()
    try:
        return receiver.recv() if receiver.poll(CHECK_SECONDS) else None
    except (EOFError, pickle.UnpicklingError):  # it died, before its answer or within it
        return None
    finally:
        process.kill()
        process.join()


def _one_line(error):
    return " ".join(str(error).split())


def _text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def _schema(node):
    return _text(node.attrs.get("sinew_schema", ""))


def _check(path, file):
    for kind, schema in SCHEMAS.items():
        node = file.get(kind)
        if isinstance(node, h5py.Group) and "sinew_schema" in node.attrs:
            if _schema(node) != schema:
                raise BadInput(f"{path}: /{kind} has schema '{_schema(node)}', expected '{schema}'")
            return {RUN: _check_run, DIAGNOSIS: _check_diagnosis, STUDY: _check_study}[kind](path, file)
    found = f"it is a {_schema(file)} file" if "sinew_schema" in file.attrs else "it has neither /run nor /study"
    raise BadInput(f"{path}: is not a run file ({found}); expected what sinew identify, diagnose or compare writes")


def _columns(path, file, group, names):
    """All columns there, and as long as the first. Returns that length."""
    node = file.get(group)
    if not isinstance(node, h5py.Group):
        raise BadInput(f"{path}: {group} is missing")
    for name in names:
        if not isinstance(node.get(name), h5py.Dataset):
            raise BadInput(f"{path}: {group}/{name} is missing")
        if not node[name].shape:
            raise BadInput(f"{path}: {group}/{name} is a single value, expected a list")
        if node[name].shape[0] != node[names[0]].shape[0]:
            raise BadInput(f"{path}: {group}/{name} has {node[name].shape[0]} entries, "
                           f"{group}/{names[0]} has {node[names[0]].shape[0]}")
    return node[names[0]].shape[0]


def _attributes(path, node, where, names):
    for name in names:
        if name not in node.attrs:
            raise BadInput(f"{path}: {where} has no attribute '{name}'")


def _texts(node):
    return [str(text) for text in node.asstr()[()]]


def _check_run(path, file):
    info = file["run"]
    _attributes(path, info, "/run", RUN_ATTRIBUTES)
    _columns(path, file, "/parameters", PARAMETER_COLUMNS)
    has = {"parameters"}
    for trial, channels in file.get("prediction", {}).items():
        for channel, node in channels.items():
            where = f"/prediction/{trial}/{channel}"
            _columns(path, file, where, ("time", "simulated", "measured"))
            _attributes(path, node, where, ("unit", "quantity", "role", "n", "rmse", "r2"))
            residual = f"/residual/{trial}/{channel}"
            if residual in file:
                _columns(path, file, residual, ("time", "residual"))
            has |= {"prediction", "unmeasured" if node.attrs["n"] == 0 else
                    "unused" if _text(node.attrs["role"]) == "predicted" else "fit"}
    if "uncertainty" in file and "name" in file["uncertainty"]:
        count = _columns(path, file, "/uncertainty", UNCERTAINTY_COLUMNS)
        for verdict in _texts(file["uncertainty/verdict"]):
            if verdict not in VERDICTS:
                raise BadInput(f"{path}: /uncertainty/verdict is '{verdict}', expected one of {', '.join(VERDICTS)}")
        kinds = dict(zip(_texts(file["parameters/name"]), _texts(file["parameters/kind"])))
        verdicts = zip(_texts(file["uncertainty/name"]), _texts(file["uncertainty/verdict"]))
        determined = [name for name, verdict in verdicts
                      if verdict in DETERMINED and kinds.get(name) != "nuisance"]
        if len(determined) >= 2 and "correlation" in file["uncertainty"]:
            if file["uncertainty/correlation"].shape != (count, count):
                raise BadInput(f"{path}: /uncertainty/correlation is {file['uncertainty/correlation'].shape}, "
                               f"expected {(count, count)}")
            has.add("correlation")
    if "trace" in file and _columns(path, file, "/trace", ("cost", "seconds")) > 0:
        has.add("convergence")
    if "stages" in file and _columns(path, file, "/stages", ("solver", "cost", "evaluations")) > 1 \
            and any(name in str(info.attrs["solver"]) for name in ("multistart", "restarts")):
        has.add("starts")
    for trial, plates in file.get("details/motion_errors", {}).items():
        for plate in plates:
            _check_motion(path, file, f"/details/motion_errors/{trial}/{plate}")
            has.add("motion")
    for trial, node in file.get("details/ankle_on_dynamometer", {}).items():
        if "interaction_torque" in node:
            _columns(path, file, f"/details/ankle_on_dynamometer/{trial}", DYNAMOMETER_COLUMNS)
            has.add("dynamometer")
    for trial, regions in file.get("details/contact", {}).items():
        for region in regions:
            _check_region(path, file, f"/details/contact/{trial}/{region}")
            has.add("contact")
    return ReportFile(path, RUN, f"{_text(info.attrs['problem'])}: {_subject(path, info)}", frozenset(has))


def _check_diagnosis(path, file):
    info = file.get("run")
    if not isinstance(info, h5py.Group):
        raise BadInput(f"{path}: /run is missing")
    _attributes(path, info, "/run", DIAGNOSIS_ATTRIBUTES)
    node = file["diagnosis"]
    _attributes(path, node, "/diagnosis", ("verdict", "alarm_level", "threshold", "family_p_value"))
    _one_of(path, "/diagnosis@verdict", [_text(node.attrs["verdict"])], DIAGNOSIS_VERDICTS)
    fitted = "parameters" in file
    lengths = {name: _columns(path, file, f"/diagnosis/{name}", columns)
               for name, columns in {**DIAGNOSIS_TABLES, **(FITTED_TABLES if fitted else {})}.items()}
    if fitted:
        _columns(path, file, "/parameters", (*PARAMETER_COLUMNS, "before"))
    _one_of(path, "/diagnosis/scores/finding", _texts(node["scores/finding"]), FINDINGS)
    has = {name for name in ("scores", "gain") if lengths.get(name)} | ({"parameters"} if fitted else set())
    for name, columns in CHOICE_TABLES.items():
        if name in node and _columns(path, file, f"/diagnosis/{name}", columns) > 1 and name == "ladder":
            has.add("choice")
    for group, (arrays, attributes) in CURVES.items():
        for number, curve in node.get(group, {}).items():
            _columns(path, file, f"/diagnosis/{group}/{number}", arrays)
            _attributes(path, curve, f"/diagnosis/{group}/{number}", attributes)
            has.add({"structure": "structure", "unknown_terms": "unknown"}[group])
    for trial, channels in node.get("traces", {}).items():
        for channel, trace in channels.items():
            where = f"/diagnosis/traces/{trial}/{channel}"
            if _columns(path, file, where, ("time", "measured", "before", "after")):
                _attributes(path, trace, where, ("unit", "role"))
                has.add("traces")
    if not lengths["causes"] and "unknown" not in has:
        has.discard("gain")  # nothing was added that could bring any
    return ReportFile(path, DIAGNOSIS, f"{_text(info.attrs['problem'])}: diagnosis of {_subject(path, info)}", frozenset(has))


def _one_of(path, where, words, allowed):
    for word in words:
        if word not in allowed:
            raise BadInput(f"{path}: {where} is '{word}', expected one of {', '.join(allowed)}")


def _subject(path, info):
    """What was identified: the title of the data set; if it has none, the name of its file."""
    names = (_text(info.attrs["title"]).strip(), _stem(_text(info.attrs["data_file"])), _stem(path))
    return next(name for name in names if name)


def _stem(path):
    return os.path.splitext(os.path.basename(path))[0]


def _check_motion(path, file, where):
    instants = _columns(path, file, where, ("time", "deviation", "common"))
    components = _columns(path, file, where, ("component", "prior"))
    for name in ("deviation", "common"):
        if file[f"{where}/{name}"].shape != (instants, components) or instants == 0 or components == 0:
            raise BadInput(f"{path}: {where}/{name} has shape {file[f'{where}/{name}'].shape}, "
                           f"expected {(instants, components)}, not empty")


def _check_region(path, file, where):
    _columns(path, file, where, ("time", "pressure", "slip", "centre_of_pressure"))
    _attributes(path, file[where], where, ("body", "plate"))
    shapes = {name: file[f"{where}/{name}"].shape for name in CONTACT_ARRAYS if f"{where}/{name}" in file}
    instants = shapes["time"][0]
    faces = shapes.get("outline", (0,))[0]
    expected = {"time": (instants,), "outline": (faces, 3, 2), "pressure": (instants, faces),
                "slip": (instants, faces), "centre_of_pressure": (instants, 2)}
    for name in CONTACT_ARRAYS:
        if shapes.get(name) != expected[name] or instants == 0 or faces == 0:
            raise BadInput(f"{path}: {where}/{name} has shape {shapes.get(name)}, "
                           f"expected {expected[name]}, not empty")


def _check_study(path, file):
    info = file["study"]
    _attributes(path, info, "/study", ("problem", "target"))
    runs = _columns(path, file, "/study/runs", STUDY_COLUMNS)
    if runs == 0:
        raise BadInput(f"{path}: /study/runs is empty")
    parameters = _columns(path, file, "/study/parameters", ("name",))
    if file["study/runs/values"].shape != (runs, parameters):
        raise BadInput(f"{path}: /study/runs/values is {file['study/runs/values'].shape}, "
                       f"expected {(runs, parameters)}")
    return ReportFile(path, STUDY, f"{info.attrs['problem']}: solvers compared", frozenset())

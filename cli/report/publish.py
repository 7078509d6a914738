"""From checked files to a folder of notebooks and pages, all or nothing. What a stopped report of several files had executed is kept,
out of sight, for the next one."""
import asyncio
import contextlib
import os
import threading
from concurrent.futures import ThreadPoolExecutor, wait

import nbformat

import interrupt
import kept_pages
import notebook
import page
import replace
import run_file

RUN_PARTS = (("prediction", "run_prediction"), ("fit", "run_fit"), ("unused", "run_unused"),
             ("unmeasured", "run_unmeasured"), ("parameters", "run_parameters"), ("correlation", "run_correlation"),
             ("convergence", "run_convergence"), ("starts", "run_starts"), ("motion", "run_motion"),
             ("dynamometer", "run_dynamometer"), ("contact", "run_contact"))
DIAGNOSIS_PARTS = (("traces", "diagnosis_residuals"), ("scores", "diagnosis_scores"), ("choice", "diagnosis_choice"),
                   ("structure", "diagnosis_structure"),
                   ("unknown", "diagnosis_unknown"), ("gain", "diagnosis_gain"),
                   ("parameters", "diagnosis_parameters"))
OVERVIEW = "index"
LISTEN_SECONDS = 0.1


class ReportFailed(Exception):
    """The input is fine, yet the report could not be made."""


def publish(files, out_dir, threads=os.cpu_count() or 1):
    """Writes the report of files that run_file has read, and returns the path of the page to open first.

    One file: index.ipynb and index.html. Several: a pair per file, named like it, and an index that compares them.
    Raises run_file.BadInput before anything is written, ReportFailed and interrupt.Interrupted after undoing what was
    written. Interrupted has a second argument: how many notebooks are done and kept.
    """
    folder = os.path.realpath(out_dir)
    made = _make_folder(out_dir, folder)
    kept = kept_pages.KeptPages(folder)
    try:
        entry = _publish_into(folder, out_dir, files, threads, kept)
        kept.remove()
        return entry
    except interrupt.Interrupted as error:
        raise interrupt.Interrupted(error.args[0], kept.number()) from error
    except ReportFailed:
        kept.remove()
        raise
    finally:
        _remove_empty(made)


def _publish_into(folder, out_dir, files, threads, kept):
    notebooks, read = {}, {}
    if len(files) == 1:
        notebooks[OVERVIEW] = _notebook_of(files[0], folder)
    else:
        names = _names(files)
        for file, name in zip(files, names):
            notebooks[name] = _notebook_of(file, folder)
            read[name] = [file.path]
        notebooks[OVERVIEW] = _overview(files, names, folder)
        read[OVERVIEW] = [file.path for file in files]
    _check_inputs_stay(files, folder, notebooks)
    # One notebook takes seconds: nothing of it is worth keeping.
    try:
        rest = kept.take(notebooks, read) if len(files) > 1 else list(notebooks)
    except OSError as error:
        raise ReportFailed(f"{error.filename}: cannot be read: {error.strerror}") from error
    try:
        if rest:
            _execute_apart({name: notebooks[name] for name in rest}, folder, threads, kept if len(files) > 1 else None)
    except notebook.NotebookFailed as error:
        raise ReportFailed(str(error)) from error

    texts = {}
    for name, content in notebooks.items():
        home = f"{OVERVIEW}.html" if len(files) > 1 and name != OVERVIEW else ""
        texts[f"{name}.ipynb"] = nbformat.writes(content) + "\n"
        texts[f"{name}.html"] = page.render(content, f"{name}.ipynb", home)
    interrupt.stop_if_pressed()  # for the last time: what follows takes no time
    _write_all(folder, texts)
    return os.path.join(out_dir, f"{OVERVIEW}.html")


def _make_folder(out_dir, folder):
    """Makes the folder and its parents; returns those made, innermost first."""
    made = []
    path = folder
    while not os.path.lexists(path):
        made.append(path)
        path = os.path.dirname(path)
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        _remove_empty(made)
        raise run_file.BadInput(f"{out_dir}: cannot be made as a folder: {error.strerror}") from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise run_file.BadInput(f"{out_dir}: nothing can be written there")
    return made


def _remove_empty(folders):
    """Takes back folders that were made for nothing, innermost first."""
    if interrupt.orphaned():
        return
    for path in folders:
        if os.path.isdir(path) and not os.listdir(path):
            os.rmdir(path)


def _names(files):
    """A page name per file: its stem, with the folder before it where stems repeat."""
    def stem(path):
        return os.path.splitext(os.path.basename(path))[0]

    stems = [stem(file.path) for file in files]
    names = []
    for file, name in zip(files, stems):
        if stems.count(name) > 1 or name == OVERVIEW:
            name = f"{os.path.basename(os.path.dirname(os.path.realpath(file.path)))}_{name}"
        base, number = name, 2
        while name in names or name == OVERVIEW:
            name, number = f"{base}_{number}", number + 1
        names.append(name)
    return names


def _check_inputs_stay(files, folder, names):
    """No page may take the place of a file that it shows, whatever that is called."""
    written = {os.path.realpath(os.path.join(folder, name + ending)) for name in names for ending in (".ipynb", ".html")}
    for file in files:
        if os.path.realpath(file.path) in written:
            raise run_file.BadInput(f"{file.path}: is read by this command and would be overwritten; expected another "
                                    "--out-dir")


def _relative(path, folder):
    return os.path.relpath(os.path.realpath(path), folder)


def _notebook_of(file, folder):
    cells = ["study"]
    if file.kind == run_file.RUN:
        cells = ["run_start"] + [cells for part, cells in RUN_PARTS if part in file.has] + ["run_end"]
    if file.kind == run_file.DIAGNOSIS:
        cells = ["diagnosis_start"] + [cells for part, cells in DIAGNOSIS_PARTS if part in file.has] + ["diagnosis_end"]
    return notebook.build(cells, file.title, {"RUN_FILE": _relative(file.path, folder)})


def _overview(files, names, folder):
    paths = {kind: {name: _relative(file.path, folder) for file, name in zip(files, names) if file.kind == kind}
             for kind in run_file.SCHEMAS}
    return notebook.build(["comparison"], f"{len(files)} results",
                          {"RUN_FILES": paths[run_file.RUN], "STUDY_FILES": paths[run_file.STUDY],
                           "DIAGNOSIS_FILES": paths[run_file.DIAGNOSIS]})


def _execute_apart(notebooks, folder, threads, kept):
    """Executes all notebooks in a thread of its own, so that a Ctrl-C ends the kernels in order."""
    begun = threading.Event()
    running = {}

    async def work():
        running["loop"], running["task"] = asyncio.get_running_loop(), asyncio.current_task()
        begun.set()
        await _execute_all(notebooks, folder, threads, kept)

    with ThreadPoolExecutor(max_workers=1) as pool:
        outcome = pool.submit(lambda: asyncio.run(work()))
        while not wait([outcome], timeout=LISTEN_SECONDS).done:
            if interrupt.pressed():
                begun.wait()
                with contextlib.suppress(RuntimeError):  # closed: done in this very moment
                    running["loop"].call_soon_threadsafe(running["task"].cancel)
                wait([outcome])
    interrupt.stop_if_pressed()
    outcome.result()


async def _execute_all(notebooks, folder, threads, kept):
    """As many kernels at once as there are threads; the first failure ends all."""
    free = asyncio.Semaphore(threads)

    async def execute(name, content):
        async with free:
            try:
                await notebook.execute(content, folder)
                if kept is not None:
                    kept.keep(name, content)
            except notebook.NotebookFailed as error:
                raise notebook.NotebookFailed(f"{name}.ipynb: {error}") from error

    tasks = [asyncio.ensure_future(execute(*entry)) for entry in notebooks.items()]
    done = ()
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_EXCEPTION)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)  # every kernel is down before we leave
    for task in done:
        task.result()


def _write_all(folder, texts):
    """Everything under temporary names first, then renamed: a full disk leaves the old report as it was."""
    try:
        replace.replace_all(folder, texts)
    except OSError as error:
        raise ReportFailed(f"{folder}: cannot be written: {error.strerror}") from error

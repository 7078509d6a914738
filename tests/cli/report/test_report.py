"""The report, through its command line, on fabricated files.

    /usr/bin/python3 -B -m unittest discover -s tests/cli/report
"""
import asyncio
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

import h5py
import nbformat
import numpy as np

HERE = Path(__file__).resolve().parent
PROGRAM = HERE.parents[2] / "cli" / "report" / "sinew_report.py"
sys.path[:0] = [str(HERE), str(PROGRAM.parent)]

import fabricated_files  # noqa: E402
import interrupt  # noqa: E402
import notebook  # noqa: E402
import publish  # noqa: E402
import run_file  # noqa: E402


def report(*arguments, **changes):
    """Runs the report; returns status, stdout, stderr. changes: of the environment."""
    done = subprocess.run([sys.executable, str(PROGRAM), *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, **changes}, check=False)
    return done.returncode, done.stdout, done.stderr


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        self.run_path = self.folder / "run.h5"
        self.out = self.folder / "pages" / "demo"

    def check_notebook(self, path):
        """Executed from first to last cell, without an error. Returns all text of its outputs."""
        notebook = json.loads(path.read_text())
        text = []
        for cell in notebook["cells"]:
            if cell["cell_type"] != "code":
                continue
            self.assertIsNotNone(cell["execution_count"])
            for output in cell["outputs"]:
                self.assertNotEqual(output["output_type"], "error")
                self.assertNotEqual(output.get("name"), "stderr", output)
                text.append("".join(output.get("data", {}).get("text/html", "")))
        return " ".join(text)

    def check_page(self, path):
        """Loads nothing from anywhere. Returns its text."""
        page = path.read_text()
        self.assertNotRegex(page, r"<(script|link|iframe|object|embed)\b")
        self.assertNotRegex(page, r"""(src|srcset|data|action)\s*=\s*["']?\s*(https?:|//|file:)""")
        self.assertNotRegex(page, r"""href\s*=\s*["']?\s*(https?:|//|file:)""")
        self.assertNotRegex(page, r"(@import|url\s*\()")
        return page


class OneRun(WithFolder):
    def test_says_the_findings_and_draws_every_part(self):
        fabricated_files.write_run(self.run_path, contact=("left_sole", "right_sole"))
        status, said, complaint = report(self.run_path, "--out-dir", self.out)
        self.assertEqual((status, complaint), (0, ""))
        self.assertEqual(said.strip(), f"Report: {self.out}/index.html")
        self.assertEqual(sorted(os.listdir(self.out)), ["index.html", "index.ipynb"])

        text = self.check_notebook(self.out / "index.ipynb")
        page = self.check_page(self.out / "index.html")
        for where in (text, page):
            self.assertIn("Measuring the tangential force would determine all three friction parameters.", where)
            self.assertIn("2 simulations failed &lt; 1\u00a0% of the time", where)  # texts are escaped
            self.assertIn("synthetic data", where)
            self.assertIn("8.97e5", where)
            self.assertIn("± 0.11e5", where)  # with the exponent of the value
            self.assertEqual(where.count("○ not identifiable"), 3)
        self.assertIn("made-up stances &#38; &#60;nothing measured&#62;", page.replace("&amp;", "&#38;")
                      .replace("&lt;", "&#60;").replace("&gt;", "&#62;"))
        for section in ("Measured against simulated", "Parameters", "Correlations", "Search",
                        "Pressure under the sole"):
            self.assertIn(section, page)
        # fit, not used, not measured, bounds, correlation, convergence, two of the sole
        self.assertEqual(page.count("data:image/png;base64,"), 8)
        self.assertLess(page.index("vertical force on level ground"), page.index("data:image/png"))

    def test_notebook_names_the_run_file_relative_to_itself(self):
        fabricated_files.write_run(self.run_path, contact=())
        self.assertEqual(report(self.run_path, "--out-dir", self.out)[0], 0)
        self.assertIn('RUN_FILE = \\"../../run.h5\\"', (self.out / "index.ipynb").read_text())

    def test_unfinished_and_bare_run_is_reported_and_says_so(self):
        fabricated_files.write_run(self.run_path, contact=(), finished=0, usable=0)
        with h5py.File(self.run_path, "a") as file:
            for part in ("prediction", "residual", "uncertainty", "stages", "trace", "run/config"):
                del file[part]
        status, _, complaint = report(self.run_path, "--out-dir", self.out)
        self.assertEqual((status, complaint), (0, ""))
        page = self.check_page(self.out / "index.html")
        self.assertIn("This run has not finished", page)
        self.assertIn("not usable", page)
        self.assertLess(page.index("not usable"), page.index("is matched to 2.1 N"))
        self.assertNotIn("Measured against simulated", page)

    def test_environment_of_the_user_changes_nothing(self):
        fabricated_files.write_run(self.run_path)
        self.assertEqual(report(self.run_path, "--out-dir", self.out)[0], 0)
        hostile = self.folder / "hostile"
        for path, text in {"bin/python3": "#!/bin/sh\nexit 9\n", "numpy.py": "raise ImportError('wrong numpy')\n",
                           "profile_default/startup/first.py": "import sys\nsys.exit(9)\n",
                           "kernels/python3/kernel.json": '{"argv": ["/bin/false"], "display_name": "no", "language": "x"}',
                           "matplotlibrc": "text.usetex: True\n"}.items():
            (hostile / path).parent.mkdir(parents=True, exist_ok=True)
            (hostile / path).write_text(text)
        (hostile / "bin/python3").chmod(0o755)
        other = self.folder / "pages" / "other"
        status, _, complaint = report(self.run_path, "--out-dir", other, PATH=f"{hostile}/bin:{os.environ['PATH']}",
                                      PYTHONPATH=str(hostile), IPYTHONDIR=str(hostile), JUPYTER_PATH=str(hostile),
                                      MATPLOTLIBRC=str(hostile), MPLBACKEND="pdf")
        self.assertEqual((status, complaint), (0, ""))
        for name in ("index.ipynb", "index.html"):
            self.assertEqual((self.out / name).read_bytes(), (other / name).read_bytes())

    def test_lock_that_a_killed_program_left_on_the_list_of_fonts_stops_nothing(self):
        fabricated_files.write_run(self.run_path, contact=())
        home = self.folder / "home"
        cache = home / ".cache" / "matplotlib"
        changes = {"HOME": str(home), "XDG_CACHE_HOME": "", "MPLCONFIGDIR": ""}
        self.assertEqual(report(self.run_path, "--out-dir", self.out, **changes)[::2], (0, ""))
        fonts, = os.listdir(cache)  # kept for the next report
        self.assertRegex(fonts, r"^fontlist-v\d+\.json$")

        (cache / fonts).unlink()
        lock = cache / f"{fonts}.matplotlib-lock"
        lock.touch()
        self.assertEqual(report(self.run_path, "--out-dir", self.out, **changes)[::2], (0, ""))
        self.assertEqual(sorted(os.listdir(cache)), [fonts, lock.name])

    def test_failure_to_draw_is_status_1_and_leaves_the_old_report(self):
        fabricated_files.write_run(self.run_path)
        with h5py.File(self.run_path, "a") as file:
            file["run"].attrs["seconds"] = "soon"
        status, _, complaint = report(self.run_path, "--out-dir", self.out)
        self.assertEqual(status, 1)
        self.assertRegex(complaint, r"^sinew: the report could not be made: index\.ipynb: TypeError: [^\n]+\n$")
        self.assertFalse(self.out.parent.exists())

        self.out.mkdir(parents=True)
        (self.out / "index.html").write_text("old")
        self.assertEqual(report(self.run_path, "--out-dir", self.out)[0], 1)
        self.assertEqual(os.listdir(self.out), ["index.html"])
        self.assertEqual((self.out / "index.html").read_text(), "old")

    def begin(self, **how):
        program = subprocess.Popen([sys.executable, str(PROGRAM), str(self.run_path), "--out-dir", str(self.out)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **how)
        self.addCleanup(program.kill)
        return program

    def check_interrupted(self, program, stop=signal.SIGINT):
        said, complaint = program.communicate()
        self.assertEqual((program.returncode, said), (128 + stop, ""), complaint)
        self.assertEqual(complaint, f"sinew: stopped by {stop.name}; nothing was written: begin it again\n")
        self.assertFalse(self.out.parent.exists())

    def test_ctrl_c_while_it_starts_ends_in_one_line_and_writes_nothing(self):
        fabricated_files.write_run(self.run_path)
        # As sinew starts it, with the signal held.
        program = self.begin(preexec_fn=lambda: signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}))
        program.send_signal(signal.SIGINT)
        self.check_interrupted(program)

    def test_ctrl_c_while_the_notebook_runs_ends_in_one_line_and_writes_nothing(self):
        fabricated_files.write_run(self.run_path)
        program = self.begin()
        while not self.out.exists() and program.poll() is None:
            time.sleep(0.01)
        program.send_signal(signal.SIGINT)
        program.send_signal(signal.SIGINT)
        self.check_interrupted(program)

    def test_the_signal_of_a_batch_system_too(self):
        fabricated_files.write_run(self.run_path)
        program = self.begin()
        while not self.out.exists() and program.poll() is None:
            time.sleep(0.01)
        program.send_signal(signal.SIGTERM)
        self.check_interrupted(program, signal.SIGTERM)

    def test_ctrl_c_once_the_notebook_is_done_writes_nothing(self):
        fabricated_files.write_run(self.run_path)
        execute_all = publish._execute_all

        async def press_at_the_end(*arguments):
            await execute_all(*arguments)
            os.kill(os.getpid(), signal.SIGINT)

        held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            with mock.patch.object(publish, "_execute_all", press_at_the_end):
                with self.assertRaises(interrupt.Interrupted):
                    publish.publish(run_file.read_all([self.run_path]), str(self.out))
        finally:
            signal.sigtimedwait({signal.SIGINT}, 0)
            signal.pthread_sigmask(signal.SIG_SETMASK, held)
        self.assertFalse(self.out.parent.exists())


class StoppedReportOfSeveral(WithFolder):
    def setUp(self):
        super().setUp()
        self.paths = [self.folder / f"run_{number}.h5" for number in range(2)]
        for number, path in enumerate(self.paths):
            fabricated_files.write_run(path, contact=(), seed=number + 1)

    def publish(self, stop_after=None):
        """One notebook at a time; stopped once so many are executed. Returns how many were, and how many are kept."""
        execute, executed = notebook.execute, []

        async def count(content, folder):
            await execute(content, folder)
            executed.append(content)

        stopped = mock.patch.object(interrupt, "pressed", lambda: signal.SIGTERM if len(executed) == stop_after else None)
        with mock.patch.object(notebook, "execute", count), stopped:
            try:
                publish.publish(run_file.read_all(self.paths), str(self.out), 1)
            except interrupt.Interrupted as error:
                self.assertEqual(os.listdir(self.out), [".sinew-report"])
                return len(executed), error.args[1]
        self.assertEqual(len(os.listdir(self.out)), 6)
        return len(executed), 0

    @staticmethod
    def stop(*_):
        raise interrupt.Interrupted(signal.SIGTERM)

    def test_the_next_one_executes_only_the_rest(self):
        self.assertEqual(self.publish(), (3, 0))
        whole = {path.name: path.read_bytes() for path in self.out.iterdir()}
        shutil.rmtree(self.out)
        self.assertEqual(self.publish(stop_after=1), (1, 1))
        self.assertEqual(self.publish(stop_after=1), (1, 2))
        with mock.patch.object(publish, "_write_all", self.stop):
            self.assertEqual(self.publish(), (1, 3))
        self.assertEqual(self.publish(), (0, 0))
        self.assertEqual({path.name: path.read_bytes() for path in self.out.iterdir()}, whole)

    def test_a_page_of_a_changed_file_or_a_damaged_one_is_made_again(self):
        self.assertEqual(self.publish(stop_after=1), (1, 1))
        for path in (self.out / ".sinew-report").iterdir():
            whole = path.read_text()
            for damaged in (whole[:100], "", "[]", "{}", whole.replace('"cells"', '"sells"'),
                            '{"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}'):
                path.write_text(damaged)
                kept = publish.kept_pages.KeptPages(str(self.out))
                kept.digests["page"] = path.stem
                executed = kept._read("page")
                self.assertTrue(executed is None or not executed.cells, damaged[:100])
        self.assertEqual(self.publish(stop_after=1), (1, 1))
        for path in self.paths:
            with h5py.File(path, "a") as file:
                file["run"].attrs["seconds"] = 77.0
        self.assertEqual(self.publish(stop_after=1), (1, 1))


class WhatTheRunSays(WithFolder):
    """Names of the cells, asked in a notebook of some of the cells: what stands in a picture no test can read."""

    def answers(self, cells, *expressions):
        content = notebook.build(["run_start", *cells], "asked", {"RUN_FILE": str(self.run_path)})
        question = nbformat.v4.new_code_cell("\n".join(f"print({expression})" for expression in expressions))
        question.metadata["name"] = "question"
        content.cells.append(question)
        asyncio.run(notebook.execute(content, str(self.folder)))
        return content.cells[-1].outputs[0].text.splitlines()

    def pooled(self, trials):
        with h5py.File(self.run_path) as file:
            residuals = [file[f"residual/{trial}/right_force_y/residual"][:] for trial in trials]
            measured = [file[f"prediction/{trial}/right_force_y/measured"][:] for trial in trials]
        errors = sum((r ** 2).sum() for r in residuals)
        deviations = sum(((m - np.nanmean(m))[np.isfinite(m)] ** 2).sum() for m in measured)
        return np.sqrt(errors / sum(map(len, residuals))), 1 - errors / deviations

    def test_fit_is_told_by_quantity_with_pooled_errors(self):
        fabricated_files.write_run(self.run_path)
        finding, quantities, unused, unmeasured = self.answers(
            ["run_prediction", "run_fit"], "finding_of(('vertical force', 'N'), ['right plate'])", "quantities",
            "list(unused)", "list(unmeasured)")
        (here, here_r2), (there, there_r2) = self.pooled(["stance_1", "stance_2"]), self.pooled(["stance_3"])
        self.assertEqual(finding, f"Vertical force, right plate: RMSE {here:.2f} N (R² {here_r2:.3f}) on fitted trials, "
                                  f"{there:.2f} N (R² {there_r2:.3f}) on held-out trials")
        self.assertEqual(quantities, "[('vertical force', 'N')]")
        self.assertEqual(unused, "[('sideways force', 'N')]")
        self.assertEqual(unmeasured, "[('forward force', 'N')]")

    def test_measured_channels_that_were_not_fitted_stand_apart(self):
        for unused in (True, False):
            fabricated_files.write_run(self.run_path, contact=(), unused=unused)
            self.assertEqual(report(self.run_path, "--out-dir", self.out)[0], 0)
            page = self.check_page(self.out / "index.html")
            self.check_notebook(self.out / "index.ipynb")
            heading = page.find("Measured but not used in this fit")
            self.assertEqual(heading > page.index("Measured against simulated</h2>"), unused)
            table = page[page.index("Error of the simulation"):]
            table = table[:table.index("</table>")]
            self.assertIn("vertical force", table)
            self.assertNotIn("sideways force", table)

    def test_without_a_title_the_data_file_gives_the_name(self):
        fabricated_files.write_run(self.run_path, title="")
        self.assertEqual(run_file.read(str(self.run_path)).title, "contact: stances")

    def test_reason_shared_by_neighbours_is_told_once_and_no_remedy_is_no_help(self):
        fabricated_files.write_run(self.run_path, contact=())
        (rows,) = self.answers(["run_parameters"], "parameter_rows(shown)")
        self.assertEqual(rows.count("no measured channel depends on it"), 1)
        self.assertIn("<b>Would help static_friction, dynamic_friction:</b> measuring right_force_x", rows)
        self.assertIn("<b>viscous_friction:</b> nothing that", rows)

    def test_nuisance_parameters_are_counted_by_what_they_mean(self):
        fabricated_files.write_run(self.run_path)
        with h5py.File(self.run_path, "a") as file:
            for row in (5, 6):
                file["parameters/kind"][row] = "nuisance"
                file["parameters/free"][row] = 1
                file["parameters/meaning"][row] = "weight of a curve"
        (notes,) = self.answers(["run_parameters"], "notes")
        self.assertIn("Nuisance parameters, fitted as well (in /parameters): 2 × weight of a curve.", notes)

    def test_correlations_need_two_determined_parameters(self):
        fabricated_files.write_run(self.run_path)
        self.assertIn("correlation", run_file.read(str(self.run_path)).has)
        with h5py.File(self.run_path, "a") as file:
            file["uncertainty/verdict"][1] = "at_bound"
        self.assertNotIn("correlation", run_file.read(str(self.run_path)).has)

    def test_regions_of_a_foot_share_a_picture_unless_their_outlines_overlap(self):
        fabricated_files.write_run(self.run_path, contact=("heel", "toe"))
        with h5py.File(self.run_path, "a") as file:
            for region in ("heel", "toe"):
                file[f"details/contact/stance_1/{region}"].attrs["body"] = "foot"
        overlapping = self.answers(["run_prediction", "run_contact"], "sorted(pictures)")
        with h5py.File(self.run_path, "a") as file:
            outline = file["details/contact/stance_1/toe/outline"]
            outline[:, :, 0] = outline[:, :, 0] + 0.2
        apart = self.answers(["run_prediction", "run_contact"], "list(pictures)")
        self.assertEqual((overlapping, apart), (["['heel', 'toe']"], ["['foot']"]))

    def test_force_on_faces_that_are_not_drawn_is_told(self):
        for share, told in ((1.0, False), (2.5, True)):
            fabricated_files.write_run(self.run_path)
            with h5py.File(self.run_path, "a") as file:
                simulated = file["prediction/stance_1/right_force_y/simulated"]
                simulated[:] = share * simulated[:]
            self.assertEqual(report(self.run_path, "--out-dir", self.out)[0], 0)
            page = self.check_page(self.out / "index.html")
            self.assertEqual('<li>The faces drawn, those that look down, carry' in page, told)


class SeveralFiles(WithFolder):
    def test_each_has_its_page_and_the_overview_compares_them(self):
        second = self.folder / "second" / "run.h5"
        second.parent.mkdir()
        fabricated_files.write_run(self.run_path, contact=())
        fabricated_files.write_run(second, contact=(), stiffness=5e5, starts=12, findings=["Another sentence."])
        study = self.folder / "my study.h5"
        fabricated_files.write_study(study)
        status, _, complaint = report(self.run_path, second, study, "--out-dir", self.out)
        self.assertEqual((status, complaint), (0, ""))
        names = ["index", f"{self.folder.name}_run", "my study", "second_run"]
        self.assertEqual(sorted(os.listdir(self.out)),
                         sorted(f"{name}.{kind}" for name in names for kind in ("html", "ipynb")))
        pages = {name: self.check_page(self.out / f"{name}.html") for name in names}
        for name in names:
            self.check_notebook(self.out / f"{name}.ipynb")
        self.assertIn("Another sentence.", pages["index"])
        self.assertIn('href="my%20study.html"', pages["index"])
        self.assertIn('href="second_run.html"', pages["index"])
        self.assertIn('href="index.html"', pages["second_run"])
        self.assertIn("ceres reached the target in 10 of 10 runs", pages["my study"])
        self.assertIn("nlopt:LN_COBYLA never reached the target in 10 runs", pages["my study"])


class BadInput(WithFolder):
    def check_refused(self, expected, *arguments):
        status, said, complaint = report(*arguments, "--out-dir", self.out)
        self.assertEqual((status, said), (2, ""), complaint)
        self.assertRegex(complaint, r"^sinew: error: [^\n]+\n$")
        self.assertIn(expected, complaint)
        self.assertFalse(self.out.parent.exists())

    def test_files_that_are_no_run_files(self):
        self.check_refused("no such file", self.folder / "missing.h5")
        self.check_refused("is a folder", self.folder)
        text = self.folder / "text.h5"
        text.write_text("time force\n0 1\n")
        self.check_refused("cannot be read as HDF5", text)
        with h5py.File(self.folder / "data.h5", "w") as file:
            file.attrs["sinew_schema"] = "dataset/1"
        self.check_refused("it is a dataset/1 file", self.folder / "data.h5")
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["numbers"] = [1.0]
        self.check_refused("neither /run nor /study", self.folder / "other.h5")

    def test_one_bad_file_among_good_ones(self):
        fabricated_files.write_run(self.run_path)
        self.check_refused("no such file", self.run_path, self.folder / "missing.h5")
        self.check_refused("is given twice", self.run_path, self.folder / "." / "run.h5")

    def test_run_files_with_a_part_missing_or_misshapen(self):
        def drop_title(file):
            del file["run"].attrs["title"]

        def drop_values(file):
            del file["parameters/value"]

        def shorten(file):
            del file["prediction/stance_1/right_force_y/measured"]
            file["prediction/stance_1/right_force_y/measured"] = np.zeros(3)

        def misname(file):
            file["uncertainty/verdict"][0] = "probably"

        def new_schema(file):
            file["run"].attrs["sinew_schema"] = "run/9"

        def drop_quantity(file):
            del file["prediction/stance_1/right_force_y"].attrs["quantity"]

        for damage, expected in ((drop_title, "no attribute 'title'"), (drop_values, "/parameters/value is missing"),
                                 (drop_quantity, "no attribute 'quantity'"),
                                 (shorten, "right_force_y/measured has 3 entries"), (misname, "'probably'"),
                                 (new_schema, "schema 'run/9', expected 'run/1'")):
            with self.subTest(expected):
                fabricated_files.write_run(self.run_path)
                with h5py.File(self.run_path, "a") as file:
                    damage(file)
                self.check_refused(expected, self.run_path)

    def test_usage(self):
        self.check_refused("FILE.h5")
        self.check_refused("--colour", self.run_path, "--colour")
        status, _, complaint = report(self.run_path)
        self.assertEqual(status, 2)
        self.assertRegex(complaint, r"^sinew: error: [^\n]*--out-dir[^\n]*\n$")

    def test_out_dir_that_is_a_file(self):
        fabricated_files.write_run(self.run_path)
        occupied = self.folder / "occupied"
        occupied.write_text("mine")
        status, _, complaint = report(self.run_path, "--out-dir", occupied)
        self.assertEqual(status, 2)
        self.assertRegex(complaint, r"^sinew: error: [^\n]*occupied[^\n]*\n$")
        self.assertEqual(occupied.read_text(), "mine")

    def test_damaged_bytes_never_escape_as_another_error(self):
        fabricated_files.write_run(self.run_path)
        whole = self.run_path.read_bytes()
        damaged = self.folder / "damaged.h5"
        chance = random.Random(5)
        for trial in range(60):
            data = bytearray(whole[:chance.randrange(len(whole))] if trial % 3 == 0 else whole)
            for _ in range(chance.randrange(1, 40)):
                if data:
                    data[chance.randrange(len(data))] = chance.randrange(256)
            damaged.write_bytes(data)
            try:
                run_file.read(str(damaged))
            except run_file.BadInput as error:
                self.assertRegex(str(error), r"^[^\n]*damaged\.h5: [^\n]+$")


if __name__ == "__main__":
    unittest.main()

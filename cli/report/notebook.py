"""Builds notebooks from the cells in cells/ and executes them.

A cell file is Python in percent format: `# %% name` begins a code cell, `# %% name [markdown]` a text cell (its lines
are comments), `# %% include look` stands for the cells of look.py.
"""
import json
import os
import re
import sys
import tempfile

import nbformat
from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError

import font_list

CELLS = os.path.join(os.path.dirname(os.path.realpath(__file__)), "cells")
CELL_SECONDS = 300     # a cell that takes longer has gone wrong: the whole notebook takes seconds
STARTUP_SECONDS = 120  # a cold, busy machine


class NotebookFailed(Exception):
    """A notebook could not be executed; the message is one line for a person."""


def _markdown_escape(text):
    """As character references, which every Markdown reader takes for plain text."""
    return re.sub(r"[\\`*_{}\[\]<>#|$&~]", lambda match: f"&#{ord(match[0])};", " ".join(text.split()))


def _cells(name):
    """The cells of a file as (kind, cell name, source)."""
    with open(os.path.join(CELLS, f"{name}.py"), encoding="utf-8") as file:
        parts = re.split(r"^# %% (.*)\n", file.read(), flags=re.M)
    for head, body in zip(parts[1::2], parts[2::2]):
        if head.startswith("include "):
            yield from _cells(head[len("include "):])
        elif head.endswith(" [markdown]"):
            yield "markdown", head[:-len(" [markdown]")], re.sub(r"^# ?", "", body.strip(), flags=re.M)
        else:
            yield "code", head, body.strip()


def build(cell_files, title, substitutions):
    """A notebook out of cell files.

    substitutions: {placeholder: Python value}, written into the code as a literal. The title is escaped for Markdown.
    """
    notebook = nbformat.v4.new_notebook()
    notebook.metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"},
                         "language_info": {"name": "python"}, "title": title}
    for file in cell_files:
        for kind, name, source in _cells(file):
            for placeholder, value in substitutions.items():
                literal = json.dumps(value, ensure_ascii=False, indent=4 if isinstance(value, dict) else None)
                source = re.sub(r'"?\{\{%s\}\}"?' % placeholder, lambda _: literal, source)
            if kind == "markdown":
                cell = nbformat.v4.new_markdown_cell(source.replace("{{TITLE}}", _markdown_escape(title)))
            else:
                cell = nbformat.v4.new_code_cell(source)
            cell.id = f"cell-{len(notebook.cells) + 1}"  # the same run gives the same notebook
            cell.metadata["name"] = name
            notebook.cells.append(cell)
    return notebook


class _ThisPython(KernelSpecManager):
    """The kernel is the Python that runs the report, whatever kernels or PATH the user has."""

    def get_kernel_spec(self, kernel_name):
        # Isolated from PYTHONPATH and user packages; the debugger would complain about frozen modules.
        command = [sys.executable, "-I", "-Xfrozen_modules=off", "-m", "ipykernel_launcher",
                   "-f", "{connection_file}"]
        return KernelSpec(argv=command, display_name="Python 3", language="python")


def _transport(scratch):
    """How we talk to the kernel: by sockets in the folder of this one, because two kernels that start at the same time may choose the
    same TCP port, and then one of them dies."""
    sockets = os.path.join(scratch, "kernel")
    longest = 107 - len("-10")  # bytes of a Unix socket's name
    return {"transport": "ipc", "ip": sockets} if len(os.fsencode(sockets)) <= longest else {}


async def execute(notebook, folder):
    """Runs all cells with `folder` as the working folder; outputs land in the notebook. Raises NotebookFailed."""
    with tempfile.TemporaryDirectory(prefix="sinew_report_", ignore_cleanup_errors=True) as scratch:
        # Neither start-up files nor the backend of the user may change what the cells do.
        environment = {key: value for key, value in os.environ.items() if key not in ("MPLBACKEND", "MATPLOTLIBRC")}
        environment["IPYTHONDIR"] = scratch
        fonts = os.path.join(scratch, "matplotlib")
        environment.update(font_list.lend(fonts))
        manager = AsyncKernelManager(kernel_name="python3", kernel_spec_manager=_ThisPython(),
                                     connection_file=os.path.join(scratch, "kernel.json"), **_transport(scratch))
        # Outputs that come late, on a machine that stands still for seconds, are waited for: by default they are left out.
        client = NotebookClient(notebook, km=manager, timeout=CELL_SECONDS, startup_timeout=STARTUP_SECONDS,
                                iopub_timeout=CELL_SECONDS, raise_on_iopub_timeout=True,
                                record_timing=False, resources={"metadata": {"path": folder}})
        try:
            await client.async_execute(env=environment)
            font_list.keep(fonts)
        except CellExecutionError as error:
            raise NotebookFailed(f"{error.ename}: {' '.join(error.evalue.split())}") from error
        except CellTimeoutError as error:
            raise NotebookFailed(f"a cell took longer than {CELL_SECONDS} s") from error
        except (DeadKernelError, RuntimeError, OSError) as error:
            raise NotebookFailed(f"the Python kernel died: {' '.join(str(error).split())}") from error
        finally:  # the client leaves a manager that it was given running
            if client.kc is not None:
                client.kc.stop_channels()
            if manager.has_kernel:
                await manager.shutdown_kernel(now=True)
    for cell in notebook.cells:
        if cell.cell_type == "code" and cell.metadata["name"] == "setup":
            cell.outputs = []  # messages of matplotlib about its cache are no findings

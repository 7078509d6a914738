"""Executed notebooks of a report that was stopped before its end: the next report of these files in this folder takes them.

They lie in a hidden folder until the report is complete. Each is named by a digest of all that it follows from, so that a
notebook of another file, of changed cells or of other libraries is never taken.
"""
import contextlib
import hashlib
import importlib.metadata
import os
import shutil
import sys

import h5py
import nbformat

import interrupt
import replace

FOLDER = ".sinew-report"
LIBRARIES = ("numpy", "matplotlib", "nbformat", "nbclient", "ipykernel", "ipython")


def _version(library):
    try:
        return importlib.metadata.version(library)
    except importlib.metadata.PackageNotFoundError:  # a package may leave that out
        return ""


def _digest(notebook, files):
    """Of a notebook before it is executed, the files that it reads, and the libraries that it uses."""
    digest = hashlib.sha256(nbformat.writes(notebook).encode())
    digest.update(repr([sys.version, h5py.version.info, *map(_version, LIBRARIES)]).encode())
    for path in files:
        with open(path, "rb") as file:
            while chunk := file.read(1 << 20):
                digest.update(chunk)
    return digest.hexdigest()


def _sources(notebook):
    return [(cell.cell_type, cell.source) for cell in notebook.cells]


class KeptPages:
    def __init__(self, folder):
        self.folder = os.path.join(folder, FOLDER)
        self.digests = {}

    def take(self, notebooks, files):
        """Replaces notebooks {name: notebook} by their executed selves where these are there; returns the names of the others.

        files: {name: paths that the notebook reads}. Raises OSError: one of these cannot be read.
        """
        rest = []
        for name, notebook in notebooks.items():
            self.digests[name] = _digest(notebook, files[name])
            executed = self._read(name)
            if executed is None or _sources(executed) != _sources(notebook):
                rest.append(name)
            else:
                notebooks[name] = executed
        return rest

    def _read(self, name):
        """None: there is none, or something else than a notebook."""
        try:
            executed = nbformat.read(self._path(name), as_version=4)
            nbformat.validate(executed)
            return executed
        except (OSError, ValueError, KeyError, TypeError, AttributeError, nbformat.ValidationError):
            return None

    def keep(self, name, notebook):
        """What cannot be kept is executed once more: no reason to end."""
        if interrupt.orphaned():
            return
        with contextlib.suppress(OSError):
            os.makedirs(self.folder, exist_ok=True)
            replace.replace_all(self.folder, {os.path.basename(self._path(name)): nbformat.writes(notebook)})

    def number(self):
        """Of the notebooks of this report that are kept."""
        return sum(os.path.exists(self._path(name)) for name in self.digests)

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def _path(self, name):
        return os.path.join(self.folder, f"{self.digests[name]}.ipynb")

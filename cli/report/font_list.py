"""Matplotlib's list of the machine's fonts, for a kernel in a folder of its own.

Making the list takes seconds, so Matplotlib keeps it in a folder of the user's, with a lock beside it while it is written. A kernel that is
killed just then would leave the lock, and after that nothing could be drawn on this machine.
"""
import contextlib
import glob
import os
import shutil

import replace

LISTS = "fontlist-*.json"  # one for each version of the list


def _of_the_user():
    """Where Matplotlib keeps its lists (matplotlib.get_cachedir, without the import)."""
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.environ.get("MPLCONFIGDIR") or os.path.join(caches, "matplotlib")


def lend(folder):
    """Makes the folder, with the user's lists in it if there are any, and returns what a kernel's environment needs to take it."""
    os.mkdir(folder)
    for path in glob.glob(LISTS, root_dir=_of_the_user()):
        with contextlib.suppress(OSError):
            shutil.copyfile(os.path.join(_of_the_user(), path), os.path.join(folder, path))
    return {"MPLCONFIGDIR": folder}


def keep(folder):
    """Gives the user the lists that the kernel has made, so that the next one need not."""
    for name in glob.glob(LISTS, root_dir=folder):
        home = _of_the_user()
        if os.path.exists(os.path.join(home, name)):
            continue
        with contextlib.suppress(OSError):  # without it the next report takes seconds longer
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                text = file.read()
            os.makedirs(home, exist_ok=True)
            replace.replace_all(home, {name: text})

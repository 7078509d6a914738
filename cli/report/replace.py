"""Files that are replaced whole, as base/replace_file.h does it: temporary names, locks and all.

A temporary file is called `.sinew-MACHINE-PROCESS-RANDOM.tmp` and locked (flock) while its process lives; the next
command of the program that writes in the folder removes those that nobody holds.
"""
import errno
import fcntl
import os
import secrets
import socket

NO_DISK = (errno.EINVAL, errno.ENOTSUP)  # fsync: this file system has nothing to bring to a disk


def _machine():
    number = 14695981039346656037  # FNV-1a
    for byte in socket.gethostname().encode():
        number = (number ^ byte) * 1099511628211 % 2**64
    return f"{number % 2**32:08x}"


def _synchronise(file):
    try:
        os.fsync(file)
    except OSError as error:
        if error.errno not in NO_DISK:
            raise


class _Temporary:
    """A file under a temporary name, complete and on the disk."""

    def __init__(self, folder, text):
        self.path = os.path.join(folder, f".sinew-{_machine()}-{os.getpid()}-{secrets.token_hex(4)}.tmp")
        self.file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        try:
            try:
                fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                pass  # no locks here: then nobody removes it either
            rest = memoryview(text.encode())
            while rest:
                rest = rest[os.write(self.file, rest):]
            _synchronise(self.file)
        except BaseException:
            self.remove()
            raise

    def become(self, target):
        os.replace(self.path, target)
        os.close(self.file)
        self.file = None

    def remove(self):
        if self.file is None:
            return
        try:
            os.remove(self.path)
        except OSError:
            pass
        os.close(self.file)
        self.file = None


def check(path):
    """Raises OSError where something other than a regular file would be replaced."""
    target = os.path.realpath(path)
    if os.path.lexists(target) and not os.path.isfile(target):
        raise OSError(errno.EISDIR if os.path.isdir(target) else errno.EINVAL,
                      f"'{os.path.basename(path)}' there is no regular file")


def replace_all(folder, texts):
    """Writes {name: text} into the folder. All are on the disk before the first one takes its name.

    Raises OSError: until the first has its name, the old files are all as they were.
    """
    targets = {name: os.path.realpath(os.path.join(folder, name)) for name in texts}
    for target in targets.values():
        check(target)
    made = {}
    try:
        for name, text in texts.items():
            made[name] = _Temporary(os.path.dirname(targets[name]), text)
        for name, temporary in made.items():
            temporary.become(targets[name])
    finally:
        for temporary in made.values():
            temporary.remove()
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        _synchronise(descriptor)
    finally:
        os.close(descriptor)

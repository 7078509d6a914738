"""Ctrl-C, asked about where the report can stop in order.

An exception out of nowhere would tear imports, temporary files and kernels apart at any line, so the signal is held
from the first line of the program to its last.
"""
import signal


class Interrupted(Exception):
    """Ctrl-C was pressed."""


def hold():
    """Ctrl-C waits until it is asked about; so it does in every thread and process begun later."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def pressed():
    return signal.SIGINT in signal.sigpending()


def stop_if_pressed():
    if pressed():
        raise Interrupted

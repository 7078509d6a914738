"""Ctrl-C and SIGTERM, asked about where the report can stop in order.

An exception out of nowhere would tear imports, temporary files and kernels apart at any line, so the signals are held
from the first line of the program to its last.
"""
import os
import signal

STOPS = (signal.SIGINT, signal.SIGTERM)


class Interrupted(Exception):
    """The report was told to stop; its argument is the signal."""


def hold():
    """The signals wait until they are asked about; so they do in every thread and process begun later."""
    signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)


def pressed():
    """The signal that waits, or None."""
    return next((stop for stop in STOPS if stop in signal.sigpending()), None)


def orphaned():
    """The program that asked for the report was killed; the same one may be at work again already."""
    parent = os.environ.get("SINEW_REPORT_PARENT")
    return parent is not None and parent != str(os.getppid())


def stop_if_pressed():
    if pressed():
        raise Interrupted(pressed())

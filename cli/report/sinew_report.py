"""sinew report: executed notebooks and HTML pages of run, diagnosis and study files.

    sinew_report.py FILE.h5... --out-dir DIR [--threads N]

Exit status: 0 done; 1 the report could not be made (the message says why); 2 bad input or usage, one line on stderr;
130 or 143 stopped by SIGINT or SIGTERM.
Nothing is written unless everything could be made. Of several files, what a stopped report had executed is kept for the next one.
"""
import argparse
import os
import sys

sys.dont_write_bytecode = True  # the folder may be installed read-only, or be a source tree
sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))

import interrupt

interrupt.hold()

DONE, FAILED, BAD_INPUT, STOPPED = 0, 1, 2, 128


class OneLineParser(argparse.ArgumentParser):
    """Bad usage is one line on stderr, as everywhere in sinew."""

    def error(self, message):
        print(f"sinew: error: {message}", file=sys.stderr)
        sys.exit(BAD_INPUT)


def printable(message):
    """One line without control characters: names come from files of others, and a terminal obeys them."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in str(message))


def parse(arguments):
    parser = OneLineParser(prog="sinew report", description="Draws run, diagnosis and study files: executed notebooks and HTML.")
    parser.add_argument("files", nargs="+", metavar="FILE.h5", help="what sinew identify, diagnose or compare wrote")
    parser.add_argument("--out-dir", required=True, metavar="DIR", help="the folder for notebooks and pages")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1, metavar="N", help="notebooks executed at once")
    options = parser.parse_args(arguments)
    if options.threads < 1:
        parser.error(f"--threads {options.threads}: expected at least 1")
    return options


def refuse(error):
    print(f"sinew: error: {printable(error)}", file=sys.stderr)
    return BAD_INPUT


def make(options):
    try:
        import run_file
        try:
            files = run_file.read_all(options.files)
        except run_file.BadInput as error:
            return refuse(error)
        import publish  # only now: what it needs takes half a second to load
    except ImportError as error:
        print(f"sinew: the report could not be made: Python package missing: {error.name} "
              "(the list is in packages.txt)", file=sys.stderr)
        return FAILED
    try:
        entry = publish.publish(files, options.out_dir, options.threads)
    except run_file.BadInput as error:
        return refuse(error)
    except publish.ReportFailed as error:
        print(f"sinew: the report could not be made: {printable(error)}", file=sys.stderr)
        return FAILED
    except interrupt.Interrupted as error:
        stop, kept = error.args
        done = "the notebook that is done" if kept == 1 else f"the {kept} notebooks that are done"
        again = f"the same command goes on with {done}" if kept else "begin it again"
        print(f"sinew: stopped by {stop.name}; nothing was written: {again}", file=sys.stderr)
        return STOPPED + error.args[0]
    print(f"Report: {entry}")
    return DONE


if __name__ == "__main__":
    if not sys.flags.isolated:  # again, without PYTHONPATH and packages of the user
        os.execv(sys.executable, [sys.executable, "-I", os.path.realpath(__file__), *sys.argv[1:]])
    sys.exit(make(parse(sys.argv[1:])))

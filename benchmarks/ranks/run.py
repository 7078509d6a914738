#!/usr/bin/python3
"""How much faster are two threads and two processes than one, and do they find the same?

usage: run.py --sinew build/release/sinew [--repeats 3] [--subjects 40] [--ranks 1,2,4] [--data DIR] [--only
    identify,starts,diagnose,large,tosses,cohort,servo,servo_sts3250,cube]

`servo`, `servo_sts3250` and `cube` read measured data (--data): pendulums on an XL330 and an STS3250, every sixth toss of the cube.

Wall-clock seconds on an otherwise quiet machine, the median of the repeats, started in turn. Results are compared to the last bit,
other than times. README.md has the figures.
"""
import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "cli"), str(ROOT / "benchmarks" / "data_check")]
import real_sets  # pylint: disable=wrong-import-position

LAUNCH = ("mpirun", "--allow-run-as-root", "--oversubscribe", "-n")


def cases(subjects):
    """Name: words that make the data or a function that does, words that are timed (without --threads and --out), pipeline."""
    cohort = ", ".join(f"s{n:02}: {{seed: {n}}}" for n in range(1, subjects + 1))
    return {
        "identify": ([["data", "synthesize", "nms", "--seed", "2", "--out", "nms.h5"]],
                     ["identify", "nms", "--data", "nms.h5", "--solver", "multistart"], None),
        "starts": ([["data", "synthesize", "nms", "--seed", "2", "--out", "nms.h5"]],
                   ["identify", "nms", "--data", "nms.h5", "--solver", "multistart", "--starts", "200", "--max-evaluations", "1000000"], None),
        "diagnose": ([["data", "synthesize", "drive", "--seed", "7", "--effect",
                       "asymmetric_friction:forward_friction=0.16,backward_friction=0.08", "--out", "drive.h5"]],
                     ["diagnose", "drive", "--data", "drive.h5"], None),
        "large": ([["data", "synthesize", "drive", "--seed", "8", "--set", "train=4", "--set", "validate=1", "--set", "duration=4", "--set",
                    "rate=100", "--set", "position_noise=0.0001", "--effect", "coulomb_friction:value=0.2", "--effect",
                    "position.time_offset:value=0.02", "--out", "misfit.h5"]],
                  ["diagnose", "drive", "--data", "misfit.h5"], None),
        "tosses": ([["data", "synthesize", "free_body", "--seed", "3", "--effect", "lengths:value=0.003", "--out", "tosses.h5"]],
                   ["diagnose", "free_body", "--data", "tosses.h5"], None),
        "servo": (lambda program, data, folder: real_sets.servo_xl330(program, data, folder / "servo.h5"),
                  ["diagnose", "drive", "--data", "servo.h5"], None),
        "servo_sts3250": (lambda program, data, folder: real_sets.servo_sts3250(program, data, folder / "servo.h5"),
                          ["diagnose", "drive", "--data", "servo.h5"], None),
        "cube": (lambda program, data, folder: real_sets.cube_tosses(program, data, folder / "cube.h5", 6),
                 ["diagnose", "free_body", "--data", "cube.h5"], None),
        "cohort": ([], ["run", "cohort.yaml"], f"""subjects: {{{cohort}}}
out: results
steps:
  data: data synthesize contact --seed {{seed}} --set encoders=1 --out {{out}}/data.h5
  fit: identify contact --data {{data}} --out {{out}}/run.h5
  why: diagnose contact --data {{data}} --out {{out}}/why.h5
"""),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path, required=True)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--subjects", type=int, default=40)
    parser.add_argument("--only", default="identify,diagnose,large,tosses,cohort")
    parser.add_argument("--data", type=Path, default=real_sets.DATA, help="measured data")
    parser.add_argument("--ranks", default="1,2", help="numbers of processes, with one thread each")
    words = parser.parse_args()
    program = words.sinew.resolve()
    import os
    os.environ.setdefault("SINEW_PROGRAM", str(program))
    from program import differences  # pylint: disable=import-outside-toplevel
    every = cases(words.subjects)
    for name in words.only.split(","):
        data, timed, pipeline = every[name]
        with tempfile.TemporaryDirectory(prefix="ranks_") as folder:
            folder = Path(folder)
            if callable(data):
                data(program, words.data, folder)
            else:
                for one in data:
                    subprocess.run([program, *one], cwd=folder, check=True, capture_output=True)
            ways = {"1 thread": ([], 1), "2 threads": ([], 2)}
            ways.update({f"{n} ranks": ([*LAUNCH, n], 1) for n in words.ranks.split(",") if n != "1"})
            seconds = {way: [] for way in ways}
            different = []
            for repeat in range(words.repeats):
                for way, (launch, threads) in ways.items():
                    if pipeline:
                        (folder / "cohort.yaml").write_text(pipeline.replace("results", f"{way.replace(' ', '_')}_{repeat}"))
                    out = [] if pipeline else ["--out", f"{way.replace(' ', '_')}.h5"]
                    began = time.monotonic()
                    done = subprocess.run([*launch, program, *timed, *out, "--threads", str(threads), "--quiet"], cwd=folder,
                                          capture_output=True, text=True, check=False)
                    seconds[way].append(time.monotonic() - began)
                    if done.returncode:
                        sys.exit(f"{name}, {way}: {done.stderr}")
                    first = folder / "1_thread.h5"
                    if not pipeline and way != "1 thread":
                        with h5py.File(first) as a, h5py.File(folder / out[1]) as b:
                            different += differences(a, b)
            alone = statistics.median(seconds["1 thread"])
            row = {way: [round(statistics.median(s), 2), round(alone / statistics.median(s), 2)] for way, s in seconds.items()}
            print(name, json.dumps(row), "same results" if not different else f"DIFFERENT: {different[:5]}", flush=True)


if __name__ == "__main__":
    main()

"""Runs fuzzers one after the other, and prints a table of what they did.

    cmake --preset fuzz && cmake --build --preset fuzz
    /usr/bin/python3 tests/fuzz/run.py                          every target for ten minutes or a million inputs
    /usr/bin/python3 tests/fuzz/run.py --seconds 5 osim trc     two of them, five seconds each

What crashed, hung or took too much memory is kept in BUILD/found/TARGET, the corpora that grew in BUILD/corpus/TARGET. Status 1 if
there is any that a library of others is not to blame for.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LARGE = {"hdf5_file", "mat_file", "dataset_file", "run_file", "study_file"}  # go through libhdf5 or libmatio
# What these libraries crash on ends a process of its own in the program (base/forked_trial.h); here there is none, so that their crashes
# would end the fuzzing.
OF_LIBRARIES = {"hdf5_file", "mat_file"}
LIBRARIES = re.compile(r"lib(hdf5|matio|z)[_.\-a-z0-9]*\.so")
LONGEST = 65536  # [bytes] of an input
ENVIRONMENT = {
    "ASAN_OPTIONS": "allocator_may_return_null=1:detect_stack_use_after_return=0",
    "LSAN_OPTIONS": f"suppressions={ROOT / 'cmake' / 'lsan.supp'}:print_suppressions=0",
    "UBSAN_OPTIONS": "print_stacktrace=1",
}


def targets():
    text = (HERE / "all_targets.cpp").read_text()
    return re.findall(r'^ +\{"([a-z0-9_]+)", ', text, re.MULTILINE)


def dictionary(target):
    name = {"run_file": "tree", "study_file": "tree", "dataset_file": "tree"}.get(target)
    if name is None:
        xml = target.startswith(("ceinms", "osim", "ik_", "external"))
        yaml = target.endswith("settings") or target in ("import_map", "csv_import", "pipeline")
        name = "xml" if xml else "yaml" if yaml else "numbers"
    return HERE / "dictionaries" / f"{name}.dict"


def blame(program, artifact, environment):
    """Whose code an input crashed: "library", or a line that says what and where."""
    done = subprocess.run([program, "-timeout=20", "-rss_limit_mb=2000", artifact], capture_output=True, text=True, errors="replace", env=environment,
                          check=False)
    said = done.stderr
    if done.returncode == 0:
        return "not again"
    error = re.search(r"(runtime error: .*|ERROR: .*|fuzz: .*|sinew: bug: .*)", said)
    for line in said.splitlines():
        if not re.match(r"\s*#\d+ ", line):
            continue
        if LIBRARIES.search(line):
            return "library"
        if "sinew::" in line:
            return f"{error.group(1) if error else 'crash'} at {line.split(' in ', 1)[-1]}"
    return error.group(1) if error else "crash"


def fuzz(target, options):
    program = options.build / "tests" / "fuzz" / f"fuzz_{target}"
    corpus, found = options.build / "corpus" / target, options.build / "found" / target
    for folder in (corpus, found):
        folder.mkdir(parents=True, exist_ok=True)
    executions = options.executions or (100_000 if target in LARGE else 1_000_000)
    words = [program, f"-runs={executions}", f"-max_total_time={options.seconds}", f"-max_len={LONGEST}", "-timeout=10", "-rss_limit_mb=2000",
             "-malloc_limit_mb=1000", "-print_final_stats=1", f"-artifact_prefix={found}/", f"-dict={dictionary(target)}", f"-seed={options.seed}"]
    forked = target in OF_LIBRARIES
    if forked:
        words += ["-fork=1", "-ignore_crashes=1", "-ignore_timeouts=1", "-ignore_ooms=1"]
    seeds = [corpus, HERE / "corpus" / target, *options.more]
    crashes = HERE / "crashes" / target
    environment = {**os.environ, **ENVIRONMENT, "TMPDIR": options.scratch}
    before = set(found.iterdir())
    began = time.monotonic()
    done = subprocess.run([*map(str, words), *map(str, seeds), *([str(crashes)] if crashes.is_dir() else [])], capture_output=True, text=True,
                          errors="replace", env=environment, cwd=found, check=False)
    seconds = time.monotonic() - began
    (options.build / "found" / f"{target}.log").write_text(done.stderr)
    lines = re.findall(r"#(\d+):?\s.*?cov: (\d+) ft: (\d+)", done.stderr)
    executed = re.search(r"stat::number_of_executed_units:\s*(\d+)", done.stderr)
    peak = re.search(r"stat::peak_rss_mb:\s*(\d+)", done.stderr)
    artifacts = sorted(path for path in set(found.iterdir()) - before if path.name.startswith(("crash-", "oom-", "timeout-", "leak-")))
    reasons = [(path.name, blame(program, path, environment)) for path in artifacts]
    if not forked:  # a library that crashes on a whole file is our matter
        reasons = [(name, f"{reason}, on a whole file" if reason == "library" else reason) for name, reason in reasons]
    return {"target": target, "executions": int(executed.group(1)) if executed else int(lines[-1][0]) if lines else 0, "seconds": round(seconds, 1),
            "edges": int(lines[-1][1]) if lines else 0, "features": int(lines[-1][2]) if lines else 0, "peak_MB": int(peak.group(1)) if peak else 0,
            "in_libraries": sum(reason == "library" for _, reason in reasons),
            "found": [f"{name}: {reason}" for name, reason in reasons if reason not in ("library", "not again")],
            "failed": done.returncode != 0 and not forked and not artifacts}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", default=[])
    parser.add_argument("--build", type=Path, default=ROOT / "build" / "fuzz")
    parser.add_argument("--seconds", type=int, default=600)
    parser.add_argument("--executions", type=int, default=0, help="default: a million, of targets with HDF5 or MAT files 100,000")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--more", type=Path, nargs="*", default=[], help="folders with further seeds")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    options.build = options.build.resolve()
    known = targets()
    for target in options.targets:
        if target not in known:
            sys.exit(f"unknown target {target}, expected one of {', '.join(known)}")
    # In memory where there is room; a process that crashes leaves its files there.
    scratch = tempfile.TemporaryDirectory(prefix="sinew-fuzz-", dir="/dev/shm" if os.access("/dev/shm", os.W_OK) else None)
    options.scratch = scratch.name
    print(f"{'target':22}{'executions':>11}{'s':>7}{'edges':>7}{'features':>9}{'peak MB':>8}  crashes (in libraries)")
    results = []
    for target in options.targets or known:
        result = fuzz(target, options)
        results.append(result)
        print(f"{target:22}{result['executions']:11}{result['seconds']:7.0f}{result['edges']:7}{result['features']:9}{result['peak_MB']:8}  "
              f"{len(result['found'])} ({result['in_libraries']}){' FAILED' if result['failed'] else ''}", flush=True)
        for line in result["found"]:
            print(f"  {line}", flush=True)
        if options.json:
            options.json.write_text(json.dumps(results, indent=1))
    return 1 if any(result["found"] or result["failed"] for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())

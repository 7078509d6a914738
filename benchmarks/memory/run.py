"""What the program takes of the machine's memory: commands on a data set of a gigabyte, and long searches.

    /usr/bin/python3 benchmarks/memory/run.py [--program build/release/sinew] [--folder /tmp/memory] [--size 1.0] [data] [search] [starts]

Of data: 32 channels of noise, which nothing compresses, in 4 trials. Of searches: annealing on a synthetic stance, an evaluation of which takes 5 us,
with 100,000, a million and three million evaluations, and 10,000 starts. Needs up to three times the size on the disk and some minutes of processor time.
"""
import argparse
import os
import resource
import shutil
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np


def parsed():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="build/release/sinew")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/sinew_memory"))
    parser.add_argument("--size", type=float, default=1.0, help="of the data set, in GB")
    parser.add_argument("parts", nargs="*", default=["data", "search", "starts"])
    return parser.parse_args()


def children(pid):
    found = [pid]
    try:
        for thread in os.listdir(f"/proc/{pid}/task"):
            for child in Path(f"/proc/{pid}/task/{thread}/children").read_text().split():
                found += children(int(child))
    except OSError:
        pass
    return found


def resident(pid):
    """Proportional set size [bytes]: what forked processes share counts once."""
    try:
        for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                return 1024 * int(line.split()[1])
    except OSError:
        pass
    return 0


def measured(program, *words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    began = time.monotonic()
    process = subprocess.Popen([program, *map(str, words)], stdout=subprocess.DEVNULL)
    peak = 0
    while process.poll() is None:
        peak = max(peak, sum(resident(pid) for pid in children(process.pid)))
        time.sleep(0.25)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    print(f"{' '.join(map(str, words[:2])):24} status {process.returncode}, at most {peak / 1e6:6.0f} MB, {seconds:7.1f} s of processor time, "
          f"{time.monotonic() - began:7.1f} s", flush=True)
    return peak


def recording(path, gigabytes, trials=4, channels=8):
    rng = np.random.default_rng(1)
    samples = int(gigabytes * 1e9 / 8 / trials / (channels + 1))
    with h5py.File(path, "w") as file:
        file.attrs.update(sinew_schema="dataset/1", title="long", synthetic=1)
        for trial in range(trials):
            group = file.create_group(f"trials/t{trial}")
            group.attrs.update(role="train", task="")
            group["sensors/time"] = np.arange(samples) * 1e-3
            for name in range(channels):
                channel = group.create_dataset(f"sensors/channels/c{name}", data=rng.standard_normal(samples))
                channel.attrs.update(unit="V", kind="measured")
                channel[1000:20000] = channel[1000]


def on_data(program, folder, size):
    long = folder / "long.h5"
    recording(long, size)
    print(f"a data set of {long.stat().st_size / 1e6:.0f} MB", flush=True)
    measured(program, "data", "info", long)
    measured(program, "data", "check", long)
    measured(program, "data", "check", long, "--mask", "auto", "--out", folder / "masked.h5")
    (folder / "masked.h5").unlink(missing_ok=True)
    measured(program, "data", "cut", long, "--trial", "t0", "--window", "100:1000", "--as", "part")
    measured(program, "data", "drop", long, "--trial", "part")
    long.unlink()


def of_searches(program, folder, cases):
    stances = folder / "stances.h5"
    measured(program, "data", "synthesize", "contact", "--set", "encoders=1", "--out", stances)
    for trial in ("train_2", "train_3", "validate_1", "validate_2"):
        measured(program, "data", "drop", stances, "--trial", trial)
    for name, words in cases:
        run = folder / f"{name}.h5"
        run.unlink(missing_ok=True)
        measured(program, "identify", "contact", "--data", stances, "--out", run, "--intervals", "linear", "--quiet", "--threads", 1, *words)
        with h5py.File(run) as file:
            attrs = file["run"].attrs
            print(f"    {' '.join(map(str, words))}: {attrs['evaluations']} evaluations, {attrs['stop_reason']}, {len(file['trace/cost'])} points, "
                  f"file of {run.stat().st_size / 1e6:.1f} MB", flush=True)


def main():
    how = parsed()
    shutil.rmtree(how.folder, ignore_errors=True)
    how.folder.mkdir(parents=True)
    if "data" in how.parts:
        on_data(how.program, how.folder, how.size)
    if "search" in how.parts:
        of_searches(how.program, how.folder, [(f"e{count}", ("--solver", "sa", "--max-evaluations", count)) for count in (100000, 1000000, 3000000)])
    if "starts" in how.parts:
        of_searches(how.program, how.folder, [(f"s{count}", ("--solver", "multistart", "--starts", count)) for count in (20, 10000)])


if __name__ == "__main__":
    main()

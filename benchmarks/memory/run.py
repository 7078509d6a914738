"""What the program takes of the machine's memory: commands on a data set of a gigabyte, and long searches.

    /usr/bin/python3 benchmarks/memory/run.py [--program build/release/sinew] [--folder /tmp/memory] [--size 1.0] [data] [search] [starts]

Of data: 32 channels of noise, which nothing compresses, in 4 trials; one channel; a plate and a servo at 1 kHz for hours. Of searches: annealing on a synthetic stance, an evaluation of which takes 5 us,
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


def noise(rng, time):
    values = rng.standard_normal(time.size)
    values[1000:20000] = values[1000]
    return values


def noise_of_channels(rng, time, count=8):
    return {f"c{k}": ("V", "measured", noise(rng, time)) for k in range(count)}


def plate(rng, time):
    """Forces of a plate that steps load for 0.6 s now and then."""
    load = np.zeros(time.size)
    at = 0
    while (at := at + int(rng.uniform(300, 3000))) + 600 < time.size:
        load[at:at + 600] = np.hanning(600)
        at += 600
    return {f"plate_force_{axis}": ("N", "measured", np.round(size * load / 0.5 + 3 * rng.standard_normal(time.size)) * 0.5)
            for axis, size in (("x", 100), ("y", 800), ("z", 30))}


def servo(rng, time):
    """An encoder's position with its speed and its input."""
    places = rng.standard_normal(time.size // 100 + 2)
    window = np.hanning(101)
    position = np.convolve(np.interp(time, np.arange(places.size) * 0.1, places), window / window.sum(), "same")
    speed = np.gradient(position, 1e-3)
    step = 2 * np.pi / 4096
    return {"position": ("rad", "measured", np.round(position / step) * step), "current": ("A", "input", np.round(np.gradient(speed, 1e-3), 2)),
            "speed": ("rad/s", "measured", speed + 0.01 * rng.standard_normal(time.size))}


# Of recordings: trials, channels of each, what they are.
KINDS = {
    "32 channels of noise": (4, 8, noise_of_channels),
    "one channel of noise": (1, 1, lambda rng, time: noise_of_channels(rng, time, 1)),
    "a plate": (2, 3, plate),
    "a servo": (4, 3, servo),
}


def recording(path, gigabytes, kind):
    rng = np.random.default_rng(1)
    trials, channels, make = KINDS[kind]
    time = np.arange(int(gigabytes * 1e9 / 8 / trials / (channels + 1))) * 1e-3
    with h5py.File(path, "w") as file:
        file.attrs.update(sinew_schema="dataset/1", title="long", synthetic=1)
        for trial in range(trials):
            group = file.create_group(f"trials/t{trial}")
            group.attrs.update(role="train", task="")
            group["sensors/time"] = time
            for name, (unit, role, values) in make(rng, time).items():
                channel = group.create_dataset(f"sensors/channels/{name}", data=values)
                channel.attrs.update(unit=unit, kind=role)
    print(f"{kind}: a data set of {path.stat().st_size / 1e6:.0f} MB", flush=True)


def on_data(program, folder, size):
    long = folder / "long.h5"
    for kind in KINDS:
        recording(long, size, kind)
        measured(program, "data", "check", long)
        if kind == "32 channels of noise":
            measured(program, "data", "info", long)
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

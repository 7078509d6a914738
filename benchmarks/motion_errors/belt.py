#!/usr/bin/python3
"""A recording over ground as it would be on a treadmill: markers and centres of pressure move back with the belt.

usage: belt.py --data SHARED/data/gait_walk3d --speed 1.2 --out FOLDER
       belt.py --data SHARED/data/gait_walk3d --speed 1.2 --out FOLDER --sinew build/release/sinew

The folder gets markers (.trc), forces (.mot), external loads and the model of the original, ready for `sinew data import`. With --sinew the
commands of docs/walking.md follow: right stance 1 fitted by `continuation`, the others held out; one line per kind of prediction.
"""
import argparse
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np

STANCES = (("right_1", "0.262:1.03", "train", "Right_GRF"), ("left_1", "0.8305:1.596", "validate", "Left_GRF"),
           ("right_2", "1.4065:2.1745", "validate", "Right_GRF"))  # docs/walking.md


def move_markers(source, target, speed):
    """Five lines of header, then frame, time and three coordinates of each marker in mm."""
    lines = source.read_text().splitlines()
    moved = lines[:5]
    for line in lines[5:]:
        cells = line.split("\t")
        if len(cells) < 3 or not cells[1].strip():
            moved.append(line)
            continue
        back = 1000 * speed * float(cells[1])
        for c in range(2, len(cells), 3):
            if cells[c].strip():
                cells[c] = repr(float(cells[c]) - back)
        moved.append("\t".join(cells))
    target.write_text("\n".join(moved) + "\n")


def move_centres(source, target, speed):
    """Centres of pressure, columns ..._px, in m."""
    lines = source.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line.strip() == "endheader") + 1
    names = lines[head].split("\t")
    columns = [k for k, name in enumerate(names) if name.endswith("_px")]
    values = np.array([[float(cell) for cell in line.split("\t")] for line in lines[head + 1:] if line.strip()])
    for c in columns:
        values[:, c] -= speed * values[:, 0]
    rows = ["\t".join(repr(float(v)) for v in row) for row in values]
    target.write_text("\n".join(lines[:head + 1] + rows) + "\n")


def transform(options):
    options.out.mkdir(parents=True, exist_ok=True)
    move_markers(options.data / "markers_walk.trc", options.out / "markers_walk.trc", options.speed)
    move_centres(options.data / "grf_walk.mot", options.out / "grf_walk.mot", options.speed)
    for name in ("grf_walk.xml", "subject_walk_scaled.osim", "ik_tasks_walk.xml"):
        shutil.copy(options.data / name, options.out / name)


def fit(options):
    at = options.out
    data, settings, found = at / "walk.h5", at / "soles.yaml", at / "fit.json"

    def sinew(*words):
        subprocess.run([str(options.sinew), *map(str, words)], check=True, stdout=subprocess.DEVNULL)

    data.unlink(missing_ok=True)
    sinew("data", "import", at / "markers_walk.trc", at / "grf_walk.mot", at / "subject_walk_scaled.osim", "--external-loads", at / "grf_walk.xml",
          "--trial", "walk", "--title", "gait_walk3d on a belt", "--source", "belt.py", "--licence", "that of gait_walk3d", "--out", data)
    sinew("data", "kinematics", data, "--weights", at / "ik_tasks_walk.xml")
    sinew("data", "dynamics", data)
    for name, window, role, plate in STANCES:
        sinew("data", "cut", data, "--trial", "walk", "--window", window, "--as", name, "--role", role, "--plate", plate)
    sinew("data", "drop", data, "--trial", "walk")
    settings.unlink(missing_ok=True)
    sinew("data", "soles", data, "--out", settings)
    print(*[line for line in settings.read_text().splitlines() if line.strip().startswith("floor_velocity")])
    sinew("identify", "contact", "--data", data, "--config", settings, "--solver", "continuation", "--intervals", "linear", "--quiet",
          "--out", at / "fit.h5", "--json", found)
    result = json.loads(found.read_text())
    show("fitted (a)", [one for one in result["fit"] if one["role"] == "train"])
    show("re-estimated (b)", [one for one in result["fit"] if one["role"] == "validate"])
    for other in result["alternatives"]:
        show(other["prediction"], [one for one in other["fit"] if one["role"] == "validate"])


def show(title, rows):
    """Root mean squares over the stances, in N and mm."""
    cells = []
    for kind, scale in (("force_y", 1), ("force_x", 1), ("force_z", 1), ("cop_x", 1e3), ("cop_z", 1e3)):
        errors = [one["rmse"] for one in rows if one["channel"].endswith(kind) and one["rmse"] is not None]
        if errors:
            cells.append(f"{kind} {scale * np.sqrt(np.mean(np.square(errors))):.3g}")
    print(f"{title}: {', '.join(cells)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--speed", type=float, default=1.2, help="of the belt, backwards [m/s]")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--sinew", type=Path)
    options = parser.parse_args()
    transform(options)
    if options.sinew:
        fit(options)


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Fascicles of tibialis anterior that ultrasound saw (recordings.py) against those of a fit, which did not use them.

Prints, per recording: the torque's RMSE and R2, the RMS error of the fascicle's length beside its mean error, and how much it shortens from its
first second to the shortest before the plate moves (in all of the recording, if it does not), measured (mean of two regions) and simulated.

usage: fascicles.py person.h5 run.h5
"""
import sys

import h5py
import numpy as np

MOVES = np.radians(2)  # of the plate, from its first second's angle


def main():
    data, run = h5py.File(sys.argv[1]), h5py.File(sys.argv[2])
    print("recording | role | torque [N m], R2 | error of the length beside its mean [mm] | shortening measured, simulated [mm]")
    for name in sorted(data["trials"]):
        grids = [grid for grid in data[f"trials/{name}"].values() if "channels" in grid and "tib_ant_fascicle_1" in grid["channels"]]
        torque = run[f"prediction/{name}/machine_torque"].attrs
        said = f"{name} | {torque['role']} | {torque['rmse']:.2f}, {torque['r2']:.3f}"
        if not grids:
            print(said)
            continue
        time = grids[0]["time"][:]
        measured = 1e3 * np.mean([grids[0][f"channels/tib_ant_fascicle_{i}"][:] for i in (1, 2)], axis=0)
        parts = run[f"details/ankle_on_dynamometer/{name}"]
        when, plate = parts["time"][:], parts["machine_angle"][:]
        simulated = 1e3 * np.interp(time, when, parts["fibre_length/tib_ant_r"][:])
        known = np.isfinite(measured)
        time, measured, simulated = time[known], measured[known], simulated[known]
        first = time < time[0] + 1
        measured, simulated = measured - measured[first].mean(), simulated - simulated[first].mean()
        moved = np.abs(plate - plate[when < when[0] + 1].mean()) > MOVES
        still = time < (when[np.argmax(moved)] if moved.any() else np.inf)
        print(f"{said} | {np.std(measured - simulated):.2f} | {-measured[still].min():.1f}, {-simulated[still].min():.1f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

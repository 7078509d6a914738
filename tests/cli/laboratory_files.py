"""Small files as a laboratory's programs write them."""

MOTION_COLUMNS = ("time", "knee_angle_r", "hip_flexion_r")
MOTION_ROWS = ((0.0, 1, 2), (0.1, 1, 2), (0.2, 1, 2), (0.3, 1, 2))


def mot(columns=MOTION_COLUMNS, rows=MOTION_ROWS, announced_rows=None, announced_columns=None, in_degrees="no"):
    """A motion file; its rows begin at line 8."""
    lines = ["walk", "version=1", f"nRows={announced_rows or len(rows)}",
             f"nColumns={announced_columns or len(columns)}", f"inDegrees={in_degrees}", "endheader",
             "\t".join(columns)]
    lines += ["\t".join(map(str, row)) for row in rows]
    return "\n".join(lines) + "\n"


def replaced(rows, index, row):
    return (*rows[:index], row, *rows[index + 1:])


def trc(markers=("RASI", "LASI"), frames=4, units="mm", announced_frames=None, announced_markers=None, changed=None):
    """A marker file at 60 Hz; its frames begin at line 7. changed: whole lines by frame."""
    axes = "\t".join(f"{axis}{i + 1}" for i in range(len(markers)) for axis in "XYZ")
    lines = ["PathFileType\t4\t(X/Y/Z)\twalk.trc",
             "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
             f"60\t60\t{announced_frames or frames}\t{announced_markers or len(markers)}\t{units}\t60\t1\t{frames}",
             "Frame#\tTime\t" + "\t\t\t".join(markers) + "\t\t", "\t\t" + axes, ""]
    for frame in range(frames):
        positions = [f"{frame + i:.1f}" for i in range(3 * len(markers))]
        lines.append("\t".join([str(frame + 1), f"{frame / 60:.5f}", *positions]))
    for frame, line in (changed or {}).items():
        lines[6 + frame] = line
    return "\n".join(lines) + "\n"

# %% motion [markdown]
# ## How far the motion moved
#
# The motion was measured too. In each stance the pose of the foot deviates from the recorded one, moved to its own
# markers, by smooth curves with a prior: the coloured lines, along or about the axes of the ground; dashed, what all
# stances have in common; grey, one standard deviation of the prior on both sides.

# %% motion
stances = [(trial, plate) for trial in children("/details/motion_errors")
           for plate in children(f"/details/motion_errors/{trial}")]
figure, rows = plt.subplots(len(stances), 2, figsize=(WIDTH, 0.7 + 1.9 * len(stances)), squeeze=False, sharey="col")
AXES = (("x", TRAIN), ("y", VALIDATE), ("z", "#009E73"), ("joint", "#CC79A7"))
largest = {0: 0.0, 1: 0.0}
for (trial, plate), panels in zip(stances, rows):
    node = run[f"/details/motion_errors/{trial}/{plate}"]
    when, names = node["time"][:], text_list(node["component"])
    for side, (axis, kinds, scale) in enumerate(zip(panels, (("shift_",), ("turn_", "joint")), (1e3, 180 / np.pi))):
        columns = [i for i, name in enumerate(names) if name.startswith(kinds)]
        prior = scale * node["prior"][:][columns[0]]
        axis.axhspan(-prior, prior, color="#eeeeee", zorder=0)
        for i in columns:
            colour = dict(AXES)[names[i].split("_")[-1]]
            axis.plot(when, scale * node["common"][:, i], "--", color=colour, lw=0.9)
            axis.plot(when, scale * node["deviation"][:, i], color=colour, label=names[i].replace("_", " "))
            if names[i] != "joint":
                largest[side] = max(largest[side], scale * np.abs(node["deviation"][:, i]).max())
        axis.margins(x=0.01)
        axis.set_title(trial)
        axis.set_ylabel("shift (mm)" if side == 0 else "rotation (°)")
for axis in rows[-1]:
    axis.set_xlabel("time (s)")
for axis in rows[0]:
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=4, borderaxespad=0, fontsize=8)
headline(figure, f"The feet moved by up to {number(largest[0], 2)} mm and {number(largest[1], 2)}°")
plt.show()

lines = []
for trial, plate in stances:
    node = run[f"/details/motion_errors/{trial}/{plate}"]
    if "marker" not in node:
        continue
    before, after = (1e3 * np.sqrt(np.nanmean(node[name][()] ** 2))
                     for name in ("marker_distance_recorded", "marker_distance_deviated"))
    lines.append(f"{escape(trial)}: {len(node['marker'])} markers on the foot lie {number(before, 2)} mm from it as "
                 f"recorded, {number(after, 2)} mm from it as it is estimated (root mean square).")
if lines:
    display(HTML(items(lines, "findings")))

# %% other predictions
if "alternatives" in run:
    node = run["/alternatives"]
    kinds, trials, channels = (text_list(node[name]) for name in ("prediction", "trial", "channel"))
    errors = dict(zip(zip(kinds, trials, channels), node["rmse"][:]))
    bands = dict(zip(zip(kinds, trials, channels), node["band95_half_width"][:]))

    def error_and_band(key):
        if key not in errors:
            return ""
        band = f" (±{number(bands[key], 2)})" if bands[key] > 0 else ""
        return number(errors[key], 2) + band

    heads = list(dict.fromkeys(kinds))
    body = []
    for trial, channel in dict.fromkeys(zip(trials, channels)):
        prediction = run.get(f"/prediction/{trial}/{channel}")
        if prediction is None or not np.isfinite(prediction.attrs["rmse"]):
            continue
        unit = pretty(str(prediction.attrs["unit"]))
        cells = [number(prediction.attrs["rmse"], 2), *(error_and_band((kind, trial, channel)) for kind in heads)]
        role = "fitted" if prediction.attrs["role"] == "train" else "held out, motion re-estimated"
        body.append(f"<tr><td>{escape(trial)}</td><td>{escape(channel)} ({unit})</td><td>{role}</td>"
                    + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    display(HTML("<p>In brackets: 95 % band of a prediction, where one is stated.</p>"
                 "<table><thead><tr><th>trial</th><th>channel</th><th></th><th>error (RMS)</th>"
                 + "".join(f"<th>predicted {escape(kind)}</th>" for kind in heads)
                 + f"</tr></thead><tbody>{''.join(body)}</tbody></table>"))

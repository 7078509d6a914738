# %% residuals [markdown]
# ## The error
#
# First one channel as it was measured and simulated, then every error: simulated minus measured. The **base model** is the
# fitted model as it is; the **extended model** has the named causes added, or the first discrepancy term. Held-out trials were
# not fitted.

# %% residuals
from itertools import zip_longest

BEFORE, AFTER, MOST_PANELS = "#E69F00", "#0072B2", 24
traces = [{"trial": trial, "channel": channel, "role": node.attrs["role"], "unit": pretty(node.attrs["unit"]),
           "time": node["time"][:], "measured": node["measured"][:], "before": node["before"][:] - node["measured"][:],
           "after": node["after"][:] - node["measured"][:]}
          for trial in children("/diagnosis/traces") for channel in children(f"/diagnosis/traces/{trial}")
          for node in [run[f"/diagnosis/traces/{trial}/{channel}"]]]
traces.sort(key=lambda trace: (trace["channel"], trace["role"] == "validate"))  # fitted trials first
floor = {row["channel"]: row["sigma"] for row in noise}


def rms(values):
    """Root mean square of the known values."""
    known = values[np.isfinite(values)]
    return np.sqrt(np.mean(known ** 2)) if known.size else np.nan


def share_explained(trace):
    """R2 of the base model in one trace."""
    known = np.isfinite(trace["before"])
    spread = np.sum((trace["measured"][known] - trace["measured"][known].mean()) ** 2) if known.any() else 0
    return 1 - np.sum(trace["before"][known] ** 2) / spread if spread > 0 else np.nan


def worst_of_each(most):
    """Of every channel and role those in which the base model errs most, as many as there is room for, in the order of all."""
    groups = {}
    for trace in traces:
        groups.setdefault((trace["channel"], trace["role"]), []).append(trace)
    for group in groups.values():
        group.sort(key=lambda trace: -np.nan_to_num(rms(trace["before"])))
    turns = [trace for turn in zip_longest(*groups.values()) for trace in turn if trace is not None]
    chosen = {id(trace) for trace in turns[:most]}
    return [trace for trace in traces if id(trace) in chosen]


shown = traces if len(traces) <= MOST_PANELS else worst_of_each(MOST_PANELS)
# What was measured, and how little of the fault the eye sees in it: the last held-out trial, else the last one.
seen = [trace for trace in shown if trace["channel"] == shown[0]["channel"]][-1]
figure, axis = plt.subplots(figsize=(WIDTH, 2.6))
axis.plot(seen["time"], seen["measured"], color="#b4bac1", lw=4, label="measured")
axis.plot(seen["time"], seen["measured"] + seen["before"], color=BEFORE, lw=1.3, label="base model")
if extended:
    axis.plot(seen["time"], seen["measured"] + seen["after"], color=AFTER, lw=1, label="extended model")
axis.set_xlabel("time (s)")
axis.set_ylabel(f"{elided(seen['channel'], 30)} ({seen['unit']})" if seen["unit"] else elided(seen["channel"], 30))
axis.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
fits = share_explained(seen)
headline(figure, f"{'Held-out trial' if seen['role'] == 'validate' else 'Trial'} {elided(seen['trial'], 24)}: "
         + (f"by eye the base model fits well (R² {coefficient(fits)})" if fits > 0.95 else "measured and simulated"))
plt.show()

key = [(BEFORE, "base model")] + [(AFTER, "extended model")] * extended + [("#d5dbe1", "noise (±2 σ)")] * bool(floor)
display(HTML(color_key(key)))
columns = min(3, len(shown))
rows = -(-len(shown) // columns)
figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, 0.7 + 1.75 * rows), squeeze=False)
limits = {channel: 1.05 * max(np.nanmax(np.abs([*trace["before"], *trace["after"]]), initial=0) for trace in shown
                              if trace["channel"] == channel) or 1 for channel in {trace["channel"] for trace in shown}}
for axis, trace in zip(axes.flat, shown):
    sigma = floor.get(trace["channel"], np.nan)
    if np.isfinite(sigma):
        axis.axhspan(-2 * sigma, 2 * sigma, color="#e9edf1", lw=0, zorder=0)
    axis.axhline(0, color="#999999", lw=0.7)
    axis.plot(trace["time"], trace["before"], color=BEFORE, lw=1.3)
    if extended:
        axis.plot(trace["time"], trace["after"], color=AFTER, lw=1.1)
    axis.set_ylim(-limits[trace["channel"]], limits[trace["channel"]])
    change = f"{number(rms(trace['before']), 2)}" + (f" → {number(rms(trace['after']), 2)}" if extended else "")
    axis.set_title(f"{elided(trace['channel'], 26)}, {elided(trace['trial'], 18)}\n"
                   f"{'held out' if trace['role'] == 'validate' else 'fitted'}, RMS {change} {trace['unit']}",
                   color=VALIDATE if trace["role"] == "validate" else "#333333")
    axis.locator_params(nbins=5)
for axis in axes.flat[len(shown):]:
    axis.remove()
for row in range(rows):
    axes[row, 0].set_ylabel(f"({shown[row * columns]['unit']})" if shown[row * columns]["unit"] else "")
for axis in axes.flat[max(len(shown) - columns, 0):len(shown)]:
    axis.set_xlabel("time (s)")
held_out = [trace for trace in traces if trace["role"] == "validate"]
headline(figure, "The extended model has smaller errors, on held-out trials too" if extended and held_out and
         all(rms(trace["after"]) < rms(trace["before"]) for trace in held_out) else
         "What the extended model changes" if extended else "Residuals of the base model")
plt.show()
if len(shown) < len(traces):
    display(HTML(items([f"{len(shown)} of {len(traces)} traces are drawn, of every channel those in which the base model errs most; "
                        "all are in /diagnosis/traces."], "notes")))

# %% errors
fit = {(row["channel"], row["role"]): [row, None] for row in rows_of("base_fit")}
for row in rows_of("extended_fit"):
    fit.setdefault((row["channel"], row["role"]), [None, None])[1] = row


ROLES = {"train": "fitted", "validate": "held out", "predicted": "measured, not fitted"}


def error_cell(row):
    return ">" + (f"{number(row['rmse'])} {escape(pretty(row['unit']))} <small>R² {coefficient(row['r2'])}</small>"
                  if row and np.isfinite(row["rmse"]) else "–")


heads = ["Error (RMSE)", "Trials", ">Base model"] + [">Extended model"] * extended + [">Samples"]
display(HTML(table(heads, [[escape(channel), ROLES.get(role, escape(role)), error_cell(before)]
                           + [error_cell(after)] * bool(extended) + [f">{int((before or after)['n'])}"]
                           for (channel, role), (before, after) in fit.items()])))
if noise:
    display(HTML(items([f"Noise floor of {row['channel']}: {number(row['sigma'])} {pretty(row['unit'])} ({row['basis']})."
                        for row in noise], "notes")))

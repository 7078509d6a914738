# %% fit [markdown]
# ## Measured against simulated
#
# Black is measured, colour is simulated. The strip beneath is simulated minus measured. Blue trials were fitted,
# orange trials were not: they show whether the model holds on data it never saw.

# %% fit
fits = []
for trial in children("/prediction"):
    for channel in children(f"/prediction/{trial}"):
        node, residual = run[f"/prediction/{trial}/{channel}"], run.get(f"/residual/{trial}/{channel}", {})
        role = node.attrs["role"]
        fits.append({"trial": trial, "channel": channel, "unit": pretty(node.attrs["unit"]), "role": role,
                     "n": node.attrs["n"], "rmse": node.attrs["rmse"], "r2": node.attrs["r2"],
                     "colour": VALIDATE if role == "validate" else TRAIN,
                     "time": node["time"][:], "simulated": node["simulated"][:], "measured": node["measured"][:],
                     "residual_time": residual["time"][:] if residual else np.array([]),
                     "residual": residual["residual"][:] if residual else np.array([])})
measured_channels = list(dict.fromkeys(fit["channel"] for fit in fits if np.isfinite(fit["measured"]).any()))


def pooled_rmse(some):
    """RMSE over several trials [unit of the channel]."""
    known = [fit for fit in some if np.isfinite(fit["rmse"]) and fit["n"] > 0]
    return np.sqrt(np.average([f["rmse"] ** 2 for f in known], weights=[f["n"] for f in known])) if known else np.nan


def draw_channel(channel, most):
    """One channel: a panel per trial, at most `most` fitted and as many others, with the residual beneath."""
    every = [fit for fit in fits if fit["channel"] == channel and np.isfinite(fit["measured"]).any()]
    every.sort(key=lambda fit: fit["role"] == "validate")
    train = [fit for fit in every if fit["role"] != "validate"]
    validate = [fit for fit in every if fit["role"] == "validate"]
    rows = [every] if len(every) <= 3 else [
        part[i:i + 3] for part in (train[:most], validate[:most]) for i in range(0, len(part), 3)]
    unit = every[0]["unit"]

    fitted, unseen = pooled_rmse(train), pooled_rmse(validate)
    finding = f"{channel}: off by {number(fitted, 2)} {unit} (RMSE) where fitted"
    if validate and train:
        verdict = "holds" if unseen <= 1.25 * fitted else "gets worse"
        finding += f", {number(unseen, 2)} {unit} where not: the fit {verdict} on trials it never saw"
    elif validate:
        finding = f"{channel}: off by {number(unseen, 2)} {unit} (RMSE) on trials it never saw"
    shown = sum(map(len, rows))
    if shown < len(every):
        finding += f" ({shown} of {len(every)} trials shown)"

    height = 0.55 + 3.0 * len(rows)
    figure = plt.figure(figsize=(WIDTH, height))
    lines = headline(figure, finding)
    figure.set_layout_engine("none")  # with many panels, fixed places are drawn much faster than fitted ones
    columns = max(map(len, rows))
    bands = figure.add_gridspec(len(rows), columns, left=0.075, right=0.995, top=1 - (0.57 + 0.18 * lines) / height,
                                bottom=0.45 / height, wspace=0.08, hspace=0.42)
    values = np.concatenate([fit[key][np.isfinite(fit[key])] for fit in every for key in ("measured", "simulated")])
    low, high = values.min(), values.max()
    misses = np.concatenate([np.abs(fit["residual"][np.isfinite(fit["residual"])]) for fit in every])
    worst = misses.max() if misses.size and misses.max() > 0 else 1.0
    for r, row in enumerate(rows):
        for c, fit in enumerate(row):
            panel = bands[r, c].subgridspec(2, 1, height_ratios=[3, 1.1], hspace=0.1)
            upper = figure.add_subplot(panel[0])
            lower = figure.add_subplot(panel[1], sharex=upper)
            upper.plot(fit["time"], fit["simulated"], color=fit["colour"], lw=2.2, label="simulated")
            known = np.isfinite(fit["measured"])
            sparse = 2 * (known[1:] & known[:-1]).sum() < known.sum()  # single samples that no line would join
            upper.plot(fit["time"], fit["measured"], "." if sparse else "-", ms=3, lw=0.9, color=MEASURED,
                       label="measured")
            upper.set_ylim(low - 0.05 * (high - low or 1), high + 0.08 * (high - low or 1))
            role = "not fitted" if fit["role"] == "validate" else "fitted"
            r2 = f"R² {fit['r2']:.3f}, " if np.isfinite(fit["r2"]) else ""
            upper.set_title(f"{fit['trial']} – {role}\n{r2}RMSE {number(fit['rmse'], 2)} {unit}", color=fit["colour"])
            lower.fill_between(fit["residual_time"], fit["residual"], color=fit["colour"], alpha=0.25, lw=0)
            lower.plot(fit["residual_time"], fit["residual"], color=fit["colour"], lw=0.8)
            lower.axhline(0, color="#999999", lw=0.8)
            lower.set_ylim(-1.1 * worst, 1.1 * worst)
            upper.locator_params(nbins=4)
            lower.locator_params(axis="x", nbins=4)
            lower.locator_params(axis="y", nbins=3)
            upper.tick_params(labelbottom=False, labelleft=c == 0)
            lower.tick_params(labelleft=c == 0)
            lower.set_xlabel("time (s)")
            if c == 0:
                upper.set_ylabel(f"{channel} ({unit or '1'})")
                lower.set_ylabel("sim. – meas.")
                figure.align_ylabels([upper, lower])
            if r == 0 and c == 0:
                upper.legend(loc="best", handlelength=1.2)
    plt.show()


for channel in measured_channels:
    draw_channel(channel, most=6 if len(measured_channels) <= 3 else 3)  # more: raise these

# %% predicted only
# What the model tells although nobody measured it.
unmeasured = [fit for fit in fits if fit["channel"] not in measured_channels]
names = list(dict.fromkeys(fit["channel"] for fit in unmeasured))
shown = names[:12]
if shown:
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, 0.6 + 2.0 * rows), squeeze=False)
    for axis, channel in zip(axes.flat, shown):
        for fit in (fit for fit in unmeasured if fit["channel"] == channel):
            axis.plot(fit["time"], fit["simulated"], color=TRAIN, lw=1, alpha=0.6)
        axis.set_title(channel)
        axis.set_ylabel(f"({fit['unit'] or '1'})")
    for axis in axes.flat[len(shown):]:
        axis.remove()
    for axis in axes.flat[max(len(shown) - columns, 0):len(shown)]:
        axis.set_xlabel("time (s)")
    headline(figure, "Simulated, but not measured: one line per trial"
                    + (f"  ({len(shown)} of {len(names)} channels)" if len(shown) < len(names) else ""))
    plt.show()

# %% fit [markdown]
# ## Measured against simulated
#
# The strip beneath each panel is the error, simulated minus measured. Held-out trials were not fitted: they test whether the
# model generalises.

# %% fit
def title_of(fit, with_place, most):
    """Two lines above a panel, the first with at most `most` characters."""
    name = f"{fit['trial']}, {fit['place']}" if with_place else fit["trial"]
    role = "held out" if fit["role"] == "validate" else "fitted"
    r2 = f"R² {coefficient(fit['r2'])}, " if np.isfinite(fit["r2"]) else ""
    return f"{elided(name, most - len(role) - 3)} – {role}\n{r2}RMSE {number(fit['rmse'])} {fit['unit']}"


def finding_of(key, places):
    """What the figure of a quantity shows."""
    quantity, unit = key
    name = quantity if "_" in quantity else quantity[:1].upper() + quantity[1:]
    if len(places) == 1 and places[0] != quantity:
        name += f", {places[0]}"
    here, there = pooled(train.get(key, [])), pooled(validate.get(key, []))
    if key not in validate:
        return f"{name}: RMSE {error_text(*here, unit)} on fitted trials"
    if key not in train:
        return f"{name}: RMSE {error_text(*there, unit)} on held-out trials"
    verdict = "" if there[0] <= 1.25 * here[0] else ": larger"
    return f"{name}: RMSE {error_text(*here, unit)} on fitted trials, {error_text(*there, unit)} on held-out trials{verdict}"


def draw_panel(figure, place, fit, limits, worst):
    """One trial: measured and simulated, the error beneath. Returns both axes."""
    colour = VALIDATE if fit["role"] == "validate" else TRAIN
    panel = place.subgridspec(2, 1, height_ratios=[3, 1.1], hspace=0.1)
    upper = figure.add_subplot(panel[0])
    lower = figure.add_subplot(panel[1], sharex=upper)
    upper.plot(fit["time"], fit["simulated"], color=colour, lw=2.2, label="simulated")
    draw_measured(upper, fit)
    upper.set_ylim(*limits)
    lower.fill_between(fit["residual_time"], fit["residual"], color=colour, alpha=0.25, lw=0)
    lower.plot(fit["residual_time"], fit["residual"], color=colour, lw=0.8)
    lower.axhline(0, color="#999999", lw=0.8)
    lower.set_ylim(-1.1 * worst, 1.1 * worst)
    upper.locator_params(nbins=4)
    lower.locator_params(axis="x", nbins=4)
    lower.locator_params(axis="y", nbins=3)
    upper.tick_params(labelbottom=False)
    lower.set_xlabel("time (s)")
    return upper, lower


def draw_quantity(key, most):
    """One quantity: a panel per trial, at most `most` fitted and as many others."""
    parts = [part.get(key, []) for part in (train, validate)]
    every = parts[0] + parts[1]
    places = list(dict.fromkeys(fit["place"] for fit in every))
    rows = [every] if len(every) <= 3 else [
        part[:most][i:i + 3] for part in parts for i in range(0, len(part[:most]), 3)]
    shown = sum(map(len, rows))
    height = 0.6 + 3.0 * len(rows)
    figure = plt.figure(figsize=(WIDTH, height))
    lines = headline(figure, finding_of(key, places)
                     + (f" ({shown} of {len(every)} trials shown)" if shown < len(every) else ""))
    figure.set_layout_engine("none")  # with many panels, fixed places are drawn much faster than fitted ones
    columns = max(map(len, rows))
    bands = figure.add_gridspec(len(rows), columns, left=0.075, right=0.995, top=1 - (0.57 + 0.18 * lines) / height,
                                bottom=0.45 / height, wspace=0.08, hspace=0.42)
    low, high = span([fit[name] for fit in every for name in ("measured", "simulated")])
    limits = low - 0.05 * (high - low), high + 0.08 * (high - low)
    worst = max(map(abs, span([fit["residual"] for fit in every])))
    for r, row in enumerate(rows):
        for c, fit in enumerate(row):
            upper, lower = draw_panel(figure, bands[r, c], fit, limits, worst)
            upper.set_title(title_of(fit, len(places) > 1, 126 // columns),
                            color=VALIDATE if fit["role"] == "validate" else TRAIN)
            for axis in (upper, lower):
                axis.tick_params(labelleft=c == 0)
            if c == 0:
                label = fit["quantity"] + (f" ({fit['unit']})" if fit["unit"] else "")
                upper.set_ylabel(label if len(label) <= 22 else f"({fit['unit']})" if fit["unit"] else "")  # the headline has the name
                lower.set_ylabel("error")
                figure.align_ylabels([upper, lower])
    plt.show()


quantities = list(dict.fromkeys([*train, *validate]))
display(HTML(color_key([(MEASURED, "measured")] + [(TRAIN, "simulated, fitted trial")] * bool(train)
                       + [(VALIDATE, "simulated, held-out trial")] * bool(validate))))
for key in quantities:
    draw_quantity(key, most=6 if len(quantities) <= 3 else 3)  # more: raise these

# %% gain [markdown]
# ## Gain on held-out trials
#
# Both models predict trials that neither was fitted to. Grey: the error that noise alone leaves in the fitted trials.

# %% gain
sigma_of = {row["channel"]: row["sigma"] for row in noise}
figure, axes = plt.subplots(len(gains), 1, figsize=(WIDTH, 0.75 + 0.95 * len(gains)), squeeze=False)
for axis, gain in zip(axes.flat, gains):
    sigma = sigma_of.get(gain["channel"], np.nan)
    if not np.isfinite(sigma) and len(set(sigma_of.values())) == 1 and noise[0]["unit"] == gain["unit"]:
        sigma = noise[0]["sigma"]
    low, high = (gain["before"] * (1 - gain[key]) for key in ("ci95_upper", "ci95_lower"))
    if np.isfinite(sigma):
        axis.axvspan(0, sigma, color="#e9edf1", lw=0)
        axis.annotate("noise floor", (sigma, -0.42), xytext=(-3, 0), textcoords="offset points", ha="right", size=8,
                      color="#6f7780")
    axis.plot([low, high], [0, 0], color=TRAIN, lw=9, alpha=0.25, solid_capstyle="butt")
    axis.annotate("", (gain["after"], 0), (gain["before"], 0), arrowprops={"arrowstyle": "-|>", "color": "#555555", "lw": 1.2,
                                                                           "shrinkA": 4, "shrinkB": 4})
    axis.plot(gain["before"], 0, "o", ms=9, color="#E69F00", zorder=3)
    axis.plot(gain["after"], 0, "o", ms=9, color=TRAIN, zorder=3)
    right = 1.12 * max(gain["before"], gain["after"], high)
    close = abs(gain["before"] - gain["after"]) < 0.08 * right  # labels to either side
    for value, other, colour in ((gain["before"], gain["after"], "#946400"), (gain["after"], gain["before"], TRAIN)):
        axis.annotate(number(value), (value, 0), xytext=(0, 9), textcoords="offset points", color=colour,
                      ha="center" if not close else "left" if value >= other else "right")
    axis.set_ylim(-0.5, 0.75)
    axis.set_xlim(0, right)
    axis.set_yticks([0], [elided(gain["channel"], 30)])
    axis.tick_params(axis="y", length=0)
    axis.grid(axis="y", visible=False)
    axis.spines["left"].set_visible(False)
    axis.set_xlabel(f"RMSE on held-out trials ({pretty(gain['unit'])})" if pretty(gain["unit"]) else "RMSE on held-out trials")
best = gains[0]
headline(figure, f"{best['channel']}: {percent(-best['reduction'])} error on held-out trials (95 % interval "
         f"{percent(-best['ci95_upper'])} to {percent(-best['ci95_lower'])})")
figure.supxlabel("Orange: base model.  Blue: extended model, with its 95 % interval (block bootstrap).", size=8, color="#666666",
                 x=0.0, ha="left")
plt.show()

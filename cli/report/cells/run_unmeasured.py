# %% unmeasured [markdown]
# ### Simulated, but not measured
#
# Predictions of the model without a measurement to compare: one line per trial. Where it states a 95 % band, this is shaded.

# %% unmeasured
shown = dict(list(unmeasured.items())[:12])
columns = min(3, len(shown))
rows = -(-len(shown) // columns)
figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, 0.3 + 2.0 * rows), squeeze=False)
for axis, ((quantity, unit), group) in zip(axes.flat, shown.items()):
    places = list(dict.fromkeys(fit["place"] for fit in group))
    looks = dict(zip(places, [("-", "#666666"), ("--", "#9a9a9a"), (":", "#666666"), ("-.", "#9a9a9a")] * len(places)))
    for fit in group:
        style, colour = looks[fit["place"]]
        axis.plot(fit["time"], fit["simulated"], style, color=colour, lw=1, alpha=0.8)
        if fit["band"] is not None:
            axis.fill_between(fit["time"], fit["simulated"] - fit["band"], fit["simulated"] + fit["band"], color=colour, alpha=0.2, lw=0)
    if len(places) == 1:
        axis.set_title(elided(quantity if places[0] == quantity else f"{quantity}, {places[0]}", 42))
    else:
        axis.set_title(elided(quantity, 42))
        beside = 2 if max(map(len, places)) <= 11 else 1
        low, high = axis.get_ylim()  # room for the legend above the curves
        axis.set_ylim(low, high + (0.06 + 0.15 * -(-len(places) // beside)) * (high - low))
        axis.legend([plt.Line2D([], [], ls=style, color=colour) for style, colour in looks.values()],
                    [elided(place, 20) for place in places], loc="upper left", ncol=beside, handlelength=1.6, borderaxespad=0.2)
    axis.set_ylabel(f"({unit})" if unit else "")
    axis.locator_params(nbins=5)
for axis in axes.flat[len(shown):]:
    axis.remove()
for axis in axes.flat[max(len(shown) - columns, 0):len(shown)]:
    axis.set_xlabel("time (s)")
if len(shown) < len(unmeasured):
    headline(figure, f"{len(shown)} of {len(unmeasured)} quantities shown")
plt.show()

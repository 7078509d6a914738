# %% structure [markdown]
# ## Where the error is
#
# The share of the residual's variance that a smooth curve of one signal predicts for trials the curve was not fitted to,
# and the strongest of these curves. They are descriptive and raise no alarm.

# %% structure
MOST_SIGNALS, MOST_CURVES = 12, 3
structure = [{**{key: value.decode() if isinstance(value, bytes) else value for key, value in node.attrs.items()},
              "knots": node["knots"][:], "curve": node["curve"][:]}
             for node in (run[f"/diagnosis/structure/{i}"] for i in children("/diagnosis/structure"))]
structure.sort(key=lambda part: -part["explained_fraction"])
units = {trace["channel"]: trace["unit"] for trace in traces} if "traces" in globals() else {}
one_channel = len({part["channel"] for part in structure}) == 1  # then the headline names it
shown, curves = structure[:MOST_SIGNALS], structure[:MOST_CURVES]
figure = plt.figure(figsize=(WIDTH, 0.7 + max(2.4, 0.2 * len(shown)) ))
grid = figure.add_gridspec(1, 1 + len(curves), width_ratios=[1.15] + [1] * len(curves))
bars = figure.add_subplot(grid[0])
bars.barh(range(len(shown)), [100 * part["explained_fraction"] for part in shown], height=0.62,
          color=["#56789a" if part in curves else "#c3ccd5" for part in shown])
bars.set_yticks(range(len(shown)), [elided(part["signal"] if one_channel else f"{part['channel']} – {part['signal']}", 34) for part in shown])
bars.tick_params(axis="y", length=0, labelsize=8)
bars.set_ylim(max(len(shown), 4) - 0.4, -0.6)
bars.grid(axis="y", visible=False)
bars.set_xlabel("share of variance (%)")
for i, part in enumerate(curves):
    axis = figure.add_subplot(grid[i + 1])
    axis.axhline(0, color="#999999", lw=0.7)
    axis.plot(part["knots"], part["curve"], "-o", ms=3, color="#56789a")
    axis.set_title(f"{elided(part['signal'] if one_channel else part['channel'], 18)}: {percent(part['explained_fraction'])}\n{elided(part['shape'], 30)}")
    axis.set_xlabel(elided(f"{part['signal']} ({pretty(part['signal_unit'])})" if pretty(part["signal_unit"])
                           else part["signal"], 32))
    unit = units.get(part["channel"], "")
    axis.set_ylabel(f"residual ({unit})" if unit else "residual")
    axis.locator_params(nbins=4)
first = structure[0]
headline(figure, f"{percent(first['explained_fraction'])} of the error of {first['channel']} goes with {first['signal']}")
plt.show()

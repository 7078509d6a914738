# %% unused [markdown]
# ### Measured but not used in this fit
#
# These channels were not fitted, and the parameters they depend on may not be determined, so that large errors are
# expected. Grey is simulated, black is measured.

# %% unused
def draw_unused(groups, most):
    """A row per quantity, a small panel per trial, at most `most`."""
    columns = min(most, max(map(len, groups.values())))
    height = 0.5 + 1.5 * len(groups)
    figure, axes = plt.subplots(len(groups), columns, figsize=(WIDTH, height), sharey="row", squeeze=False,
                                gridspec_kw={"left": 0.09, "right": 0.995, "top": 1 - 0.5 / height,
                                             "bottom": 0.45 / height, "wspace": 0.07, "hspace": 0.55})
    figure.set_layout_engine("none")
    for row, ((quantity, unit), group) in zip(axes, groups.items()):
        for axis, fit in zip(row, group):
            axis.plot(fit["time"], fit["simulated"], color="#a8a8a8", lw=2.2, label="simulated")
            draw_measured(axis, fit)
            name = f"{fit['trial']}, {fit['place']}" if columns < 4 else fit["trial"]
            error = f"RMSE {number(fit['rmse'], 2)} {unit}".strip()
            axis.set_title(f"{elided(name, 118 // columns - len(error) - 2)}: {error}", size=8, color="#666666")
            axis.locator_params(nbins=4)
        row[0].set_ylabel("\n".join(textwrap.wrap(quantity + (f" ({unit})" if unit else ""), 18)[:3]), size=8)
        row[0].yaxis.set_label_coords(-0.06 * columns, 0.5)
        for axis in row[len(group):]:
            axis.remove()
    for axis in axes[-1][:len(group)]:
        axis.set_xlabel("time (s)")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="upper right", ncol=2, handlelength=1.2,
                  borderaxespad=0, bbox_to_anchor=(0.995, 1.0))
    hidden = max(map(len, groups.values())) - columns
    figure.text(0, 1, "Measured, not used" + (f": {columns} of {columns + hidden} trials shown" if hidden else ""),
                va="top", size=9, color="#666666")
    plt.show()


draw_unused(unused, most=5)

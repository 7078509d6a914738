# %% correlation [markdown]
# ## Correlations
#
# Near +1 or −1, the data do not distinguish a change of one parameter from a change of the other. Parameters that the data
# do not determine, or that rest at a bound, have no correlations.

# %% correlation
everyone = texts("/uncertainty/name")
kept = [i for i, name in enumerate(everyone) if name in shown and shown[name]["verdict"] in ("identifiable", "weak")]
names = [everyone[i] for i in kept]
correlation = run["/uncertainty/correlation"][()][np.ix_(kept, kept)]

size = float(np.clip(1.2 + 0.55 * len(names), 2.5, 8.5))
figure, axis = plt.subplots(figsize=(size + 1.6, size))
axis.set_facecolor("#f4f4f4")
colours = axis.imshow(np.ma.masked_invalid(correlation), vmin=-1, vmax=1, cmap="RdBu_r")
for i, j in np.ndindex(correlation.shape):
    value = correlation[i, j]
    if len(names) <= 14:
        axis.text(j, i, f"{value:.2f}".replace("-", "−") if np.isfinite(value) else "·", ha="center", va="center",
                  size=8, color="white" if abs(value) > 0.45 else "#555555")
axis.set_xticks(range(len(names)), names, rotation=40, ha="right", rotation_mode="anchor")
axis.set_yticks(range(len(names)), names)
axis.tick_params(length=0)
axis.grid(False)
axis.spines[:].set_visible(False)
bar = figure.colorbar(colours, ax=axis, shrink=0.8, label="correlation")
bar.outline.set_visible(False)

pairs = np.nan_to_num(np.triu(correlation, 1))
i, j = np.unravel_index(np.argmax(np.abs(pairs)), pairs.shape)
if abs(pairs[i, j]) > 0.9:
    finding = f"{names[i]} and {names[j]} are almost collinear (correlation {pairs[i, j]:+.2f})".replace("-", "−")
else:
    finding = f"No two determined parameters are strongly correlated (at most {abs(pairs[i, j]):.2f})"
headline(figure, finding)
plt.show()

# %% choice [markdown]
# ## How the causes were chosen
#
# The misfit is much larger than the noise, so that likelihoods say little: sets of causes were compared by the error of data that
# were left out of the fit, in turn. Left: of each number of causes the set with the least such error, as a share of the base
# model's. Right: how often each effect is in the chosen set when the choice is repeated on resamples of the left-out data.
# The answer is the smallest set whose error is near the least, not the least one itself.

# %% choice
LEAST_SHARE = 0.01

ladder = [(row["effects"].split(",") if row["effects"] else [], row["error"]) for row in rows_of("ladder")]
ladder = [(effects, error) for effects, error in ladder if np.isfinite(error)]
shares = {row["effect"]: row["share"] for row in rows_of("chosen_shares")}
named = {cause["effect"] for cause in causes}
finding_of = {score["effect"]: score["finding"] for score in scores}
answer = next((i for i, (effects, _) in enumerate(ladder) if named and set(effects) == named), None)

# Every effect on the ladder or chosen now and then: those that are chosen most often first, then as they come in.
steps = {effect: i for i, (effects, _) in reversed(list(enumerate(ladder))) for effect in effects}
drawn = sorted({*steps, *(effect for effect, share in shares.items() if share >= LEAST_SHARE)},
               key=lambda effect: (-shares.get(effect, 0), steps.get(effect, len(ladder)), effect))


def colour_of(effect):
    return COLOURS["cause"] if effect in named else COLOURS.get(finding_of.get(effect), COLOURS["ruled_out"])


figure = plt.figure(figsize=(WIDTH, 2.6 + 0.25 * len(drawn)))
grid = figure.add_gridspec(2, 2, height_ratios=(1.5, 0.25 * len(drawn)), width_ratios=(max(len(ladder), 3), 3.2))
top = figure.add_subplot(grid[0, 0])
sets = figure.add_subplot(grid[1, 0], sharex=top)
right = figure.add_subplot(grid[1, 1], sharey=sets)

top.plot([error for _, error in ladder], "-o", color=TRAIN, ms=5)
for i, (_, error) in enumerate(ladder):
    top.annotate(percent(error), (i, error), xytext=(0, 7), textcoords="offset points", ha="center", size=8,
                 fontweight="bold" if i == answer else "normal")
top.set_ylim(0, 1.25 * max(error for _, error in ladder))
top.yaxis.set_major_formatter(lambda value, _: percent(value))
top.set_ylabel("error of left-out data\nover the base model's")
top.tick_params(axis="x", labelbottom=False, length=0)

for row, effect in enumerate(drawn):
    for i, (effects, _) in enumerate(ladder):
        inside = effect in effects
        sets.plot(i, row, "o", ms=8 if inside else 3, color=colour_of(effect) if inside else "#dfe3e7", mec="none")
    right.barh(row, shares.get(effect, 0), height=0.6, color=colour_of(effect), lw=0)
    right.annotate(percent(shares.get(effect, 0)), (shares.get(effect, 0), row), xytext=(4, 0), textcoords="offset points",
                   va="center", size=8)
if answer is not None:
    for axis in (top, sets):
        axis.axvspan(answer - 0.4, answer + 0.4, color="#e9edf1", lw=0, zorder=0)
sets.set_yticks(range(len(drawn)), [elided(effect, 40) for effect in drawn])
for tick, effect in zip(sets.get_yticklabels(), drawn):
    tick.set_fontweight("bold" if effect in named else "normal")
sets.set_ylim(len(drawn) - 0.4, -0.6)
sets.set_xticks(range(len(ladder)), [str(len(effects)) for effects, _ in ladder])
sets.set_xlim(-0.6, len(ladder) - 0.4)
sets.set_xlabel("causes in the set" + ("; grey: the answer" if answer is not None else ""))
right.set_xlabel("chosen, of 1000 resamples")
right.set_xlim(0, 1.18)
right.set_xticks([0, 0.5, 1], ["0", "50 %", "100 %"])
right.tick_params(axis="y", labelleft=False)
for axis in (sets, right):
    axis.tick_params(axis="y", length=0)
    axis.grid(axis="y", visible=False)
    axis.spines["left"].set_visible(False)
most = min(range(len(ladder)), key=lambda i: ladder[i][1])
told = [most] if answer is None else [answer] if ladder[most][1] == ladder[answer][1] else [answer, most]
headline(figure, "Error of left-out data, over that of the base model: " + ", ".join(
    f"{percent(ladder[i][1])} with {len(ladder[i][0])} {'cause' if len(ladder[i][0]) == 1 else 'causes'}" for i in told))
plt.show()

# %% the sets
often = [f"{effect} {percent(share)}" for effect, share in shares.items() if share >= LEAST_SHARE]
if often:
    display(HTML(items([f"Chosen, of 1000 resamples: {', '.join(often)}."], "notes")))
display(HTML("<details><summary>the sets as a table</summary>" + table(
    [">Causes", "Set", ">Error over the base model's"],
    [[f">{len(effects)}", (f"<b>{escape(', '.join(effects))}</b>" if i == answer else escape(", ".join(effects))) or "–",
      f">{percent(error)}"] for i, (effects, error) in enumerate(ladder)]) + "</details>"))

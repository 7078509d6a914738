# %% scores [markdown]
# ## What could explain it
#
# The score test of every effect in the library: how much the residual resembles the change that the effect would make, in
# standard deviations of what chance would give. The dashed line is the level that chance alone exceeds, anywhere in this
# list, with the stated probability. A long grey bar is an effect that only resembles a cause: the strongest were added to the
# model and fitted, and ΔBIC is the improvement by each alone (more is better). A cause with a short bar becomes significant
# only once a stronger one is in the model.

# %% scores
from statistics import NormalDist

MOST_BARS = 18


def strength(score):
    """The |t| of a single two-sided effect that is as improbable as this score."""
    p = score["p_value"]
    if p <= 1e-300:  # beyond what a p-value can hold
        return np.sqrt(max(score["statistic"], 0))
    return -NormalDist().inv_cdf(min(p, 1) / 2) if p < 1 else 0.0


judged = [score for score in scores if score["judged"]]
important = [score for score in judged if score["finding"] != "ruled_out"]
rest = [score for score in judged if score["finding"] == "ruled_out"]
shown = sorted(important + rest[:max(MOST_BARS - len(important), 4)], key=lambda score: -strength(score))

if shown:
    top = 1.25 * max([strength(score) for score in shown] + [about["threshold"]])
    figure, axis = plt.subplots(figsize=(WIDTH, 1.15 + 0.27 * len(shown)))
    for row, score in enumerate(shown):
        size, finding = strength(score), score["finding"]
        axis.barh(row, size, height=0.66, color=COLOURS[finding], hatch=None if score["known"] else "////",
                  edgecolor="white", lw=0)
        said = LABELS[finding] if finding != "ruled_out" else ""
        if score["refitted"] and np.isfinite(score["delta_bic"]):
            said += f"{'  ·  ' if said else ''}refit: ΔBIC {score['delta_bic']:+.0f}".replace("-", "−")
        axis.annotate(said, (size, row), xytext=(5, 0), textcoords="offset points", va="center", size=8,
                      color=COLOURS[finding] if finding not in ("ruled_out", "alternative") else "#6f6f6f"
                      if finding == "ruled_out" else "#946400")
    axis.axvline(about["threshold"], color="#333333", lw=1, ls=(0, (4, 3)))
    axis.annotate(f"chance exceeds this in {percent(about['alarm_level'])} of diagnoses", (about["threshold"], -0.62),
                  xytext=(4, 3), textcoords="offset points", size=8, color="#333333", va="bottom")
    axis.set_yticks(range(len(shown)), [elided(score["effect"], 44) for score in shown])
    for tick, score in zip(axis.get_yticklabels(), shown):
        tick.set_fontweight("bold" if score["finding"] in ("cause", "unknown_term") else "normal")
    axis.tick_params(axis="y", length=0)
    axis.set_ylim(len(shown) - 0.4, -1.3)
    axis.set_xscale("function", functions=(lambda x: np.sqrt(np.maximum(x, 0)), np.square))
    axis.set_xlim(0, top)
    ticks = [value for value in (1, 2, 3, 5, 10, 20, 30, 50, 100, 200, 500) if value < top]
    axis.set_xticks(ticks, [str(tick) for tick in ticks])
    axis.grid(axis="y", visible=False)
    axis.spines[["left"]].set_visible(False)
    axis.set_xlabel("standard deviations (square-root scale); hatched: a free curve at that place, no known law")
    above = sum(score["family_p_value"] <= about["alarm_level"] for score in judged)
    named = f"; {'one is the cause' if len(causes) == 1 else f'{len(causes)} are causes'}" if causes else ""
    headline(figure, f"{above} of {len(judged)} resemble the error more than chance would{named}" if above else
             f"None of {len(judged)} resembles the error more than chance would")
    plt.show()

# %% every effect
def detectable(score):
    if not np.isfinite(score["smallest_detectable"]):
        return "–"
    name = score["detectable_parameter"]
    name = "" if name == score["effect"] else f" <small>{escape(name)}</small>"
    return f"{number(score['smallest_detectable'], 2)} {escape(pretty(score['detectable_unit']))}{name}"


if judged:
    rows = [[f'<span style="color:{COLOURS[score["finding"]]}">■</span> {escape(score["effect"])}'
             + (f"<br><small>at {escape(score['probe'])}</small>" if score["probe"] else ""), escape(score["level"]),
             LABELS[score["finding"]], f">{number(strength(score), 2)}", f">{chance(score['family_p_value'])}",
             f">{number(score['delta_lr'])}", f">{number(score['delta_bic'])}", f">{detectable(score)}"]
            for score in judged]
    heads = ["Effect", "Level", "Finding", ">Strength", ">Chance, whole list", ">ΔLR", ">ΔBIC", ">Noticed above (95 %)"]
    opened = " open" if about["verdict"] == "adequate" else ""  # how small an effect would have been noticed is the finding
    display(HTML(f"<details{opened}><summary>all {len(judged)} as a table</summary>{table(heads, rows)}</details>"))
unjudged = {}
for score in scores:
    if not score["judged"]:
        unjudged.setdefault(score["why_not"] or "not judged", []).append(score["effect"])
notes = [f"Not judged: {', '.join(names)}: {why}." for why, names in unjudged.items()]
notes += [f"Withdrawn: {row['effect']}: {row['reason']}." for row in rows_of("withdrawn")]
if notes:
    display(HTML(items(notes, "notes")))

# %% causes
parameters_of = {}
for path in ("cause_parameters", "alternative_parameters"):
    for row in rows_of(path):
        parameters_of.setdefault(row["effect"], []).append(row)


def sizes(effect):
    return "<br>".join(f'{breakable(p["name"])} = <span class="together"><b>{number(p["value"])}</b> {escape(pretty(p["unit"]))}'
                       + (f" <small>95 %: {number(p['ci95_lower'])} … {number(p['ci95_upper'])}</small>"
                          if np.isfinite(p["ci95_upper"] - p["ci95_lower"]) else "") + "</span>"
                       for p in parameters_of.get(effect, []))


def effect_cell(row, finding):
    return f'<b style="color:{COLOURS[finding]}">{escape(row["effect"])}</b> <small>{escape(row["level"])}</small>' \
           f'<br><small>{escape(row["sentence"])}</small>'


rows = []
for cause in causes:
    rows.append([effect_cell(cause, "cause"), sizes(cause["effect"]),
                 f"{chance(cause['p_value'])}, ΔBIC {number(cause['delta_bic'])}; {number(cause['size'], 2)} times the "
                 "smallest size that a test of this effect alone would detect" if np.isfinite(cause["p_value"]) else
                 "chosen by cross-validation: see the text"])
    for other in rows_of("alternatives"):
        if other["instead_of"] != cause["effect"]:
            continue
        apart = f"fits worse by ΔLR {number(other['delta_lr'], 2)}" if other["delta_lr"] >= 0 else \
            f"fits better by ΔLR {number(-other['delta_lr'], 2)}"
        apart += f"; effects on the data correlate {other['correlation']:.3f}".replace("-", "−")
        if other.get("contains_cause"):
            apart += "<br>a more general law that contains the cause and is not needed"
        if other["separated_by"]:
            apart += f"<br><b>To distinguish them:</b> {escape(other['separated_by'])}"
        rows.append([f'<span class="indent">or {effect_cell(other, "alternative")}</span>', sizes(other["effect"]), apart])
if rows:
    display(HTML("<h3>The causes, and what these data do not distinguish from them</h3>"
                 + table(["Effect", "Size", "How sure"], rows, "causes")))

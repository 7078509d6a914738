# %% title [markdown]
# # {{TITLE}}

# %% include look

# %% the study file
# The path counts from the folder of this notebook. Point it at another study and run all cells again.
STUDY_FILE = "{{RUN_FILE}}"

study = h5py.File(STUDY_FILE, "r")
info = dict(study["/study"].attrs)
runs = {key: text_list(node) if h5py.check_string_dtype(node.dtype) else node[()]
        for key, node in study["/study/runs"].items()}
parameter_names = text_list(study["/study/parameters/name"])
solvers = list(dict.fromkeys(runs["solver"]))
of = {solver: np.array([name == solver for name in runs["solver"]]) for solver in solvers}  # which runs are whose
success = runs["success"] > 0.5
target = float(info["target"]) if isinstance(info["target"], (int, float, np.number)) else np.nan
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#B08900", "#56B4E9", "#444444"]
MARKS = dict(zip(solvers, PALETTE * len(solvers)))


def median(values):
    """Median of the known values; NaN if none is known."""
    values = values[np.isfinite(values)]
    return np.median(values) if values.size else np.nan


def whole(count):
    """A median of counts, as a count."""
    return f"{count:.0f}" if count < 1e4 else number(count)  # "–" if there is none


# %% findings
effort = {s: np.nan_to_num(median(runs["evaluations_to_target"][of[s]]), nan=np.inf) for s in solvers}
ranked = sorted(solvers, key=lambda solver: (-success[of[solver]].mean(), effort[solver]))
findings = []
for solver in ranked:
    mine = of[solver]
    reached, total = success[mine].sum(), mine.sum()
    if reached:
        findings.append(f"{solver} reached the target in {reached} of {total} runs, typically after "
                        f"{whole(median(runs['evaluations_to_target'][mine]))} evaluations and "
                        f"{duration(median(runs['seconds_to_target'][mine]))}.")
    else:
        known = runs["cost"][mine][np.isfinite(runs["cost"][mine])]
        best = f"its best cost is {number(known.min(), 4)}" if known.size else "none of them gave a cost"
        findings.append(f"{solver} never reached the target in {total} run{'s' if total > 1 else ''}; {best}.")
display(HTML(f'<p class="provenance">problem {escape(str(info["problem"]))} · {len(solvers)} solvers · '
             f"{len(success)} runs · target cost {number(target, 4)}</p>"))
if not info.get("finished", 1):  # it limits everything below
    display(HTML(items(["This comparison has not finished: what follows are the runs that had ended."], "warnings")))
display(HTML(items(findings, "findings")))

# %% table [markdown]
# ## Solvers side by side

# %% table
rows = []
for solver in ranked:
    mine, cost = of[solver], runs["cost"][of[solver]]
    entries = [f"{success[mine].sum()} of {mine.sum()}", whole(median(runs["evaluations_to_target"][mine])),
               duration(median(runs["seconds_to_target"][mine])), whole(median(runs["evaluations"][mine])),
               duration(median(runs["seconds"][mine])), number(np.nanmin(cost), 4),
               number(median(cost), 4), number(np.nanmax(cost), 4)]
    rows.append(f"<tr><td><b>{escape(solver)}</b></td>"
                + "".join(f'<td class="value">{entry}</td>' for entry in entries) + "</tr>")
heads = ("evaluations", "time", "evaluations", "time", "best", "median", "worst")
display(HTML('<table><thead><tr><th rowspan="2">Solver</th><th rowspan="2" class="value">Reached<br>the target</th>'
             '<th colspan="2" class="value">To the target (median)</th>'
             '<th colspan="2" class="value">Until it stopped (median)</th><th colspan="3" class="value">Final cost</th>'
             "</tr><tr>" + "".join(f'<th class="value">{head}</th>' for head in heads)
             + f"</tr></thead><tbody>{''.join(rows)}</tbody></table>"))

# %% cost
def strip(axis, values, missing=""):
    """One row per solver, one point per run; hollow where the target was not reached; a bar at the median."""
    for row, solver in enumerate(ranked):
        mine = of[solver] & np.isfinite(values)
        offset = 0.22 * spread(mine.sum())
        hit = success[mine]
        axis.plot(values[mine][hit], row + offset[hit], "o", ms=5, color=MARKS[solver], alpha=0.75, mew=0)
        axis.plot(values[mine][~hit], row + offset[~hit], "o", ms=4.5, color=MARKS[solver], mfc="white", mew=1.1)
        axis.plot([median(values[of[solver]])] * 2, [row - 0.36, row + 0.36], color="#333333", lw=1.6)
        lost = (of[solver] & ~np.isfinite(values)).sum()
        if lost and missing:
            axis.text(1.01, row, f"{lost} {missing}", transform=axis.get_yaxis_transform(), va="center", size=8,
                      color="#777777")
    axis.set_yticks(range(len(ranked)), ranked)
    axis.set_ylim(len(ranked) - 0.5, -0.5)
    axis.tick_params(axis="y", length=0)
    axis.grid(axis="y", visible=False)


known = runs["cost"][np.isfinite(runs["cost"])]
figure, axis = plt.subplots(figsize=(WIDTH, 1.2 + 0.5 * len(solvers)))
strip(axis, runs["cost"], "failed")
if known.size and known.min() > 0 and known.max() > 10 * known.min():
    by_decades(axis, "x")
if np.isfinite(target):
    axis.axvline(target, color="#999999", lw=1, ls="--", zorder=0)
    axis.text(target, 1.0, " target", transform=axis.get_xaxis_transform(), va="bottom", size=8, color="#666666")
axis.set_xlabel("final cost, one point per run (hollow: target not reached; bar: median)")
sure = [solver for solver in ranked if success[of[solver]].all()]
headline(figure, f"{', '.join(sure)}: every run reached the target" if sure
         else "No solver reached the target in every run")
plt.show()

# %% evaluations to target
if np.isfinite(runs["evaluations_to_target"]).any():
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 1.3 + 0.5 * len(solvers)), sharey=True)
    for axis, key, label in zip(axes, ("evaluations_to_target", "seconds_to_target"),
                                ("evaluations until the target", "seconds until the target")):
        strip(axis, runs[key], "never" if axis is axes[1] else "")
        reached = runs[key][np.isfinite(runs[key])]
        if reached.size and reached.min() > 0 and reached.max() > 10 * reached.min():
            by_decades(axis, "x")
        axis.set_xlabel(label)
    quickest = min(effort, key=effort.get)
    headline(figure, f"{quickest} needs the fewest evaluations where it succeeds (median {whole(effort[quickest])})")
    plt.show()

# %% parameters [markdown]
# ## Do they agree on the parameters?
#
# Runs that reach the same cost with different values show that the data do not determine the parameter.

# %% parameters
heads = "".join(f'<th class="value">{escape(name)}</th>' for name in parameter_names)
rows = []
for solver in ranked:
    good = runs["values"][of[solver] & success]
    if len(good):
        entries = "".join(f'<td class="value">{number(np.median(column))}<br>'
                          f"<small>{number(column.min())} … {number(column.max())}</small></td>" for column in good.T)
    else:
        entries = f'<td colspan="{len(parameter_names)}" class="pale">no run reached the target</td>'
    rows.append(f"<tr><td><b>{escape(solver)}</b><br><small>{len(good)} runs</small></td>{entries}</tr>")
display(HTML("<p>Median and range over the runs that reached the target.</p>"
             f"<table><thead><tr><th>Solver</th>{heads}</tr></thead><tbody>{''.join(rows)}</tbody></table>"))

good = runs["values"][success]
if len(good) > 1:
    columns = min(3, len(parameter_names))
    count = -(-len(parameter_names) // columns)
    height = 0.7 + count * (0.8 + 0.25 * len(solvers))
    figure, axes = plt.subplots(count, columns, figsize=(WIDTH, height), squeeze=False)
    for n, (axis, name) in enumerate(zip(axes.flat, parameter_names)):
        strip(axis, np.where(success, runs["values"][:, n], np.nan))
        axis.set_title(name)
        reached = runs["values"][success, n]
        if 0 < np.ptp(reached) < 0.01 * abs(np.median(reached)):  # a scatter too small to compare solvers by
            axis.set_xlim(sorted(np.median(reached) * np.array([0.99, 1.01])))
        axis.locator_params(axis="x", nbins=4)
        axis.ticklabel_format(axis="x", scilimits=(-3, 4))
        if n % columns:
            axis.set_yticklabels([])
    for axis in axes.flat[len(parameter_names):]:
        axis.remove()
    middle = np.abs(np.median(good, axis=0))
    scatter = np.ptp(good, axis=0) / np.where(middle > 0, middle, 1)
    loose = [name for name, ratio in zip(parameter_names, scatter) if ratio > 0.2]
    headline(figure, (f"Same cost, different values: {', '.join(loose)}" if loose else
                     "All runs that reached the target agree on the parameters (within 20 %)"))
    plt.show()

# %% title [markdown]
# # {{TITLE}}

# %% include look

# %% the run files
from urllib.parse import quote

# Paths count from the folder of this notebook.
RUN_FILES = {{RUN_FILES}}
STUDY_FILES = {{STUDY_FILES}}
DIAGNOSIS_FILES = {{DIAGNOSIS_FILES}}

runs = {name: h5py.File(path, "r") for name, path in RUN_FILES.items()}
studies = {name: h5py.File(path, "r") for name, path in STUDY_FILES.items()}
diagnoses = {name: h5py.File(path, "r") for name, path in DIAGNOSIS_FILES.items()}
about = {name: dict(run["/run"].attrs) for name, run in runs.items()}


def link(name):
    return f'<a href="{quote(name)}.html"><b>{escape(name)}</b></a>'


# %% findings
cards = []
for name, run in runs.items():
    findings = text_list(run["/run/findings"])[:3] if "/run/findings" in run else []
    doubts = [] if about[name]["finished"] else ["This run has not finished."]
    doubts += [] if about[name]["usable"] else ["The answer of this run is not usable."]
    cards.append(f'<h3>{link(name)} <small>{escape(about[name]["title"] or about[name]["data_file"])}</small></h3>'
                 + (items(doubts, "warnings") if doubts else "") + items(findings, "findings"))
for name, file in diagnoses.items():
    columns = [text_list(file[f"/diagnosis/{name}"]) if f"/diagnosis/{name}" in file else []
               for name in ("sentences", "sentence_kinds")]
    leading = columns[0][:3] + [text for text, kind in list(zip(*columns))[3:] if kind == "gain"]  # the gain is what counts
    title = file["/run"].attrs["title"] or file["/run"].attrs["data_file"]
    cards.append(f"<h3>{link(name)} <small>diagnosis of {escape(str(title))}</small></h3>" + items(leading, "findings"))
for name, study in studies.items():
    solvers, success = np.array(text_list(study["/study/runs/solver"])), study["/study/runs/success"][:]
    shares = [f"{solver} reached the target in {int(success[mine].sum())} of {mine.sum()} runs."
              for solver, mine in ((solver, solvers == solver) for solver in dict.fromkeys(solvers))]
    cards.append(f'<h3>{link(name)} <small>comparison of solvers on {escape(str(study["/study"].attrs["problem"]))}'
                 "</small></h3>" + ("" if study["/study"].attrs.get("finished", 1) else
                                    items(["This comparison has not finished."], "warnings")) + items(shares, "findings"))
display(HTML("".join(cards)))

# %% runs [markdown]
# ## The runs side by side

# %% runs
if runs:
    rows = []
    for name, info in about.items():
        state = "usable" if info["usable"] else "not usable"
        state += "" if info["finished"] else ", unfinished"
        words = (escape(info["problem"]), escape(info["solver"]))
        values = (info["seed"], number(info["cost"], 4), info["evaluations"], duration(info["seconds"]))
        rows.append(f"<tr><td>{link(name)}</td>" + "".join(f"<td>{word}</td>" for word in words)
                    + "".join(f'<td class="value">{value}</td>' for value in values) + f"<td>{state}</td></tr>")
    heads = "".join(f'<th class="value">{head}</th>' for head in ("Seed", "Cost", "Evaluations", "Time"))
    display(HTML(f"<table><thead><tr><th>Run</th><th>Problem</th><th>Solver</th>{heads}<th>State</th></tr></thead>"
                 f"<tbody>{''.join(rows)}</tbody></table>"))
    if len({(info["data_hash"], info["objective"]) for info in about.values()}) > 1:
        display(HTML(items(["The runs differ in data or objective: their costs cannot be compared."], "notes")))

# %% parameters
found = {}  # (parameter, unit) -> {run: (value, lower end, upper end, verdict)}
for run_name, run in runs.items():
    table = run["/parameters"]
    judged = {}
    if "/uncertainty/name" in run:
        about_them = run["/uncertainty"]
        judged = {name: row for name, *row in zip(text_list(about_them["name"]), about_them["ci95_lower"][:],
                                                  about_them["ci95_upper"][:], text_list(about_them["verdict"]))}
    for name, unit, kind, is_free, value in zip(text_list(table["name"]), text_list(table["unit"]),
                                                text_list(table["kind"]), table["free"][:], table["value"][:]):
        if is_free and kind != "nuisance":
            found.setdefault((name, pretty(unit)), {})[run_name] = (value, *judged.get(name, (np.nan, np.nan, "")))

shown = list(found)[:24]
if shown:
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, 0.6 + rows * (0.75 + 0.22 * len(runs))), squeeze=False)
    for n, (axis, key) in enumerate(zip(axes.flat, shown)):
        for row, run_name in enumerate(runs):
            value, low, high, verdict = found[key].get(run_name, (np.nan, np.nan, np.nan, ""))
            unknown = verdict == "not_identifiable"
            if not unknown:
                axis.plot([low, high], [row, row], color=TRAIN, lw=4, alpha=0.35)
            axis.plot(value, row, "o", ms=5.5, color=GREY if unknown else TRAIN, mfc="white" if unknown else TRAIN)
        axis.set_title(f"{key[0]} ({key[1]})" if key[1] else key[0])
        axis.set_yticks(range(len(runs)), list(runs) if n % columns == 0 else [""] * len(runs))
        axis.set_ylim(len(runs) - 0.5, -0.5)
        axis.tick_params(axis="y", length=0)
        axis.locator_params(axis="x", nbins=4)
        axis.ticklabel_format(axis="x", scilimits=(-3, 4))
    for axis in axes.flat[len(shown):]:
        axis.remove()
    apart = [name for (name, _), entries in found.items()  # the highest lower end lies above the lowest upper end
             if np.nanmax([e[1] for e in entries.values()] + [-np.inf])
             > np.nanmin([e[2] for e in entries.values()] + [np.inf])]
    finding = "The runs agree within their 95 % intervals" if len(runs) > 1 else "Parameters and their 95 % intervals"
    one_data_set = len({about[name]["data_hash"] for name in runs}) == 1
    verb = "The runs disagree on" if one_data_set else "The data sets differ in"
    headline(figure, (f"{verb} {', '.join(apart)}" if apart else finding)
             + (f"  ({len(shown)} of {len(found)} parameters shown)" if len(shown) < len(found) else ""))
    figure.supxlabel("Thick: 95 % interval.  Hollow: the data do not determine it.", size=8, color="#666666", x=0.0,
                     ha="left")
    plt.show()

# %% fit
errors = {}  # (quantity, unit) -> {run: {role: [(rmse, n)]}}
for run_name, run in runs.items():
    for channels in run["/prediction"].values() if "/prediction" in run else ():
        for channel, node in channels.items():
            role, n, rmse = (node.attrs[key] for key in ("role", "n", "rmse"))
            if role != "predicted" and n > 0 and np.isfinite(rmse):
                errors.setdefault((node.attrs["quantity"] or channel, pretty(node.attrs["unit"])), {}) \
                      .setdefault(run_name, {}).setdefault(role, []).append((rmse, n))

if errors:
    head = "".join(f'<th class="value">{escape(quantity + (f" ({unit})" if unit else ""))}'
                   "<br><small>fitted / held-out trials</small></th>"
                   for quantity, unit in errors)
    rows = ""
    for run_name in runs:
        rows += f"<tr><td>{link(run_name)}</td>"
        for of_quantity in errors.values():
            both = []
            for role in ("train", "validate"):
                known = of_quantity.get(run_name, {}).get(role, [])
                both.append(number(np.sqrt(np.average([r * r for r, _ in known], weights=[n for _, n in known])))
                            if known else "–")
            rows += f'<td class="value">{" / ".join(both)}</td>'
        rows += "</tr>"
    display(HTML("<h3>Error of the simulation (RMSE over all trials)</h3>"
                 f"<table><thead><tr><th>Run</th>{head}</tr></thead><tbody>{rows}</tbody></table>"))

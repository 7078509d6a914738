# %% parameters [markdown]
# ## Parameters
#
# Without a cause of the error in the model, its parameters are biased: they fit part of the effect.

# %% parameters
described = table_of("/parameters")
effect_parameters = {name for name, p in described.items() if p["kind"] == "effect"}
base = {row["name"]: row for row in rows_of("base_parameters")}
after = {row["name"]: row for row in rows_of("extended_parameters")}


def value_cell(row):
    """Value and interval; pale without one."""
    if row is None:
        return ">–"
    if not np.isfinite(row["std_error"]):
        return f'><span class="pale">{number(row["value"])}</span>'
    return f">{number(row['value'])} <small>± {number(1.96 * row['std_error'], 2)}</small>"


def shift_cell(name):
    """Bias of a base parameter without the causes, in percent of its value with them; bold where it is beyond chance and 0.5 %."""
    if name not in base or name not in after or not causes:
        return ""
    change = base[name]["value"] - after[name]["value"]
    if not np.isfinite(after[name]["std_error"]):
        return '<span class="pale">not determined by these data</span>'
    if change == 0 or after[name]["value"] == 0:
        return "no bias" if change == 0 else f"bias {number(change)}"
    text = f"bias {100 * change / abs(after[name]['value']):+.1f} %".replace("-", "−")
    return f"<b>{text}</b>" if abs(change) > max(1.96 * after[name]["std_error"], 0.005 * abs(
        after[name]["value"])) else f'<span class="pale">{text}</span>'


rows = []
for name in dict.fromkeys([*base, *after]):
    row = after.get(name) or base[name]
    meaning = described.get(name, {}).get("meaning", "")
    mark = f' style="color:{COLOURS["cause"]}"' if name in effect_parameters and name in after else ""
    label = f"<b{mark}>{escape(name)}</b>" + (f"<br><small>{escape(meaning)}</small>" if meaning else "")
    start = value_cell(base[name]) if name in base else f'><span class="pale">{number(row["before"])} (null)</span>'
    rows.append([label, start] + [value_cell(after.get(name))] * bool(causes) + [escape(pretty(row["unit"]))]
                + [shift_cell(name)] * bool(causes))
heads = ["Parameter", ">Base model"] + [">Extended model"] * bool(causes) + ["Unit"] + ["Bias of the base model"] * bool(causes)
display(HTML(table(heads, rows, "parameters")))
display(HTML(items(["± is half the 95 % interval; pale: not determined by these data; bold: a bias larger than its 95 % interval. The model can be used at once: "
                    f"sinew simulate {info['problem']} --data {info['data_file']} --from {RUN_FILE} --out simulated.h5"],
                   "notes")))

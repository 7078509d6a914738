# %% parameters [markdown]
# ## Parameters

# %% parameters
from collections import Counter

LABELS = {"identifiable": ("●", "identifiable", "#007A5A"), "weak": ("◆", "weak", "#B36B00"),
        "not_identifiable": ("○", "not identifiable", "#6f6f6f"), "at_bound": ("■", "at bound", "#A8467F"),
        "": ("·", "free, not judged", "#6f6f6f")}

parameters = table_of("/parameters")
for name, known in table_of("/uncertainty").items():
    parameters.get(name, {}).update(known)
free = {name: p for name, p in parameters.items() if p["free"]}
shown = {name: p for name, p in free.items() if p["kind"] != "nuisance"}  # offsets of a trial are no findings


def value_text(p):
    """Value and 95 % interval, with as many digits as the interval allows."""
    low, high = p.get("ci95_lower", np.nan), p.get("ci95_upper", np.nan)
    if p.get("verdict") == "not_identifiable" or not np.isfinite(high - low):
        return f'<span class="pale">{short(p["value"])}</span>', '<span class="pale">none</span>'
    half = (high - low) / 2
    digits = 3 if half <= 0 or p["value"] == 0 else int(np.clip(
        np.floor(np.log10(abs(p["value"]))) - np.floor(np.log10(half)) + 2, 3, 4))
    value = number(p["value"], digits)
    if abs(high + low - 2 * p["value"]) < 0.2 * half:  # centred on the value
        mantissa, _, exponent = value.partition("e")
        decimals = len(mantissa.partition(".")[2])
        if exponent and half >= 2 * 10.0 ** (int(exponent) - decimals):  # with the exponent of the value
            return value, f"± {half / 10.0 ** int(exponent):.{decimals}f}e{exponent}"
        return value, f"± {number(half, 2, power=bool(exponent))}"
    return value, f"{number(low, digits)} … {number(high, digits)}"


def remedies(group):
    """What would help the parameters of a group, each remedy once."""
    helped = {}  # (kind, remedy) -> names
    for name, p in group.items():
        helped.setdefault((p.get("remedy_kind", ""), p.get("remedy", "")), []).append(name)
    lines = ""
    for (kind, remedy), names in helped.items():
        whom = "" if len(helped) == 1 else f" {', '.join(names)}"
        if kind == "no_channel":  # there is none
            lines += f'<br>{f"<b>{escape(whom.strip())}:</b> " if whom else ""}{escape(tidy(remedy))}'
        elif remedy:
            lines += f"<br><b>Would help{escape(whom)}:</b> {escape(tidy(remedy))}"
    return lines


def parameter_rows(some):
    """A row per parameter; neighbours with the same reason share its cell."""
    groups = []  # (reason, {name: parameter})
    for name, p in some.items():
        reason = p.get("reason", "")
        if not groups or groups[-1][0] != reason:
            groups.append((reason, {}))
        groups[-1][1][name] = p
    rows = ""
    for reason, group in groups:
        cell = f'<td class="why" rowspan="{len(group)}">{escape(tidy(reason))}{remedies(group)}</td>'
        for name, p in group.items():
            value, interval = value_text(p)
            symbol, word, colour = LABELS[p.get("verdict", "")]
            rows += f'<tr><td class="name"><b>{escape(name)}</b><br><small>{escape(p["meaning"])}</small></td>' \
                    f'<td class="value">{value}</td><td class="value">{interval}</td>' \
                    f'<td>{escape(pretty(p["unit"]))}</td>' \
                    f'<td class="verdict" style="color:{colour}">{symbol} {word}</td>{cell}</tr>'
            cell = ""
    return rows


display(HTML('<table class="parameters"><thead><tr><th>Parameter</th><th class="value">Value</th>'
             '<th class="value">95&nbsp;%&nbsp;interval</th><th>Unit</th><th>Verdict</th><th>Reason</th></tr></thead>'
             f"<tbody>{parameter_rows(shown)}</tbody></table>"))

notes = [f"Not determined by the data: {text}" for text in texts("/uncertainty/directions")]
fixed = [f"{name} = {short(p['value'])} {pretty(p['unit'])}".strip() for name, p in parameters.items()
         if not p["free"] and p["kind"] == "base"]
if fixed:
    notes.append("Held fixed: " + ", ".join(fixed) + ".")
resting = len([p for p in parameters.values() if not p["free"] and p["kind"] == "effect"])
if resting:
    notes.append(f"{resting} parameter{'s' if resting > 1 else ''} of effects that were not released: held at "
                 f"{'their null values' if resting > 1 else 'its null value'}, without influence.")
nuisance = Counter(p["meaning"] for p in free.values() if p["kind"] == "nuisance")
if nuisance:
    kinds = "; ".join(f"{count} × {meaning}" for meaning, count in nuisance.most_common(4))
    others = sum(nuisance.values()) - sum(count for _, count in nuisance.most_common(4))
    notes.append("Nuisance parameters, fitted as well (in /parameters): " + kinds + (f"; {others} others" if others else "") + ".")
if notes:
    display(HTML(items(notes, "notes")))

# %% parameters within their bounds
MARK = {"identifiable": "o", "weak": "D", "not_identifiable": "o", "at_bound": "s", "": "o"}


def place(p, value):
    """Where a value lies between the bounds, 0..1; by ratio where the parameter is searched by ratio."""
    scale = np.log if p["scale"] == "log" else np.asarray
    return (scale(value) - scale(p["lower"])) / (scale(p["upper"]) - scale(p["lower"]))


if shown:
    figure, axis = plt.subplots(figsize=(WIDTH, 0.8 + 0.42 * len(shown)))
    for row, (name, p) in enumerate(shown.items()):
        verdict = p.get("verdict", "")
        unknown = verdict == "not_identifiable"
        colour = LABELS[verdict][2]
        axis.barh(row, 1, height=0.34, color="#f2f2f2" if not unknown else "white", lw=0.6,
                  edgecolor="#dddddd" if not unknown else "#bbbbbb", hatch="////" if unknown else None, zorder=1)
        axis.plot(place(p, p["start"]), row, "|", ms=11, color="#777777", mew=1, zorder=2)
        ends = [place(p, np.clip(p.get(key, np.nan), p["lower"], p["upper"])) for key in ("ci95_lower", "ci95_upper")]
        if np.isfinite(ends).all() and not unknown:
            axis.plot(ends, [row, row], color=colour, lw=5, alpha=0.45, zorder=3)
        axis.plot(place(p, p["value"]), row, MARK[verdict], ms=7, mew=1.5, zorder=4,
                  color=colour, mfc="white" if unknown else colour, clip_on=False)
        for x, bound, side in ((-0.026, p["lower"], "right"), (1.026, p["upper"], "left")):
            axis.text(x, row, short(bound), ha=side, va="center", color="#777777", size=8)
        axis.text(1.12, row, f"{number(p['value'])} {pretty(p['unit'])}" if not unknown else "not determined",
                  va="center", color=colour)
    axis.set_yticks(range(len(shown)), list(shown))
    axis.tick_params(axis="y", length=0, pad=42)
    axis.set_ylim(len(shown) - 0.4, -0.6)
    axis.set_xlim(0, 1.32)
    axis.set_xticks([])
    axis.grid(False)
    axis.spines[:].set_visible(False)
    judged = [p for p in shown.values() if p.get("verdict")]
    sure = sum(p["verdict"] == "identifiable" for p in judged)
    verb = "is" if sure == 1 else "are"
    headline(figure, f"{sure} of {len(judged)} parameters {verb} determined by the data" if judged else
             "Where the parameters lie between their bounds")
    figure.supxlabel("From lower to upper bound (logarithmic where it is searched so).  Thin line: start.  "
                     "Thick: 95 % interval.  Hatched: any value fits the data.", size=8, color="#666666",
                     x=0.0, ha="left")
    plt.show()

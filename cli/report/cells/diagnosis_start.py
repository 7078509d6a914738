# %% title [markdown]
# # {{TITLE}}

# %% include look

# %% include run_open

# %% verdict
diagnosis = run["/diagnosis"]
about = {key: value.decode() if isinstance(value, bytes) else value for key, value in diagnosis.attrs.items()}
COLOURS = {"cause": "#D55E00", "alternative": "#E69F00", "withdrawn": "#A8467F", "unknown_term": "#007A5A",
           "ruled_out": "#b4bac1", "not_judged": "#b4bac1"}
LABELS = {"cause": "cause", "alternative": "could also be", "withdrawn": "withdrawn",
        "unknown_term": "discrepancy term", "ruled_out": "ruled out", "not_judged": "not judged"}
VERDICTS = {"adequate": ("Adequate", "no misfit beyond chance", "#007A5A"),
            "explained": ("Explained", "each misfit that was found has one named cause", "#0072B2"),
            "ambiguous": ("Ambiguous", "a stated set of causes that these data do not distinguish", "#B36B00"),
            "unexplained": ("Unexplained", "a misfit beyond chance that no known effect explains", "#A8467F")}


def rows_of(path):
    """The rows of a table of the diagnosis, as a list of {column: entry}."""
    if path not in diagnosis:
        return []
    columns = {key: text_list(node) if h5py.check_string_dtype(node.dtype) else node[()]
               for key, node in diagnosis[path].items()}
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def chance(p):
    """A p-value as a person writes it."""
    return "p < 0.001" if p < 0.001 else f"p = {number(p, 2)}"


def percent(share, digits=0):
    """0.87 -> 87 %; with the sign typeset."""
    return f"{round(100 * share, digits) + 0.0:.{digits}f} %".replace("-", "−") if np.isfinite(share) else "–"


def breakable(name):
    """A long name that may go on in the next line after a dot or an underscore."""
    return re.sub(r"([._@(])", r"\1<wbr>", escape(name))


def table(heads, rows, kind=""):
    """A table on the page; heads and cells that begin with > stand right. Cells are HTML."""
    def cell(tag, text):
        right = ' class="value"' if text.startswith(">") else ""
        return f"<{tag}{right}>{text[1:] if right else text}</{tag}>"
    body = "".join("<tr>" + "".join(cell("td", text) for text in row) + "</tr>" for row in rows)
    return f'<table class="{kind}"><thead><tr>{"".join(cell("th", head) for head in heads)}</tr></thead>' \
           f"<tbody>{body}</tbody></table>"


display(HTML('<p class="provenance">' + " · ".join(escape(text) for text in [
    "synthetic data" if info["synthetic"] else "measured data", f"problem {info['problem']}", f"seed {info['seed']}",
    f"sinew {info['version']}", f"diagnosed in {duration(info['seconds'])}"]) + "</p>"))

extended = "unknown_terms" in diagnosis or (
    "parameters" in run and not np.array_equal(run["/parameters/before"], run["/parameters/value"]))
concluded = info["finished"] and info["converged"] and info.get("usable", 1)
word, meaning, colour = VERDICTS[about["verdict"]] if concluded else \
    ("No conclusion", "the diagnosis was interrupted" if not info["finished"] else "the base model was not fitted"
     if not info["converged"] else "the noise is too large to name a cause", "#6f6f6f")
if concluded and about["verdict"] == "unexplained" and rows_of("causes"):
    meaning = "known effects explain only a part of the misfit"
if concluded and about.get("wanders"):
    meaning = "the residual is strongly autocorrelated, and no known effect explains it"
display(HTML(f'<p class="verdict" style="background:{colour}"><b>{word}</b> {escape(meaning)}</p>'))

scores = sorted(rows_of("scores"), key=lambda score: -score["statistic"])
causes, gains, noise = rows_of("causes"), rows_of("gain"), rows_of("noise")
cards = []
if concluded:
    cards.append(("chance of such an alarm without any misfit", chance(about["family_p_value"])))
    if causes:
        cards.append(("cause" if len(causes) == 1 else f"{len(causes)} causes", "".join(
            f"<small>{breakable(cause['effect'])}</small>" for cause in causes[:4])))
    if gains and (causes or "unknown_terms" in diagnosis):
        gain = gains[0]
        cards.append((f"error on held-out trials, {escape(gain['channel'])}<br>95 % interval "
                      f"{percent(-gain['ci95_upper'])} to {percent(-gain['ci95_lower'])}", percent(-gain["reduction"])))
        if np.isfinite(gain["gap_closed"]):
            cards.append(("of the error above the noise floor removed", percent(gain["gap_closed"])))
    judged = sum(score["judged"] > 0 and score["known"] > 0 for score in scores)
    cards.append((f"known effects judged{f', {len(scores) - judged} other' if not causes else ''}", str(judged)))
if cards:
    display(HTML('<div class="cards">' + "".join(
        f'<div class="card"><b>{value}</b><span>{label}</span></div>' for label, value in cards) + "</div>"))

# %% findings
sentences = texts("/diagnosis/sentences") or ["This diagnosis has no findings."]
kinds = texts("/diagnosis/sentence_kinds") or [""] * len(sentences)  # files of earlier versions have none
display(HTML('<ul class="findings">' + "".join(
    f'<li{" class=minor" if kind in ("alternative", "more_general_law") else ""}>{escape(tidy(text))}</li>'
    for kind, text in zip(kinds, sentences)) + "</ul>"))
if texts("/diagnosis/warnings"):
    display(HTML(items(texts("/diagnosis/warnings"), "warnings")))

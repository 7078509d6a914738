# %% setup
# Libraries, the look of the figures, and how numbers are written for people.
import re
import textwrap
from html import escape

import h5py
import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML, display
from matplotlib.ticker import LogLocator, NullFormatter
from matplotlib_inline.backend_inline import set_matplotlib_formats

set_matplotlib_formats("retina")
plt.style.use("default")
plt.rcParams.update({
    "figure.facecolor": "white", "figure.dpi": 100, "figure.constrained_layout.use": True,
    "font.size": 9, "axes.titlesize": 9, "axes.titlelocation": "left", "axes.labelcolor": "#444444",
    "figure.titlesize": 11, "figure.titleweight": "bold", "text.parse_math": False,
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#999999",
    "axes.axisbelow": True, "axes.grid": True, "grid.color": "#ececec", "grid.linewidth": 0.8,
    "xtick.color": "#999999", "ytick.color": "#999999", "xtick.labelcolor": "#444444", "ytick.labelcolor": "#444444",
    "savefig.pad_inches": 0.03, "legend.frameon": False, "lines.linewidth": 1.5, "lines.solid_capstyle": "round"})
TRAIN, VALIDATE, MEASURED, GREY = "#0072B2", "#D55E00", "#222222", "#8c8c8c"  # safe for colour-blind eyes
WIDTH = 9.6  # inches, of every figure


def text_list(node):
    """The texts of a dataset as a list of str."""
    return [str(text) for text in np.atleast_1d(node.asstr()[()])]


def number(value, digits=3, power=False):
    """A number as a person writes it: 106, 0.0123, 8.97e5; with power also 1.1e4."""
    if not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    if -4 < int(exponent) < 5 and not power:
        return f"{value:.{max(digits - 1 - int(exponent), 0)}f}".replace("-", "−")
    return f"{mantissa.replace('-', '−')}e{int(exponent)}"


def coefficient(value):
    """R² with a proper minus: 0.998, −20.0."""
    return f"{value:.3f}".replace("-", "−") if value > -1 else number(value)


def short(value):
    """A number somebody chose, without padding: 0.01, 15, 1e6."""
    mantissa, _, exponent = f"{value:.4g}".partition("e")
    return mantissa.replace("-", "−") + (f"e{int(exponent)}" if exponent else "")


def pretty(unit):
    """N/m3 -> N/m³, N*m -> N·m; nothing for a number without unit."""
    if unit == "1":
        return ""
    return re.sub(r"(?<=[A-Za-z])[0-9]+", lambda n: n[0].translate(SUPERSCRIPT), unit.replace("*", "·"))


SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def tidy(text):
    """A sentence of the program, typeset: +- -> ±, -> -> →, -5 -> −5, N*m -> N·m, R2 -> R², 1.000000e-12 -> 1e-12."""
    text = re.sub(r"\bR2\b", "R²", text.replace("+-", "±").replace("->", "→").replace("<=", "≤"))
    text = re.sub(r"(?<![\w.)-])-(?=\d)", "−", text.replace(" .. ", " … ").replace(" %", "\u00a0%"))
    text = re.sub(r"(?<=[A-Za-z0-9])\*(?=[A-Za-z])", "·", text)
    text = re.sub(r"(?<=[/·]m)[234]\b", lambda power: power[0].translate(SUPERSCRIPT), text)
    return re.sub(r"\b\d\.\d{4,}e[+-]\d+", lambda value: short(float(value[0])), text)


def elided(text, most):
    """At most so many characters."""
    return text if len(text) <= most else text[:max(most - 1, 1)] + "…"


def duration(seconds):
    """0.003 -> 3 ms, 250 -> 4 min 10 s."""
    if not np.isfinite(seconds):
        return "–"
    if seconds < 1:
        return f"{number(seconds * 1e3, 2)} ms"
    if seconds < 60:
        return f"{number(seconds)} s"
    if seconds < 3600:
        return f"{int(seconds // 60)} min {int(seconds % 60)} s"
    return f"{int(seconds // 3600)} h {int(seconds % 3600 // 60)} min"


def headline(figure, text):
    """What the figure shows, in words, above it; returns the number of lines."""
    lines = textwrap.wrap(text, 100)
    figure.suptitle("\n".join(lines), x=0.0, ha="left")
    return len(lines)


def in_order(names):
    """trial_2 before trial_10."""
    return sorted(names, key=lambda name: [(not part.isdigit(), int(part) if part.isdigit() else 0, part)
                                           for part in re.split(r"([0-9]+)", name)])


def by_decades(axes, which):
    """A logarithmic "x" or "y" axis with plain labels; to be called when its limits are known."""
    axes.set(**{f"{which}scale": "log"})
    axis = getattr(axes, f"{which}axis")
    low, high = axis.get_view_interval()
    wide = high > 1e4 * low
    axis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 3.0)))
    axis.set_major_formatter(lambda value, _: number(value, 1, power=wide and not 1e-3 <= value < 1e4))
    axis.set_minor_formatter(NullFormatter())


def items(sentences, kind):
    """Sentences as a list on the page."""
    return f'<ul class="{kind}">' + "".join(f"<li>{escape(tidy(text))}</li>" for text in sentences) + "</ul>"


def long_list(sentences, kind, limit=15, told=5):
    """Sentences as a list; of more than `limit` the first few, and the rest when it is asked for."""
    if len(sentences) <= limit:
        return items(sentences, kind)
    rest = f"<details><summary>{len(sentences) - told} more</summary>{items(sentences[told:], kind)}</details>"
    return items(sentences[:told], kind) + rest


def color_key(entries):
    """What the colours of the figures below mean: [(colour, name)]."""
    return '<p class="key">' + "".join(f'<span><b style="color:{colour}">■</b> {name}</span>' for colour, name in entries) + "</p>"


def span(arrays):
    """Least and greatest known value of several arrays; never equal."""
    values = np.concatenate(arrays) if arrays else np.array([])
    values = values[np.isfinite(values)]
    low, high = (values.min(), values.max()) if values.size else (0.0, 0.0)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def draw_measured(axis, fit):
    """What was measured, in black: a line, or points where samples stand alone."""
    known = np.isfinite(fit["measured"])
    sparse = 2 * (known[1:] & known[:-1]).sum() < known.sum()  # single samples that no line would join
    axis.plot(fit["time"], fit["measured"], "." if sparse else "-", ms=3, lw=0.9, color=MEASURED, label="measured")


def spread(count):
    """Offsets in -1..1 that keep the points of a strip apart, the same at every run of the cell."""
    return np.modf(np.arange(1, count + 1) * 0.6180339887)[0] * 2 - 1

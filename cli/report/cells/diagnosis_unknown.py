# %% unknown [markdown]
# ## Not in the library
#
# Model discrepancy terms: they improve the fit and no known effect explains them. Where there are several, each is an alternative to the others; where
# causes were chosen by cross-validation, all of them are in the extended model.
# Band: 95 %; where it fills the figure, the base parameters compensate part of the curve, so that only its shape is known, not
# its height or slope.

# %% unknown
terms = [{**{key: value.decode() if isinstance(value, bytes) else value for key, value in node.attrs.items()},
          **{key: node[key][:] for key in ("knots", "curve", "deviation")}}
         for node in (run[f"/diagnosis/unknown_terms/{i}"] for i in children("/diagnosis/unknown_terms"))]
for term in terms:  # files of earlier versions know curves only
    term.setdefault("kind", "curve")
    term.setdefault("name", f"{term['port']}({term['signal']})")
shown = terms[:6]
columns = min(3, len(shown))
rows = -(-len(shown) // columns)
figure, axes = plt.subplots(rows, columns, figsize=(WIDTH if columns > 1 else 0.6 * WIDTH, 0.8 + 2.5 * rows), squeeze=False)
for axis, term in zip(axes.flat, shown):
    if term["kind"] != "drift":
        axis.axhline(0, color="#999999", lw=0.7)
    axis.fill_between(term["knots"], term["curve"] - 1.96 * term["deviation"], term["curve"] + 1.96 * term["deviation"],
                      color=COLOURS["unknown_term"], alpha=0.18, lw=0)
    axis.plot(term["knots"], term["curve"], "-o", ms=3, color=COLOURS["unknown_term"])
    known = term["curve"][np.isfinite(term["curve"])]
    reach = 3 * np.max(np.abs(known), initial=0)
    if term["kind"] != "drift" and reach > 0 and np.nanmax(term["deviation"], initial=0) > reach:
        axis.set_ylim(-reach, reach)  # else the curve is a line in the middle of its own uncertainty
    axis.set_title(f"{elided(term['shape'], 44)}" + (f"\nnearest known law: {elided(term['nearest_law'], 34)}"
                                                     if term["nearest_law"] else ""))
    axis.set_xlabel(f"{term['signal']} ({pretty(term['signal_unit'])})" if pretty(term["signal_unit"]) else term["signal"])
    axis.set_ylabel(f"{term['port']} ({pretty(term['unit'])})" if pretty(term["unit"]) else term["port"])
for axis in axes.flat[len(shown):]:
    axis.remove()
HEADLINES = {"curve": "{port} needs a function of {signal}", "drift": "{port} changes with time",
        "periodic": "a periodic term adds to {port}"}
together = any(np.isnan(term["p_value"]) for term in shown)
headline(figure, ("; " if together else "; or ").join(dict.fromkeys(HEADLINES[term["kind"]].format(**term) for term in shown)))
plt.show()


def reason(term):
    return "left-out data need it" if np.isnan(term["p_value"]) else chance(term["p_value"])


display(HTML(items([f"{term['name']}: {reason(term)}; held-out error "
                    f"{percent(-term['held_out_reduction'])}." for term in terms], "notes")))

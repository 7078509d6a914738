# %% fits
fits = []  # every channel of every trial
plates = {run[f"/details/contact/{trial}/{region}"].attrs["plate"]
          for trial in children("/details/contact") for region in children(f"/details/contact/{trial}")}


def place_of(channel):
    """Where a channel was measured, for people: right_force_y -> right plate; the channel if that is not known."""
    for plate in plates:
        if channel.startswith(f"{plate}_"):
            return plate if "plate" in plate.lower() else f"{plate} plate"
    return channel


for trial in children("/prediction"):
    for channel in children(f"/prediction/{trial}"):
        node, residual = run[f"/prediction/{trial}/{channel}"], run.get(f"/residual/{trial}/{channel}", {})
        fits.append({"trial": trial, "place": place_of(channel), "quantity": node.attrs["quantity"] or channel,
                     "unit": pretty(node.attrs["unit"]), "role": node.attrs["role"],
                     "n": node.attrs["n"], "rmse": node.attrs["rmse"], "r2": node.attrs["r2"],
                     "time": node["time"][:], "simulated": node["simulated"][:], "measured": node["measured"][:],
                     "band": node["band95_half_width"][:] if "band95_half_width" in node else None,
                     "residual_time": residual["time"][:] if residual else np.array([]),
                     "residual": residual["residual"][:] if residual else np.array([])})


held_out = {fit["trial"] for fit in fits if fit["role"] == "validate"}
fits.sort(key=lambda fit: fit["trial"] in held_out)  # fitted trials first, everywhere


def by_quantity(some):
    """{(quantity, unit): its fits}, in the order of the trials."""
    groups = {}
    for fit in some:
        groups.setdefault((fit["quantity"], fit["unit"]), []).append(fit)
    return groups


def pooled(some):
    """RMSE [unit of the quantity] and R² over several trials; NaN if unknown. R² counts from each trial's own mean."""
    n, rmse, r2 = (np.array([fit[key] for fit in some], float) for key in ("n", "rmse", "r2"))
    known = np.isfinite(rmse) & (n > 0)
    if not known.any():
        return np.nan, np.nan
    errors = (n * rmse ** 2)[known]
    with np.errstate(divide="ignore", invalid="ignore"):
        deviations = errors / (1 - r2[known])
    return np.sqrt(errors.sum() / n[known].sum()), 1 - errors.sum() / deviations.sum()


def error_text(rmse, r2, unit):
    """112 N (R² 0.780)."""
    return f"{number(rmse)} {unit}".strip() + (f" (R² {coefficient(r2)})" if np.isfinite(r2) else "")


train = by_quantity(fit for fit in fits if fit["role"] == "train" and fit["n"] > 0)
validate = by_quantity(fit for fit in fits if fit["role"] == "validate" and fit["n"] > 0)
unused = by_quantity(fit for fit in fits if fit["role"] == "predicted" and fit["n"] > 0)
unmeasured = by_quantity(fit for fit in fits if fit["n"] == 0)

if train or validate:
    rows = ""
    for key in dict.fromkeys([*train, *validate]):
        cells = [error_text(*pooled(part[key]), key[1]) if key in part else "–" for part in (train, validate)]
        rows += f"<tr><td>{escape(key[0])}</td>" + "".join(f'<td class="value">{cell}</td>' for cell in cells) + "</tr>"
    display(HTML('<table><thead><tr><th>Error of the simulation (RMSE)</th><th class="value">fitted trials</th>'
                 f'<th class="value">held-out trials</th></tr></thead><tbody>{rows}</tbody></table>'))

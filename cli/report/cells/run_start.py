# %% title [markdown]
# # {{TITLE}}

# %% include look

# %% include run_open

# %% provenance and findings
display(HTML('<p class="provenance">' + " · ".join(escape(text) for text in [
    "synthetic data" if info["synthetic"] else "measured data", f"problem {info['problem']}",
    f"solver {info['solver']}", f"seed {info['seed']}", f"sinew {info['version']}",
    f"{info['evaluations']} evaluations in {duration(info['seconds'])}",
    f"stopped: {info['stop_reason'].replace('_', ' ')}" if info["stop_reason"] != "running" else "unfinished"]) + "</p>"))

doubts = []
why = f"{info['stop_reason']} ({info['stop_test']})" if info["stop_test"] else info["stop_reason"]
if not info["finished"]:
    doubts.append(f"This run has not finished: what follows is its state after {info['evaluations']} evaluations.")
if not info["usable"]:
    doubts.append(f"The answer of this run is not usable: {why}.")
elif info["finished"] and not info["converged"]:
    doubts.append(f"The solver stopped before it had converged: {why}.")

if doubts:  # they limit everything below
    display(HTML(items(doubts, "warnings")))
display(HTML(long_list(texts("/run/findings") or ["This run states no findings."], "findings")))
if texts("/run/warnings"):
    display(HTML(items(texts("/run/warnings"), "warnings")))

# %% convergence [markdown]
# ## Search

# %% convergence
cost = run["/trace/cost"][:]
# Of a long search only a part of the evaluations is in the file, and their numbers with them.
count = run["/trace/evaluation"][:].astype(int) + 1 if "/trace/evaluation" in run else np.arange(1, len(cost) + 1)
evaluations = max(int(run["/run"].attrs["evaluations"]), len(cost))
failures = int(run["/run"].attrs["failures"]) if len(cost) < evaluations else (~np.isfinite(cost)).sum()
failed = ~np.isfinite(cost)
best = np.minimum.accumulate(np.where(failed, np.inf, cost))
reached = best[np.isfinite(best)]

figure, axis = plt.subplots(figsize=(WIDTH, 3.2))
some = np.unique(np.linspace(0, len(cost) - 1, 5000).astype(int))  # enough points for the eye
axis.plot(count[some], np.where(failed, np.nan, cost)[some], ".", color=GREY, alpha=0.6, mew=0,
          ms=8 if len(some) < 200 else 4, label="one evaluation")
axis.plot(count[np.isfinite(best)], reached, color=TRAIN, lw=2, drawstyle="steps-post", label="best so far")
finding = "No evaluation succeeded"
if reached.size:
    tried = cost[~failed]
    top = max(reached[0], np.percentile(tried, 97))
    if reached[-1] > 0 and top > 30 * reached[-1]:
        axis.set_ylim(reached[-1] / 1.5, top * 2)
        by_decades(axis, "y")
    else:
        axis.set_ylim(reached[-1] - 0.08 * (top - reached[-1] or 1), top + 0.08 * (top - reached[-1] or 1))
    axis.annotate(number(reached[-1], 4), (count[-1], reached[-1]), xytext=(6, 0), textcoords="offset points",
                  va="center", color=TRAIN, annotation_clip=False)
    near = count[best <= reached[-1] + 0.01 * (reached[0] - reached[-1])][0]
    finding = f"99 % of the improvement came within the first {near} of {evaluations} evaluations" \
        if reached[0] > reached[-1] else f"No evaluation was better than the first, out of {evaluations}"
else:
    axis.set_yticks([])
if failed.any():
    axis.plot(count[failed], np.zeros(failed.sum()), "|", color=VALIDATE, ms=8, transform=axis.get_xaxis_transform(),
              label=f"failed simulation ({failures})", clip_on=False)
chain = "/stages" in run and not any(name in info["solver"] for name in ("multistart", "restarts"))
if chain:  # one solver after the other: say where each began
    ends = np.cumsum(run["/stages/evaluations"][:])
    for start, solver in zip(np.concatenate([[0], ends[:-1]]), texts("/stages/solver")):
        axis.axvline(start + 0.5, color="#bbbbbb", lw=0.8)
        axis.text(start + 0.5, 1.01, solver, transform=axis.get_xaxis_transform(), va="bottom", size=8, color="#666666")
axis.set_xlabel("evaluations")
axis.set_ylabel("cost")
axis.set_title("Cost: " + info["objective"], color="#666666", pad=14 if chain else 6)
axis.legend(loc="upper left", bbox_to_anchor=(1.005, 1))
axis.xaxis.get_major_locator().set_params(integer=True)
axis.margins(x=0.01)
headline(figure, finding)
plt.show()

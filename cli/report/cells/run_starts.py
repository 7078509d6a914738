# %% starts
# The waterfall of a multistart: the final costs, sorted. A plateau at the left is what a trustworthy answer looks like.
ends = np.sort(run["/stages/cost"][:])
ends = ends[np.isfinite(ends)]
lost = len(run["/stages/cost"]) - len(ends)
if ends.size:
    spare = 0.01 * abs(ends[0]) or 1e-12
    same = ends <= ends[0] + spare
    figure, axis = plt.subplots(figsize=(WIDTH, 2.8))
    ranks = np.arange(1, len(ends) + 1)
    axis.plot(ranks, ends, color="#cccccc", lw=1, zorder=1)
    axis.plot(ranks[same], ends[same], "o", ms=5, color=TRAIN, label="within 1 % of the best")
    axis.plot(ranks[~same], ends[~same], "o", ms=5, color=GREY, mfc="white", label="ended elsewhere")
    if ends[0] > 0 and ends[-1] > 30 * ends[0]:
        by_decades(axis, "y")
    axis.set_xlabel("starts, best first")
    axis.set_ylabel("final cost")
    axis.xaxis.get_major_locator().set_params(integer=True)
    if not same.all():
        axis.legend(loc="upper left")
    headline(figure, f"{same.sum()} of {len(ends) + lost} starts end at the best cost"
                    + (f"; {lost} failed" if lost else ""))
    plt.show()

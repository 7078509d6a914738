# %% contact [markdown]
# ## Pressure under the sole
#
# Each triangle of the contact mesh with its own pressure, seen from below: toes up, the right side of the body at the
# left. The line is the path of the centre of pressure.

# %% contact
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

trials = children("/details/contact")
trial = trials[0]  # another trial: change this to one of `trials`

regions = {}
for name in children(f"/details/contact/{trial}"):
    node = run[f"/details/contact/{trial}/{name}"]
    outline = node["outline"][()]  # [faces, corners, (x forward, z to the right)], m
    (ax, az), (bx, bz) = (outline[:, 1] - outline[:, 0]).T, (outline[:, 2] - outline[:, 0]).T
    pressure = node["pressure"][()]  # [instants, faces], Pa
    regions[name] = {"side": f"{name} {node.attrs['body']} {node.attrs['plate']}".lower(),
                     "time": node["time"][:], "corners": outline[:, :, ::-1] * 100,  # (z, x), cm
                     "path": node["centre_of_pressure"][()][:, ::-1] * 100, "slip": node["slip"][()],
                     "pressure": pressure / 1e3,  # kPa
                     "force": pressure @ (np.abs(ax * bz - az * bx) / 2)}
# Seen from below the right foot lies at the left.
regions = dict(sorted(regions.items(), key=lambda item: "left" in item[1]["side"]))

time = next(iter(regions.values()))["time"]
force = sum(np.interp(time, region["time"], region["force"]) for region in regions.values())
instant = time[np.argmax(force)]  # any other instant of the trial [s]: change this
highest = max(region["pressure"].max() for region in regions.values()) or 1.0  # kPa
colours = plt.get_cmap("magma_r").copy()
colours.set_under("#efefef")  # faces that carry nothing


def draw_sole(axis, region, when):
    """Pressure on every face at one instant; returns what a colour bar needs."""
    i = np.argmin(np.abs(region["time"] - when))
    faces = PolyCollection(region["corners"], array=region["pressure"][i], cmap=colours,
                           norm=Normalize(1e-3 * highest, highest), edgecolors="face", linewidths=0.4)
    axis.add_collection(faces)
    if np.isfinite(region["path"][i]).all():
        axis.plot(*region["path"][i], "o", ms=6, color="white", mec=TRAIN, mew=1.8, zorder=5)
    corners = region["corners"].reshape(-1, 2)
    (left, bottom), (right, top) = corners.min(axis=0) - 0.5, corners.max(axis=0) + 0.5
    axis.set(xlim=(right, left), ylim=(bottom, top), aspect="equal")  # from below: z to the right points left
    axis.grid(False)
    return faces


def draw_instant(when):
    """All regions next to each other at one instant."""
    figure, axes = plt.subplots(1, len(regions), figsize=(min(WIDTH, 1.6 + 3.1 * len(regions)), 5.0), squeeze=False)
    for axis, (name, region) in zip(axes[0], regions.items()):
        faces = draw_sole(axis, region, when)
        axis.plot(*region["path"].T, color="white", lw=3, zorder=3)
        axis.plot(*region["path"].T, color=TRAIN, lw=1.4, zorder=4)
        i = np.argmin(np.abs(region["time"] - when))
        axis.set_title(f"{name}\n{number(region['force'][i])} N, peak {number(region['pressure'][i].max(), 2)} kPa")
        axis.set_xlabel("← right (cm)")
    axes[0][0].set_ylabel("forward → (cm)")
    figure.colorbar(faces, ax=axes, shrink=0.7, label="pressure (kPa)").outline.set_visible(False)
    total = np.interp(when, time, force)
    headline(figure, f"{trial}: {number(total)} N normal force at {when:.3f} s"
                    + (", the greatest" if when == time[np.argmax(force)] else ""))
    plt.show()


draw_instant(instant)

# %% contact over the stance
loaded = time[force > 0.03 * force.max()] if force.max() > 0 else time
instants = loaded[0] + (loaded[-1] - loaded[0]) * np.array([0.05, 0.25, 0.5, 0.75, 0.95])

figure = plt.figure(figsize=(WIDTH, 1.7 + 2.7 * len(regions)))
grid = figure.add_gridspec(1 + len(regions), len(instants) + 1, height_ratios=[1.0] + [2.3] * len(regions),
                           width_ratios=[1.0] * len(instants) + [0.06])
curve = figure.add_subplot(grid[0, :-1])
if len(regions) > 1:
    for style, (name, region) in zip(["--", ":", "-."] * len(regions), regions.items()):
        curve.plot(region["time"], region["force"], style, color="#888888", lw=1.1, label=name)
curve.plot(time, force, color=TRAIN, lw=2, label="all regions" if len(regions) > 1 else "normal force")
curve.plot(instants, np.interp(instants, time, force), "o", color="white", mec=TRAIN, mew=1.8, ms=6, zorder=5)
curve.set(xlabel="time (s)", ylabel="normal force (N)", ylim=(0, None))
curve.margins(x=0.01)
if len(regions) > 1:
    curve.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncol=len(regions) + 1, borderaxespad=0)
for r, (name, region) in enumerate(regions.items()):
    for c, when in enumerate(instants):
        axis = figure.add_subplot(grid[1 + r, c])
        faces = draw_sole(axis, region, when)
        axis.set(xticks=[], yticks=[])
        axis.spines[:].set_visible(False)
        if r == 0:
            axis.set_title(f"{when:.2f} s", loc="center")
        if c == 0:
            axis.set_ylabel(name)
figure.colorbar(faces, cax=figure.add_subplot(grid[1, -1]), label="pressure (kPa)").outline.set_visible(False)
carrying = [region["slip"][region["pressure"] > 0.05 * highest] for region in regions.values()]
fastest = max((slip.max() for slip in carrying if slip.size), default=0.0)
lasting = loaded[-1] - loaded[0]
headline(figure, f"{trial}: {number(lasting, 2)} s in contact; "
                 f"loaded faces slide at up to {number(fastest * 1e3, 2)} mm/s")
plt.show()

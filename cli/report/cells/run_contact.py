# %% contact [markdown]
# ## Pressure under the sole
#
# Each triangle of the contact mesh with its own pressure, seen from below as on a lying person's sole: forward points
# up, and the right side of the body is at the left. The line is the path of the centre of pressure, the dot its place
# at the instant shown.

# %% contact
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

trials = children("/details/contact")
fitted = [trial for trial in trials for node in run.get(f"/prediction/{trial}", {}).values()
          if node.attrs["role"] == "train"]
trial = (fitted or trials)[0]  # another trial: change this to one of `trials`

regions = {}
for name in children(f"/details/contact/{trial}"):
    node = run[f"/details/contact/{trial}/{name}"]
    outline = node["outline"][()]  # [faces, corners, (x forward, z to the right)], m
    (ax, az), (bx, bz) = (outline[:, 1] - outline[:, 0]).T, (outline[:, 2] - outline[:, 0]).T
    pressure = node["pressure"][()]  # [instants, faces], Pa
    force = pressure @ (np.abs(ax * bz - az * bx) / 2)
    when = node["time"][:]
    regions[name] = {"body": node.attrs["body"], "plate": node.attrs["plate"], "time": when,
                     "corners": outline[:, :, ::-1] * 100,  # (z, x), cm
                     "path": node["centre_of_pressure"][()][:, ::-1] * 100, "slip": node["slip"][()],
                     "pressure": pressure / 1e3,  # kPa
                     "force": force, "loaded": when @ force / force.sum() if force.sum() > 0 else when[-1]}


def box(region):
    """Left, right, bottom, top of a region [cm]."""
    corners = region["corners"].reshape(-1, 2)
    (left, bottom), (right, top) = corners.min(axis=0), corners.max(axis=0)
    return left, right, bottom, top


def apart(one, other):
    """Whether two regions do not overlap in the frame that their outlines are given in."""
    (l1, r1, b1, t1), (l2, r2, b2, t2) = box(one), box(other)
    return min(r1, r2) - max(l1, l2) < 0.1 or min(t1, t2) - max(b1, b2) < 0.1


# One picture per foot; a picture per region where each region has a frame of its own. A foot rolls from heel to toe,
# so the region that is loaded last comes first, at the top.
pictures = {}
for name, region in sorted(regions.items(), key=lambda item: (item[1]["body"], -item[1]["loaded"])):
    same = {other: r for other, r in regions.items() if r["body"] == region["body"]}
    alone = all(apart(r, s) for r in same.values() for s in same.values() if r is not s)
    key = region["body"] if alone and len(same) > 1 else name
    pictures.setdefault(key, {})[name] = region
# Seen from below, the right foot lies at the left.
pictures = dict(sorted(pictures.items(), key=lambda item: "left" in
                       " ".join(f"{name} {r['body']} {r['plate']}" for name, r in item[1].items()).lower()))
boxes = {name: np.array([box(r) for r in some.values()]) for name, some in pictures.items()}
frames = {name: (b[:, 0].min() - 0.4, b[:, 1].max() + 0.4, b[:, 2].min() - 0.4, b[:, 3].max() + 0.4)
          for name, b in boxes.items()}  # left, right, bottom, top [cm]
wide, tall = (np.array([frame[i + 1] - frame[i] for frame in frames.values()]) for i in (0, 2))

time = next(iter(regions.values()))["time"]
force = sum(np.interp(time, region["time"], region["force"]) for region in regions.values())
instant = time[np.argmax(force)]  # any other instant of the trial [s]: change this
highest = max(region["pressure"].max() for region in regions.values()) or 1.0  # kPa
colours = plt.get_cmap("magma_r").copy()
colours.set_under("#efefef")  # faces that carry nothing


def draw_sole(axis, name, when):
    """Pressure on every face of a picture at one instant; returns what a colour bar needs."""
    for region in pictures[name].values():
        i = np.argmin(np.abs(region["time"] - when))
        faces = PolyCollection(region["corners"], array=region["pressure"][i], cmap=colours,
                               norm=Normalize(1e-3 * highest, highest), edgecolors="face", linewidths=0.4)
        axis.add_collection(faces)
        if np.isfinite(region["path"][i]).all():
            axis.plot(*region["path"][i], "o", ms=6, color="white", mec=TRAIN, mew=1.8, zorder=5)
    left, right, bottom, top = frames[name]
    axis.set(xlim=(right, left), ylim=(bottom, top), aspect="equal")  # from below: z to the right points left
    axis.grid(False)
    return faces


def draw_instant(when):
    """All pictures next to each other at one instant, to one scale."""
    inches = min(3.6 / tall.max(), (WIDTH - 1.5 - 0.65 * len(pictures)) / wide.sum(), 0.28)  # per cm
    width, height = max(1.5 + 0.65 * len(pictures) + inches * wide.sum(), 6.0), 1.35 + inches * tall.max()
    figure = plt.figure(figsize=(width, height))
    figure.set_layout_engine("none")
    left = 0.6
    for (name, some), w, h in zip(pictures.items(), wide * inches, tall * inches):
        axis = figure.add_axes([left / width, 0.48 / height, w / width, h / height])
        faces = draw_sole(axis, name, when)
        peak = 0
        for region in some.values():
            axis.plot(*region["path"].T, color="white", lw=3, zorder=3)
            axis.plot(*region["path"].T, color=TRAIN, lw=1.4, zorder=4)
            peak = max(peak, region["pressure"][np.argmin(np.abs(region["time"] - when))].max())
        load = sum(np.interp(when, region["time"], region["force"]) for region in some.values())
        axis.set_title(f"{name}\n{number(load)} N, up to {number(peak, 2)} kPa", size=8.5)
        axis.set_xlabel("← right (cm)")
        axis.locator_params(nbins=5)
        if left == 0.6:
            axis.set_ylabel("forward → (cm)")
        left += w + 0.65
    bar = figure.add_axes([(left - 0.25) / width, 0.48 / height, 0.14 / width, min(tall.max() * inches, 2.8) / height])
    figure.colorbar(faces, cax=bar, label="pressure (kPa)").outline.set_visible(False)
    headline(figure, f"{trial}: {number(np.interp(when, time, force))} N on the sole at {when:.3f} s"
                    + (", the largest load" if when == time[np.argmax(force)] else ""))
    plt.show()


draw_instant(instant)

simulated = [node for plate in {region["plate"] for region in regions.values()}
             for node in [run.get(f"/prediction/{trial}/{plate}_force_y")] if node is not None]
whole = sum(np.interp(instant, node["time"][:], node["simulated"][:]) for node in simulated)
drawn = np.interp(instant, time, force)
if simulated and drawn < 0.97 * whole:
    display(HTML(items([f"The faces drawn, those that look down, carry {number(drawn)} N of the {number(whole)} N that "
                        "the model gives at this instant. The rest acts on sides and tops of the meshes: they lie too "
                        "deep in the floor."], "warnings")))

# %% contact over the stance
loaded = time[force > 0.03 * force.max()] if force.max() > 0 else time
instants = loaded[0] + (loaded[-1] - loaded[0]) * np.array([0.05, 0.25, 0.5, 0.75, 0.95])

LEFT, RIGHT, STEP = 0.75, 0.85, (WIDTH - 1.6) / len(instants)  # inches: margins, from picture to picture
inches = min(0.8 * STEP / wide.max(), 2.4 / tall.max(), 0.2)  # per cm: one scale for all
heights = inches * tall
height = 2.45 + heights.sum() + 0.15 * len(heights)
figure = plt.figure(figsize=(WIDTH, height))
figure.set_layout_engine("none")
top = height - (0.55 if len(regions) > 1 else 0.35)
curve = figure.add_axes([LEFT / WIDTH, (top - 1.2) / height, (WIDTH - LEFT - RIGHT) / WIDTH, 1.2 / height])
if len(regions) > 1:
    in_pictures = [item for some in pictures.values() for item in some.items()]
    for style, (name, region) in zip(["--", ":", "-."] * len(regions), in_pictures):
        curve.plot(region["time"], region["force"], style, color="#888888", lw=1.1, label=name)
curve.plot(time, force, color=TRAIN, lw=2, label="all regions" if len(regions) > 1 else "normal force")
curve.plot(instants, np.interp(instants, time, force), "o", color="white", mec=TRAIN, mew=1.8, ms=6, zorder=5)
curve.set(xlabel="time (s)", ylabel="force (N)", ylim=(0, None))
curve.margins(x=0.01)
if len(regions) > 1:
    curve.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=min(len(regions) + 1, 6), borderaxespad=0)
bottom = top - 1.2 - 0.8
for r, (name, h) in enumerate(zip(pictures, heights)):
    bottom -= h
    for c, when in enumerate(instants):
        axis = figure.add_axes([(LEFT + c * STEP) / WIDTH, bottom / height, 0.9 * STEP / WIDTH, h / height])
        faces = draw_sole(axis, name, when)
        axis.set(xticks=[], yticks=[])
        axis.spines[:].set_visible(False)
        if r == 0:
            axis.set_title(f"{when:.2f} s", loc="center")
        if c == 0:
            axis.set_ylabel(name, size=8.5)
            axis.yaxis.set_label_coords(-0.04, 0.5)  # at the edge of its cell, clear of the widest picture
    bottom -= 0.15
long = min(2.2, heights.sum())
bar = figure.add_axes([(WIDTH - 0.65) / WIDTH, (top - 2.0 - long) / height, 0.14 / WIDTH, long / height])
figure.colorbar(faces, cax=bar, label="pressure (kPa)").outline.set_visible(False)
carrying = [region["slip"][region["pressure"] > 0.05 * highest] for region in regions.values()]
fastest = max((slip.max() for slip in carrying if slip.size), default=0.0)
sliding = f"{number(fastest)} m/s" if fastest >= 1 else f"{number(fastest * 1e3, 2)} mm/s"
headline(figure, f"{trial}: {number(loaded[-1] - loaded[0], 2)} s in contact; "
                 f"loaded faces slide over the floor at up to {sliding}")
plt.show()

# %% dynamometer [markdown]
# ## What the machine's torque is made of
#
# The torque that the machine measures is the sum of the attachment's (its weight, inertia and friction) and of what passes
# through sole and straps, here at the values that the fit started from and at the fitted ones. On the other side of them are
# the muscles and the passive ankle. The inverse view needs no muscle model: measured torque less attachment, passive
# ankle and weight of the foot, with the 95 % band that the errors of the parameters leave. Below: the power of the muscles, what of
# it reaches the machine, and what is lost between foot and plate.

# %% dynamometer
parts = run["/details/ankle_on_dynamometer"]
with_foot = [name for name in parts if "interaction_torque" in parts[name]]
most = max(with_foot, key=lambda name: np.abs(parts[name]["power_to_machine"][:]).max())
trial = most  # any other trial: change this
node = parts[trial]
when = node["time"][:]
at = int(np.argmax(np.abs(node["power_to_machine"][:])))
span = min(4.0, when[-1] - when[0])  # seconds shown, about the largest power
begin = float(np.clip(when[at] - span / 2, when[0], when[-1] - span))
seen = (when >= begin) & (when <= begin + span)
has_before = "before" in node    # files of earlier versions have none of the two
has_inverse = "inverse" in node
heights = [1] + [1.5] * has_before + [1.5, 1.2] + [1.2] * has_inverse + [1.2]
figure, axes = plt.subplots(len(heights), 1, figsize=(WIDTH, 1.75 * sum(heights)), sharex=True,
                            gridspec_kw={"height_ratios": heights})
angles, *before, torques, moments = axes[:3 + has_before]
powers = axes[-1]
PARTS = (("machine_torque", "machine"), ("torque_of_attachment", "attachment"), ("torque_of_sole", "sole"),
         ("torque_of_straps", "straps"))


def draw(axis, names, scale=1.0, of=node):
    """Some of the series over the time shown."""
    for (name, label), colour in zip(names, (MEASURED, TRAIN, VALIDATE, "#009E73", "#CC79A7")):
        axis.plot(when[seen], scale * of[name][:][seen], color=colour, label=label)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=5, borderaxespad=0, fontsize=8)


def band(inverse):
    """Half of the 95 % band of the inverse view, from the covariance of the fitted parameters."""
    fitted = texts("/uncertainty/name")
    slopes = inverse["slopes"][()]
    known = [text.decode() if isinstance(text, bytes) else text for text in inverse["parameters"][()]]
    kept = [i for i, name in enumerate(fitted) if name in known]
    covariance = np.nan_to_num(run["/uncertainty/covariance"][()][np.ix_(kept, kept)], posinf=0)  # none: not determined
    slopes = slopes[:, [known.index(fitted[i]) for i in kept]]
    return 1.96 * np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slopes, covariance, slopes), 0))


draw(angles, (("machine_angle", "machine"), ("ankle_angle", "ankle")), 180 / np.pi)
angles.set_ylabel("angle (°)")
for axis in before:
    draw(axis, PARTS, of=node["before"])
    axis.set_ylabel("torque (N·m)\nat the start")
draw(torques, PARTS)
torques.set_ylabel("torque (N·m)\nfitted")
measured = run[f"/prediction/{trial}/machine_torque"]
for axis in (*before, torques):
    axis.plot(measured["time"][:], measured["measured"][:], ".", color="#999999", markersize=2, zorder=0)
draw(moments, (("interaction_torque", "foot on plate"), ("moment_of_muscles", "muscles"), ("moment_passive", "passive ankle")))
moments.set_ylabel("about the ankle (N·m)")
if has_inverse:
    inverse = node["inverse"]
    left = axes[-2]
    time, torque = inverse["time"][:], inverse["torque_of_muscles"][:]
    inside = (time >= begin) & (time <= begin + span)
    left.plot(time[inside], torque[inside], ".", color=MEASURED, markersize=3, label="measured, the rest removed")
    if "/uncertainty/covariance" in run:
        half = band(inverse)
        left.fill_between(time[inside], (torque - half)[inside], (torque + half)[inside], color=MEASURED, alpha=0.2, linewidth=0)
    left.plot(when[seen], node["moment_of_muscles"][:][seen], color=TRAIN, label="muscles of the model")
    left.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=5, borderaxespad=0, fontsize=8)
    left.set_ylabel("inverse view (N·m)")
draw(powers, (("power_of_muscles", "muscles"), ("power_to_machine", "to the machine"),
              ("power_lost_in_boundary", "lost in sole and straps")))
powers.set_ylabel("power (W)")
powers.set_xlabel("time (s)")
powers.set_xlim(begin, begin + span)
turn = 180 / np.pi * np.abs(node["ankle_angle"][:] - node["machine_angle"][:]).max()
headline(figure, f"{trial}: foot and plate turn against each other by up to {number(turn, 2)}°")
plt.show()

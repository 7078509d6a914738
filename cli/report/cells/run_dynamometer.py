# %% dynamometer [markdown]
# ## What the machine's torque is made of
#
# The torque that the machine measures is the sum of the attachment's (its weight, inertia and friction) and of what passes
# through sole and straps. On the other side of them are the muscles and the passive ankle. Below: the power of the
# muscles, what of it reaches the machine, and what is lost between foot and plate.

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
figure, (angles, torques, moments, powers) = plt.subplots(
    4, 1, figsize=(WIDTH, 8.2), sharex=True, gridspec_kw={"height_ratios": (1, 1.6, 1.2, 1.2)})


def draw(axis, names, scale=1.0):
    """Some of the series over the time shown."""
    for (name, label), colour in zip(names, (MEASURED, TRAIN, VALIDATE, "#009E73", "#CC79A7")):
        axis.plot(when[seen], scale * node[name][:][seen], color=colour, label=label)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=5, borderaxespad=0, fontsize=8)


draw(angles, (("machine_angle", "machine"), ("ankle_angle", "ankle")), 180 / np.pi)
angles.set_ylabel("angle (°)")
draw(torques, (("machine_torque", "machine"), ("torque_of_attachment", "attachment"), ("torque_of_sole", "sole"),
               ("torque_of_straps", "straps")))
torques.set_ylabel("torque (N·m)")
draw(moments, (("interaction_torque", "foot on plate"), ("moment_of_muscles", "muscles"), ("moment_passive", "passive ankle")))
moments.set_ylabel("about the ankle (N·m)")
draw(powers, (("power_of_muscles", "muscles"), ("power_to_machine", "to the machine"),
              ("power_lost_in_boundary", "lost in sole and straps")))
powers.set_ylabel("power (W)")
powers.set_xlabel("time (s)")
turn = 180 / np.pi * np.abs(node["ankle_angle"][:] - node["machine_angle"][:]).max()
headline(figure, f"{trial}: foot and plate turn against each other by up to {number(turn, 2)}°")
plt.show()

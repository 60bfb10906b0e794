# %% [markdown]
# # From finite elements to a modal Iwan model
# The paper's way: a beam with four bolted joints, each an Iwan joint of its own, is struck; what its modes do then is told by
# one modal Iwan joint per mode. Structure, modes, quasi-static curves, the struck structure, modal filter, fit, comparison.

# %%
import numpy as np
from matplotlib import pyplot
from matplotlib.ticker import NullFormatter

import iwan

beam = iwan.Structure.built_in("paper-a")
print(beam, beam.title, f"{beam.nodes.shape[0]} nodes, joints: {', '.join(beam.joints)}", sep="\n")

# %% [markdown]
# Linear modes in both limits: all joints stuck (small amplitudes), all slipping (large ones). Mode 2 does not bend the link: its
# K_T is not even positive, for slipping frees some inertia. It is linear in practice.

# %%
modes = beam.modes(8)
for name, stuck, slipping, k_t in zip(modes.names, modes.frequency, modes.frequency_slipping, modes.k_t):
    print(f"{name:12}{stuck:10.3f} Hz stuck {slipping:10.3f} Hz slipping   K_T = {k_t:11.4g}")

# %% [markdown]
# What a modal joint will be, without any transient: static loads in the shape of the mode.

# %%
static = beam.quasi_static("bending 1")
print(static.joint)
print(f"the joint follows the curves within {static.dissipation_misfit:.0%} in dissipation")

# %% [markdown]
# Six accelerometers along the beam: outputs in the structure file, each the mean over the nodes in a box.

# %%
places = {"far end": -10.0, "far": -7.0, "left": -4.0, "right": 4.0, "near": 7.0, "near end": 10.0}
text = beam.text
for name, x in places.items():
    text += f"""
        [[set]]
        kind = "box"
        name = "{name}"
        low = [{x - 0.01}, -0.01, -9.0]
        high = [{x + 0.01}, 0.01, 9.0]
        [[output]]
        name = "{name}"
        nodes = "{name}"
        direction = "z"
    """
with open("sensors.toml", "w") as file:
    file.write(text)
beam = iwan.Structure.load("sensors.toml")

# %% [markdown]
# The blow at the tip, at two levels, with the joints slipping one by one. The reduced model has the modes and the static
# attachment vectors of the slips; its error is part of the answer.

# %%
duration, blow = 0.4, 1.6e-3
truth = {}
for amplitude in (100.0, 1000.0):
    force = iwan.Haversine(amplitude=amplitude, duration=blow)
    truth[amplitude] = beam.simulate(force=force, dt=2e-5, duration=duration, basis=50)
    print(truth[amplitude], f"energy error {truth[amplitude].energy_error:.0e}")

# %% [markdown]
# The modal filter: six accelerations, and the shapes at the sensors. After the blow rigid motions do not accelerate, so that
# six elastic modes are all there is to tell apart. The condition number says by how much noise may grow.

# %%
heard = [name for name in modes.names if name.startswith("bending")]
sensed = beam.modes(8)
shapes = np.array([[sensed.outputs[place][sensed.index(name)] for name in heard] for place in places])
print(f"{', '.join(heard)}: condition {np.linalg.cond(shapes):.1f}")


def filtered(response: iwan.StructureResponse) -> iwan.Record:
    sensors = np.array([response.record(place, since=2 * blow).channel() for place in places])
    noise = 1e-4 * np.abs(sensors).max() * np.random.default_rng(1).standard_normal(sensors.shape)
    modal = np.linalg.pinv(shapes) @ (sensors + noise)
    return iwan.Record(modal, dt=response.dt, names=heard, quantity="acceleration", start=2 * blow)


records = [filtered(response) for response in truth.values()]

# %% [markdown]
# One modal Iwan joint for both records of the first mode.

# %%
fit = iwan.fit(records, channel="bending 1", band=(80.0, 180.0))
print(fit)

# %% [markdown]
# Compared with the static promise: K_T and F_S come out of the records within a fifth of what the modes and the static loads say, and
# the intervals are as wide: the two records are not those of one modal joint, and the fit says by how much they differ. In the
# structure there is no viscous damper, and in the fit there is one: it stands for what the other modes do to the joints. While
# all modes ring together mode 1 loses more energy than by itself, which no modal model of one mode alone can know.

# %%
u = np.geomspace(fit.curves["displacement"].min(), fit.curves["displacement"].max(), 50)
omega = 2 * np.pi * fit.mode.frequency_at(u)
lost = 2 * np.pi * fit.mode.damping_ratio_at(u) * omega**2 * u**2
ratio = lost / np.interp(u, static.displacement, static.dissipation)
print(f"K_T {fit.joint.k_t:.4g} by the records, {static.k_t:.4g} by the modes")
print(f"F_S {fit.joint.f_s:.4g} by the records, {static.joint.f_s:.4g} by static loads")
print(f"dissipation by the records over the static one: {ratio.min():.2f} to {ratio.max():.2f}")
assert abs(fit.frequency - modes.frequency[0]) < 0.5
assert abs(fit.joint.k_t / static.k_t - 1) < 0.2
assert 1.0 < np.median(ratio) < 2.0

figure, axes = pyplot.subplots(2, 2, figsize=(10, 7), layout="constrained")
iwan.plot.mode_shape(modes, "bending 1", ax=axes[0, 0])
iwan.plot.ring_down(records[1], channel="bending 1", ax=axes[0, 1])
iwan.plot.fitted(fit, ax=axes[1, 0])
axes[1, 1].loglog(static.displacement, static.dissipation, label="structure, static loads")
axes[1, 1].loglog(u, lost, label="fit of the records")
axes[1, 1].set(xlabel="modal displacement", ylabel="dissipation per cycle", xlim=(u.min(), u.max()), ylim=(lost.min() / 2, 2 * lost.max()))
axes[1, 1].xaxis.set_minor_formatter(NullFormatter())
axes[1, 1].legend()
figure.savefig("from_finite_elements.png")

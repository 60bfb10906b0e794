# %% [markdown]
# # The fit of a measured record
# A record as a laboratory hands it over: a text file with times, two accelerometers, and noise. Here it is made by the
# computer, so that the truth is known.

# %%
import json

import numpy as np
from matplotlib import pyplot

import iwan

truth = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
mode = iwan.Mode(frequency=124.0, joint=truth, damping_ratio=1e-3)
start = (1.5 * truth.phi_max, 0.0)
ring_down = iwan.simulate(mode, dt=1 / 4096, duration=1.0, initial=start, method="half-cycle")
noise = 1e-3 * np.abs(ring_down.acceleration).max() * np.random.default_rng(1).standard_normal((2, len(ring_down)))
tip, root = ring_down.acceleration + noise[0], -0.4 * ring_down.acceleration + noise[1]
table = np.column_stack([ring_down.t, tip, root])
np.savetxt("hammer.csv", table, delimiter=",", header="time [s],tip [m/s^2],root [m/s^2]", comments="", fmt="%.17g")

# %% [markdown]
# Delimiter, header, time and units are found. The two channels are combined by the shape that dominates in the band.

# %%
record = iwan.read_record("hammer.csv")
print(record)
envelopes = {method: iwan.envelope(record, method=method) for method in ("hilbert", "peaks", "pff")}

# %% [markdown]
# The fit: parameters with 95 % intervals, and whether the model can tell the record at all.

# %%
fit = iwan.fit(record)
print(fit)
assert fit.adequate
assert abs(fit.joint.chi - truth.chi) < 0.05
assert abs(fit.frequency - 124.0) < 0.05

figure, axes = pyplot.subplots(2, 2, figsize=(10, 7), layout="constrained")
iwan.plot.ring_down(record, channel="tip", envelope=envelopes["hilbert"], ax=axes[0, 0])
iwan.plot.frequency(envelopes, mode=mode, ax=axes[0, 1])
iwan.plot.fitted(fit, ax=axes[1, 0])
iwan.plot.density({"truth": truth, "fit": fit.joint}, ax=axes[1, 1])
figure.savefig("fit_of_a_record.png")

# %% [markdown]
# All of it as one page to keep or to send: tables, intervals, what was found on the way, figures.

# %%
fit.report("fit.html", names=["hammer.csv"])

# %% [markdown]
# And as JSON for other programs, with the same content as `fit.json` of the command `iwan fit`.

# %%
found = json.loads(fit.to_json("fit.json", names=["hammer.csv"]))
assert found["modes"][0]["k_t"]["value"] == fit.joint.k_t

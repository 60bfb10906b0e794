# %% [markdown]
# # A first ring-down
# Mode 1 of the paper's beam (Table 2) under a hammer blow: what an Iwan joint does to frequency and damping.

# %%
import numpy as np
from matplotlib import pyplot

import iwan

joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4, name="bending 1")
blow = iwan.Haversine(amplitude=5000.0, duration=1.6e-3)
response = iwan.simulate(mode, force=blow, dt=1e-5, duration=0.5)

# %% [markdown]
# The answer comes with its errors: the energy balance, and what time step and sliders contribute.

# %%
print(response)
for name, value in response.statistics.items():
    print(f"{name:24}{value:.3g}")
assert response.energy_error < 1e-10
assert response.statistics["time_step_error"] < 1e-3

# %% [markdown]
# Amplitude, frequency and damping of the ring-down, from the record alone, beside the model that made it.

# %%
after = 200  # the blow is over
envelope = iwan.envelope(response.acceleration[after:], dt=response.dt, filter_order=0)

figure, axes = pyplot.subplots(2, 2, figsize=(10, 7), layout="constrained")
iwan.plot.ring_down(response, ax=axes[0, 0])
iwan.plot.hysteresis(response, joint=joint, ax=axes[0, 1])
iwan.plot.frequency(envelope, mode=mode, ax=axes[1, 0])
iwan.plot.damping(envelope, mode=mode, ax=axes[1, 1])
figure.savefig("first_ring_down.png")

# %% [markdown]
# In micro-slip the dissipation per cycle grows with amplitude to the power chi + 3.

# %%
u = np.geomspace(1e-3, 1e-1, 20) * joint.phi_max
slope = np.polyfit(np.log(u), np.log(joint.dissipation(u)), 1)[0]
print(f"slope {slope:.3f}, chi + 3 = {joint.chi + 3:.3f}")
assert abs(slope - (joint.chi + 3)) < 1e-9

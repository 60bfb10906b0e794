# %% [markdown]
# # Uncertainty, and what cannot be identified
# A ring-down in micro-slip never shows where the joint slips altogether. What such a record tells, and what it leaves open.

# %%
import os

import emcee
import numpy as np
from matplotlib import pyplot

import iwan

truth = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
mode = iwan.Mode(frequency=124.0, joint=truth, damping_ratio=1e-3)
start = (0.3 * truth.phi_max, 0.0)
quiet = iwan.simulate(mode, dt=2e-4, duration=0.6, initial=start, method="half-cycle").acceleration
quiet = quiet + 1e-3 * np.abs(quiet).max() * np.random.default_rng(2).standard_normal(quiet.size)

# %% [markdown]
# Profile likelihood: the power chi is known, the slip force has no upper bound.

# %%
fit = iwan.fit(quiet, dt=2e-4)
print(fit)
assert not fit.identifiable["f_s"] and not fit.identifiable["beta"]

# %% [markdown]
# The same by a posterior. Flat in the logarithms of K_T, F_S and beta within a wide box: without the box F_S and beta would
# wander off, for the record does not hold them.

# %%
likelihood = iwan.log_likelihood(fit)
i, j = likelihood.names.index("log_f_s"), likelihood.names.index("log_beta")
box = np.array([[np.log(1.0), np.log(1e6)], [np.log(1e-3), np.log(1e2)]])


def log_posterior(theta: np.ndarray) -> np.ndarray:
    inside = np.all((theta[:, [i, j]] > box[:, 0]) & (theta[:, [i, j]] < box[:, 1]), axis=1)
    logs = np.full(len(theta), -np.inf)
    if inside.any():
        logs[inside] = likelihood(theta[inside])
    return logs


walkers, draws = 100, int(os.environ.get("IWAN_DRAWS", "1000"))  # 100 x 1000: 1e5 samples
start = likelihood.walkers(walkers)
sampler = emcee.EnsembleSampler(walkers, start.shape[1], log_posterior, vectorize=True)
sampler.random_state = np.random.RandomState(3).get_state()
sampler.run_mcmc(start, draws)
posterior = likelihood.to_arviz(sampler).posterior
print(posterior)

# %% [markdown]
# The ridge: F_S and beta go together, over decades.

# %%
samples = sampler.get_chain(discard=draws // 2, flat=True)
figure, axes = pyplot.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
axes[0].plot(samples[:, i] / np.log(10), samples[:, j] / np.log(10), ",")
axes[0].set(xlabel="log10 F_S", ylabel="log10 beta")
iwan.plot.profile(fit, "f_s", ax=axes[1])
iwan.plot.profile(fit, "chi", ax=axes[2])
figure.savefig("uncertainty.png")

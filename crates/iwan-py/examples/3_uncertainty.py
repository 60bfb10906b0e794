# %% [markdown]
# # Uncertainty, and what cannot be identified
# A ring-down in micro-slip never shows where the joint slips altogether. What such a record tells, and what it leaves open.

# %%
import os
import time

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
# The same by a posterior. In micro-slip the record holds chi and the stiffness that has slipped away at its amplitudes,
# K_T - F(u)/u = R u^(chi+1) / ((chi+1) (chi+2)); to every K_T and beta belongs a slip force that leaves it as it is, and the
# likelihood with it, as long as macro-slip begins beyond the record. A walker on such a ridge goes far by this stiffness c as
# coordinate in place of F_S, where the ridge is straight.

# %%
likelihood = iwan.log_likelihood(fit)
h, i, k, j = (likelihood.names.index(name) for name in ("log_k_t", "log_f_s", "chi", "log_beta"))
u = np.median(fit.curves["displacement"])


def straight_to_theta(y: np.ndarray) -> np.ndarray:
    theta, k_t, c, beta, chi = y.copy(), np.exp(y[:, h]), np.exp(y[:, i]), np.exp(y[:, j]), y[:, k]
    phi_max = u * (k_t / (c * (chi + 2) * (1 + beta))) ** (1 / (chi + 1))
    theta[:, i] = np.log(k_t * phi_max * (beta + (chi + 1) / (chi + 2)) / (1 + beta))
    return theta


# %% [markdown]
# Flat in the logarithms of K_T, F_S and beta within a wide box: without the box F_S and beta would wander off, for the record
# does not hold them. At given chi, log F_S changes by 1/(chi+1) times as much as log c.

# %%
box = np.array([[np.log(1.0), np.log(1e6)], [np.log(1e-3), np.log(1e2)]])


def log_posterior(y: np.ndarray) -> np.ndarray:
    logs = np.full(len(y), -np.inf)
    possible = np.flatnonzero((y[:, k] > -0.99) & (y[:, k] < 0.99))
    theta = straight_to_theta(y[possible])
    inside = np.all((theta[:, [i, j]] > box[:, 0]) & (theta[:, [i, j]] < box[:, 1]), axis=1)
    if inside.any():
        logs[possible[inside]] = likelihood(theta[inside]) - np.log1p(theta[inside, k])
    return logs


walkers, draws = 100, int(os.environ.get("IWAN_DRAWS", "1000"))  # 100 x 1000: 1e5 samples
rng, many = np.random.default_rng(3), 60 * walkers
start = likelihood.walkers(many, spread=1e-5)
best = likelihood.best.copy()
best[i] = np.log(fit.joint.r * u ** (fit.joint.chi + 1) / ((fit.joint.chi + 1) * (fit.joint.chi + 2)))
start[:, k] = fit.joint.chi + 1e-3 * rng.standard_normal(many)
start[:, h] += rng.uniform(-0.5, 2.0, many)
start[:, i] = best[i] + 1e-3 * rng.standard_normal(many)
start[:, j] = rng.uniform(*box[1], many)
start = start[log_posterior(start) > likelihood(likelihood.best) - 30.0][:walkers]

began = time.perf_counter()
sampler = emcee.EnsembleSampler(walkers, start.shape[1], log_posterior, vectorize=True)
sampler.random_state = np.random.RandomState(3).get_state()
sampler.run_mcmc(start, draws)
print(f"{walkers * draws} samples in {time.perf_counter() - began:.1f} s, {np.mean(sampler.acceptance_fraction):.0%} of the steps taken")
print(likelihood.to_arviz(sampler).posterior)
assert np.mean(sampler.acceptance_fraction) > 0.15

# %% [markdown]
# At each K_T a ridge, along which F_S and beta go together over decades (lines), while chi stays where it is: what a record in
# micro-slip says of the slip force is its lower end, and the box.

# %%
samples = straight_to_theta(sampler.get_chain(discard=draws // 2, flat=True))
figure, axes = pyplot.subplots(1, 3, figsize=(14, 4), layout="constrained")
log = samples / np.log(10)
points = axes[0].scatter(log[:, i], log[:, j], c=log[:, h], s=1, linewidths=0)
figure.colorbar(points, ax=axes[0], label="log10 K_T")
for k_t in np.quantile(samples[:, h], [0.2, 0.5, 0.8]):
    ridge = np.tile(best, (50, 1))
    ridge[:, h], ridge[:, j] = k_t, np.linspace(*box[1], 50)
    ridge = straight_to_theta(ridge)
    ridge = ridge[likelihood(ridge) > likelihood(likelihood.best) - 20.0] / np.log(10)
    axes[0].plot(ridge[:, i], ridge[:, j], color="black", linewidth=0.8)
axes[0].set(xlabel="log10 F_S", ylabel="log10 beta")
iwan.plot.profile(fit, "f_s", ax=axes[1])
iwan.plot.profile(fit, "chi", ax=axes[2])
figure.savefig("uncertainty.png")
decades = np.ptp(samples[:, [i, j]], axis=0) / np.log(10)
print(f"F_S over {decades[0]:.1f} decades, beta over {decades[1]:.1f}; chi {np.mean(samples[:, k]):.3f} +- {np.std(samples[:, k]):.3f}")
assert np.all(decades > 1.0) and np.std(samples[:, k]) < 0.02

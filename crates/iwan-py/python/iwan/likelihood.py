"""The likelihood of a fit's records, for samplers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from iwan import _native
from iwan._arguments import instance
from iwan.errors import InvalidValueError, IwanError
from iwan.identification import Fit
from iwan.types import Array

if TYPE_CHECKING:
    from arviz import InferenceData

__all__ = ["LogLikelihood", "log_likelihood"]


class LogLikelihood:
    """Logarithm of the likelihood of a fit's records. Made by `iwan.log_likelihood`.

    Called with coordinates, one row or many (any shape with the last axis as long as `names`), it returns their logarithms
    (the shape without that axis), minus infinity where there is no model. Coordinates are those of the parameters that were
    not held, `k_t`, `f_s` and `beta` by their logarithms, and for each record two that say how it began. It pickles, and another process of the
    same version evaluates it to the same bits.

    >>> import emcee
    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3)
    >>> response = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(0.5 * joint.phi_max, 0.0), method="half-cycle")
    >>> likelihood = iwan.log_likelihood(iwan.fit(response.acceleration, dt=2e-4))
    >>> sampler = emcee.EnsembleSampler(20, len(likelihood.names), likelihood, vectorize=True)
    >>> _ = sampler.run_mcmc(likelihood.walkers(20), 30)
    >>> likelihood.to_arviz(sampler).posterior["chi"].shape
    (20, 30)
    """

    def __init__(self, native: Any) -> None:
        self._native = native
        self.names: list[str] = native.names
        """Names of the coordinates."""
        self.best: Array = native.best
        """Coordinates of the best fit."""

    def __call__(self, theta: ArrayLike, *, threads: int | None = None) -> Array:
        """Logarithms of the likelihood at `theta`; for emcee with `vectorize=True`."""
        return cast(Array, self._native.log(theta, threads))

    def walkers(self, count: int, *, seed: int = 0, spread: float = 1e-6) -> Array:
        """Points about the best fit where walkers may start, `count` x coordinates, all of them with a likelihood.

        Example: that of the class. Raises `iwan.InvalidValueError` when `spread`, relative, is too wide.
        """
        if _native._whole("count", count) < 1:
            raise InvalidValueError(f"count = {count} is out of range: ask for at least 1 walker")
        _native._number("spread", spread)
        _native._ask("walkers", 8 * 8 * count * len(self.names), "ask for fewer")
        rng, found = np.random.default_rng(_native._whole("seed", seed)), np.empty((0, len(self.names)))
        scale = spread * np.maximum(np.abs(self.best), 1e-3)
        for _ in range(100):
            points = self.best + scale * rng.standard_normal((4 * count, len(self.names)))
            found = np.concatenate([found, points[np.isfinite(self(points))]])
            if len(found) >= count:
                return found[:count]
        raise InvalidValueError(f"spread = {spread} is too wide: most points about the best fit have no likelihood")

    def to_arviz(self, sampler: Any, **options: Any) -> InferenceData:
        """The samples of an emcee sampler for ArviZ, by the names of the coordinates; options as in `arviz.from_emcee`.

        Example: that of the class.
        """
        try:
            import arviz
        except ImportError as error:
            raise IwanError("this needs arviz: pip install 'iwan-ringdown[posterior]'") from error
        # The library has no types.
        return cast("InferenceData", cast(Any, arviz).from_emcee(sampler, var_names=self.names, **options))


def log_likelihood(fit: Fit) -> LogLikelihood:
    """The likelihood of a fit's records as a function, fast enough for hundreds of thousands of samples.

    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3)
    >>> response = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(0.2 * joint.phi_max, 0.0), method="half-cycle")
    >>> likelihood = iwan.log_likelihood(iwan.fit(response.acceleration, dt=2e-4))
    >>> likelihood.names[:4], bool(likelihood(likelihood.best) > likelihood(likelihood.best + 0.01))
    (['frequency', 'damping_ratio', 'log_k_t', 'log_f_s'], True)
    """
    return LogLikelihood(instance("fit", fit, Fit)._again().likelihood())

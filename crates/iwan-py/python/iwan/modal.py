"""From hammer hits to modes: frequency responses, poles with standard deviations, mass-normalised shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from iwan import _native
from iwan._arguments import texts
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.types import Array, Pair

__all__ = ["ModalFit", "ModalMode", "modal_fit"]


@dataclass(frozen=True, eq=False)
class ModalMode:
    """A mode of vibration with standard deviations. Made by `modal_fit`; picklable.

    Example: that of `modal_fit`.
    """

    frequency: float
    """Undamped natural frequency, Hz."""
    damping_ratio: float
    """Damping ratio, 0.01 = 1 %."""
    frequency_sd: float
    """Standard deviation of the frequency, Hz."""
    damping_ratio_sd: float
    """Standard deviation of the damping ratio."""
    shape: Array
    """Real shape, one value for each channel."""
    shape_sd: Array
    """Standard deviations of the shape; spread of calibrations is not in them."""
    complex_shape: NDArray[np.complex128]
    """Complex shape, one value for each channel."""
    phase_collinearity: float
    """1 for a real shape, 0 for one that turns."""

    def __repr__(self) -> str:
        return f"<iwan.ModalMode: {self.frequency:.6g} Hz, {100 * self.damping_ratio:.4g} %>"


@dataclass(frozen=True, eq=False)
class ModalFit:
    """Modes of a measurement. Made by `modal_fit`; picklable.

    Example: that of `modal_fit`.
    """

    modes: Sequence[ModalMode]
    """By ascending frequency."""
    names: Sequence[str]
    """Names of the shapes' channels."""
    mass_normalised: bool
    """Whether shapes are mass-normalised; otherwise their largest value is 1."""
    band: tuple[float, float]
    """Edges of the band, Hz."""
    misfit: float
    """Root mean square of what the fit leaves over that of the responses."""
    frequency: Array
    """Lines of the responses, Hz."""
    responses: NDArray[np.complex128]
    """Frequency responses, responses x lines."""
    fitted: NDArray[np.complex128]
    """Those of the fit, responses x lines."""
    remarks: Sequence[str]
    """What is wrong with hits or channels, which modes are probably sidebands or parts of others, and which given poles moved away, in words."""

    def __repr__(self) -> str:
        return f"<iwan.ModalFit: {len(self.modes)} modes from {self.band[0]:.6g} to {self.band[1]:.6g} Hz>"


def _no_record(name: str, values: Any) -> None:
    """Refuses a record, which would lose its interval."""
    if isinstance(values, _native.Record):
        raise InvalidTypeError(f"{name} is an iwan.Record: give its samples, {name}=record.samples, and dt=record.dt")


def modal_fit(
    force: ArrayLike | None,
    responses: ArrayLike,
    dt: float,
    *,
    names: Sequence[str] | None = None,
    force_at: str | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] = "acceleration",
    estimator: Literal["h1", "h2", "hv"] = "h1",
    decay: float = 0.0,
    whole_force: bool = False,
    band: Pair | None = None,
    method: Literal["chart", "isolation", "subspace"] = "chart",
    order: int = 60,
    poles: Sequence[float] | None = None,
    add_poles: Sequence[float] = (),
    drop_poles: Sequence[float] = (),
) -> ModalFit:
    """Modes from hits of a hammer, or from free decays.

    Args:
        force: Force of each hit, (hits, samples) or (samples,); None for free decays, whose shapes have no scale.
        responses: Motions, (hits, channels, samples), or (channels, samples) for one hit.
        dt: Sampling interval, s.
        names: Name of each channel, a point or POINT:DIRECTION such as "12:+z"; None: 0, 1, ...
        force_at: Name of the channel at which the hammer hits, which makes shapes mass-normalised.
        quantity: What the sensors measure.
        estimator: How hits are averaged: noise on the responses ("h1"), on the force ("h2"), on both ("hv").
        decay: Decay of an exponential window, 1/s; its damping is not in the result.
        whole_force: Take the force as measured from end to end, noise after the pulse included, and without a pulse too.
        band: Edges in Hz; None: from ten cycles in a record to where the force has fallen by 30 dB.
        method: Where poles are looked for: stabilisation chart, mode isolation, or, of free decays, subspaces of the samples.
        order: Highest order of the chart.
        poles: Frequencies of the modes in Hz, instead of looking for them.
        add_poles: Frequencies in Hz at which modes are added to those that were found.
        drop_poles: Frequencies in Hz of modes that were found and are left out again.

    Raises:
        InvalidValueError: for values out of range and arrays that do not go together.
        IdentificationError: where a force has no pulse, and where the records hold no mode, or cannot tell modes apart.

    Source: B. Peeters et al., Shock and Vibration 11:395, 2004; M. S. Allen, J. H. Ginsberg, MSSP 20, 2006; J.-N. Juang, R. S. Pappa,
    J. Guidance 8:620, 1985; then maximum likelihood with the end of the record in the model.

    >>> import numpy as np, iwan
    >>> t = np.arange(4096) / 1024
    >>> force = np.where(np.arange(4096) == 20, 1024.0, 0.0)
    >>> s = np.maximum(t - 20 / 1024, 0.0)
    >>> tip = np.exp(-s) * np.sin(2 * np.pi * 80 * s) / (2 * np.pi * 80)
    >>> fit = iwan.modal_fit(force, [tip, 0.5 * tip], 1 / 1024, names=["tip", "root"], force_at="tip",
    ...                      quantity="displacement", band=(40, 160), order=10)
    >>> fit.modes
    [<iwan.ModalMode: 80.0002 Hz, 0.1989 %>]
    >>> round(float(fit.modes[0].shape[1] / fit.modes[0].shape[0]), 6)
    0.5
    """
    added, dropped = _native._numbers("add_poles", add_poles).ravel(), _native._numbers("drop_poles", drop_poles).ravel()
    if poles is not None and (added.size or dropped.size):
        raise InvalidValueError("poles gives all modes: leave add_poles and drop_poles out, or poles")
    _no_record("responses", responses)
    _no_record("force", force)
    request: dict[str, Any] = {
        "dt": dt,
        "names": None if names is None else texts("names", names),
        "force_at": force_at,
        "quantity": quantity,
        "estimator": estimator,
        "decay": decay,
        "whole_force": whole_force,
        "band": band,
        "method": method,
        "order": order,
        "poles": poles,
        "add_poles": added,
        "drop_poles": dropped,
    }
    found = _native._modal_fit(force, responses, request)
    return ModalFit(modes=[ModalMode(**mode) for mode in found.pop("modes")], **found)

"""Shaker's tests to the parameters of an Iwan joint: stepped-sine responses and phase-resonance backbones, ring-downs beside them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from iwan import _native
from iwan._arguments import items
from iwan._native import FourParameter, Mode, _FittedSweeps, _Identified
from iwan._six import Interval, SixParameters
from iwan.errors import InvalidTypeError
from iwan.progress import busy
from iwan.steady import Backbone, SteadyResponse
from iwan.types import Array

__all__ = ["Measurement", "SweepFit", "fit_sweeps"]

Measurement: TypeAlias = (
    str | os.PathLike[str] | Mapping[str, ArrayLike] | SteadyResponse | Sequence[SteadyResponse] | Backbone
)
"""One measurement, of one day: a file, arrays by name, or what `iwan.frf` and `iwan.backbone` return."""

Tell: TypeAlias = Callable[[int], object] | None
"""What hears from time to time that a fit is at work."""

Columns: TypeAlias = tuple[str, list[tuple[str, Any]]]


@dataclass(frozen=True, eq=False)
class SweepFit(SixParameters):
    """What a shaker's test tells about a mode, with ring-downs or without. Made by `iwan.fit(sweeps=...)`; picklable.

    Parameters are called `frequency` (Hz), `damping_ratio`, `k_t`, `f_s`, `chi` and `beta`. Measurements are counted as they were given,
    sweeps first.

    Example: that of `iwan.fit`.
    """

    mode: Mode
    """The mode with its joint, as identified: on the day of the ring-downs, or of the first measurement."""
    intervals: Mapping[str, Interval]
    """95 % interval of each parameter by profile likelihood; None: open on that side."""
    identifiable: Mapping[str, bool]
    """Whether the measurements bound a parameter on both sides."""
    adequate: bool
    """Whether one four-parameter joint with a viscous damper matches frequency and damping together."""
    grade: str
    """"matches", "usable" or "no", as in `Fit`."""
    misfit: str
    """What fits and what does not, in words and numbers."""
    slips: bool
    """Whether macro-slip is seen: without it only the least of K_T and F_S is told."""
    informed: tuple[float, float]
    """Smallest and largest amplitude of the modal displacement that was measured: beyond, a prediction leaves what the test informed."""
    drifts: Array
    """Drift of the linear frequency of each measurement, relative."""
    errors: Sequence[tuple[float, float]]
    """Relative errors of each measurement: of force and motion alike; of a backbone's frequency and of its damping."""
    other_modes: float
    """Static flexibility of all other modes, as the measured point sees it."""
    profiles: Mapping[str, tuple[Array, Array]]
    """Values and deviances of each parameter's profile likelihood."""
    limit: float
    """Deviance at the ends of the intervals."""
    notes: Sequence[str]
    """What disturbs the ring-downs, and which hits of theirs were used."""
    _again: Callable[[], _FittedSweeps] = field(repr=False)
    """Fits again what was given."""
    _fitted: _FittedSweeps | None = field(default=None, repr=False)

    def report(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the report of `iwan fit`: one self-contained HTML page with the predicted responses under the measured ones.

        `path`: where, whole or not at all; `force`: overwrite what is there. A fit that came out of a pickle is made again first, with the
        same bits.

        Raises `iwan.ExistingFileError` (a `FileExistsError`) or `iwan.FileError` (an `OSError`) when the file cannot be written.

        Example: that of the book's chapter on steady vibration.
        """
        fitted = self._again() if self._fitted is None else self._fitted
        fitted.report(path, force)

    def to_json(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Everything that was found as JSON: the text of `fit.json` of `iwan fit`, but for the names of the files beside it.

        `path`: where to write it besides, whole or not at all; None: nowhere; `force`: overwrite what is there.

        Raises as `report`.

        Example: that of the book's chapter on steady vibration.
        """
        fitted = self._again() if self._fitted is None else self._fitted
        return fitted.json(path, force)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_fitted": None}

    def __str__(self) -> str:
        """Table of the parameters with their intervals, and the verdict."""
        return "\n".join([*self.table(), self.misfit])

    def __repr__(self) -> str:
        return f"<iwan.SweepFit: {self.frequency:.6g} Hz, {self.joint}, grade {self.grade}>"


def _response(curves: Sequence[SteadyResponse], name: str) -> Columns:
    """Responses as the columns of a file; a frequency's higher harmonics are not fitted."""
    joined = {
        "frequency": [curve.frequency for curve in curves],
        "amplitude": [curve.amplitude for curve in curves],
        "phase": [curve.phase for curve in curves],
        "excitation": [curve.excitation for curve in curves],
        "level": [np.full(curve.frequency.size, curve.level) for curve in curves],
    }
    return name, [(column, np.concatenate(values)) for column, values in joined.items()]


def _source(given: Measurement, name: str, kind: str) -> Any:
    """A measurement as the compiled part takes it."""
    if isinstance(given, (str, os.PathLike)):
        return given
    if isinstance(given, Mapping):
        return name, [(str(column), _native._numbers(f"{name}['{column}']", values)) for column, values in given.items()]
    if kind == "backbone" and isinstance(given, Backbone):
        columns = {"frequency": given.frequency, "amplitude": given.amplitude, "damping_ratio": given.damping_ratio}
        return name, list(columns.items())
    curves = [given] if isinstance(given, SteadyResponse) else given
    if kind == "sweep" and isinstance(curves, Sequence) and curves and all(isinstance(c, SteadyResponse) for c in curves):
        return _response(list(curves), name)
    wanted = "an iwan.Backbone" if kind == "backbone" else "an iwan.SteadyResponse, a sequence of them"
    raise InvalidTypeError(f"{name} must be a path, a mapping of arrays by name, or {wanted}, not {type(given).__name__}")


def _sources(given: Measurement | Sequence[Measurement] | None, name: str, kind: str) -> list[Any]:
    if given is None:
        return []
    if isinstance(given, (str, os.PathLike, Mapping, SteadyResponse, Backbone)):
        return [_source(given, name, kind)]
    return [_source(one, f"{name}[{i}]", kind) for i, one in enumerate(items(name, given))]


def _fit(
    given: tuple[list[Any], list[Any]],
    forces: list[float],
    mass: float | None,
    held: Mapping[str, float],
    ring_downs: Callable[[Tell], _Identified] | None,
    tell: Tell = None,
) -> _FittedSweeps:
    identified = None if ring_downs is None else ring_downs(tell)
    return _native._fit_sweeps(*given, forces, mass, held, identified, tell)


def fit_sweeps(
    sweeps: Measurement | Sequence[Measurement] | None,
    backbones: Measurement | Sequence[Measurement] | None,
    levels: Sequence[float] | None,
    mass: float | None,
    hold: Mapping[str, float] | None,
    ring_downs: Callable[[Tell], _Identified] | None,
    notes: Sequence[str],
    progress: bool | None,
) -> SweepFit:
    """`iwan.fit` with sweeps or backbones."""
    held = {} if hold is None else hold
    given = _sources(sweeps, "sweeps", "sweep"), _sources(backbones, "backbones", "backbone")
    forces = [] if levels is None else _native._numbers("levels", levels).ravel().tolist()
    again = partial(_fit, given, forces, mass, held, ring_downs)
    with busy(progress, "fitting") as tell:
        fitted = again(tell)
    told = fitted.told()
    p = told.pop("parameters")
    joint = FourParameter(k_t=p["k_t"], f_s=p["f_s"], chi=p["chi"], beta=p["beta"])
    mode = Mode(frequency=p["frequency"], joint=joint, damping_ratio=p["damping_ratio"])
    bounded = {name: name not in held and None not in ends for name, ends in told["intervals"].items()}
    return SweepFit(mode=mode, identifiable=bounded, notes=list(notes), _again=again, _fitted=fitted, **told)

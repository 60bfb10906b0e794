"""From records to the parameters of an Iwan joint, with intervals and a verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from os import PathLike
from typing import Any, Literal, cast, overload

import numpy as np
from numpy.typing import ArrayLike

from iwan._native import (
    Coulomb,
    Envelope,
    FiveParameter,
    FourParameter,
    Jenkins,
    Mode,
    ModeCurves,
    Part,
    Pinning,
    PowerDamping,
    Record,
    Spring,
    _check_law,
    _identify,
    _Identified,
)
from iwan._arguments import chosen, texts
from iwan._six import Interval, SixParameters
from iwan._stretches import Stretches, several, stretches
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.progress import busy
from iwan.sweeps import Measurement, SweepFit, fit_sweeps
from iwan.types import Array, EnvelopeMethod, Pair

__all__ = ["Fit", "fit"]


@dataclass(frozen=True, eq=False)
class Fit(SixParameters):
    """What records tell about a mode. Made by `iwan.fit`; picklable.

    Parameters are called `frequency` (Hz), `damping_ratio`, `k_t`, `f_s`, `chi` and `beta`. Curves hold one entry per cycle
    of all records: `record` (its number from 0), `t` (s), `displacement` (amplitude), `frequency` (Hz), `damping_ratio`,
    `dissipation` (per cycle), `force` (on `force_axis`), `frequency_sd`, `log_dissipation_sd`.
    """

    mode: Mode
    """The mode with its joint, as identified."""
    intervals: Mapping[str, Interval]
    """95 % interval of each parameter by profile likelihood; None: open on that side."""
    identifiable: Mapping[str, bool]
    """Whether the records bound a parameter on both sides."""
    adequate: bool
    """Whether one four-parameter joint with a viscous damper matches frequency and damping together."""
    grade: str
    """How well it describes the records: "matches" (within noise, or within what repeated hits differ by), "usable" (misses more,
    but is near enough to predict with inside the amplitudes seen; `misfit` has the numbers) or "no"."""
    misfit: str
    """What fits and what does not, in words and numbers."""
    joint_needed: bool
    """Whether the records need a joint at all: a linear mode with viscous damping may tell them as well."""
    words: Sequence[str]
    """What the records tell and what they cannot tell, in sentences."""
    notes: Sequence[str]
    """What was found and done."""
    curves: Mapping[str, Array]
    """Measured curves against amplitude."""
    model_curves: Mapping[str, Array]
    """The same curves of the model's ring-downs."""
    force_axis: str
    """Which force the curves hold: "modal" (omega^2 q) or "joint" ((omega^2 - K_inf) q)."""
    envelopes: Sequence[Envelope]
    """Envelope of each record."""
    profiles: Mapping[str, tuple[Array, Array]]
    """Values and deviances of each parameter's profile likelihood."""
    limit: float
    """Deviance at the ends of the intervals."""
    relative_residual: float
    """Root mean square of all residuals over that of the records."""
    law: str | None
    """Name of the simplest law that is as good as the best, or of the one that was asked for; None where laws could not be compared."""
    law_words: str
    """That law in a sentence, or why there is none."""
    laws: Sequence[Mapping[str, Any]]
    """All laws compared: `name`, `words`, `criterion` (twice the logarithm of the evidence that the best law has over it),
    `dissipation_misfit` (root mean square, of ln D), `frequency_misfit` (Hz), `held_out_dissipation` and `held_out_frequency` (the same of
    thirds of the amplitudes that the law was not fitted to; None where the records saw too few), `dissipation_discrepancy` and `frequency_discrepancy` (what
    it misses beside noise as estimated with it; standard deviations, relative and in Hz), `grade`, `parameters` and `intervals` by name."""
    backbone: Mapping[str, Array]
    """Smooth curves with bands of 95 %, of several hits those of a further hit: `amplitude`, `frequency` (Hz), `damping_ratio`, `frequency_low`, `frequency_high`,
    `damping_ratio_low`, `damping_ratio_high`; empty where laws could not be compared. They reach from the smallest to the largest amplitude that was measured,
    less ends at which the damping may be zero."""
    _records: Sequence[Any] = field(repr=False)
    _request: Mapping[str, Any] = field(repr=False)
    """Records and arguments, to identify again."""
    _identified: _Identified | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        return f"<iwan.Fit: {self.frequency:.6g} Hz, {self.joint}, grade {self.grade}>"

    @property
    def law_mode(self) -> Mode:
        """The mode by the law `law`. Raises `iwan.InvalidValueError` where there is none.

        Example: that of `iwan.fit`.
        """
        for found in self.laws:
            if found["name"] == self.law:
                return _mode_of_law(found["parameters"])
        raise InvalidValueError(f"there is no mode by the law {self.law!r}: {self.law_words}")

    @property
    def curve_mode(self) -> Mode:
        """The mode by its smooth curves, without a law. Raises `iwan.InvalidValueError` where there are none.

        It can begin at any amplitude up to `backbone["amplitude"][-1]`: that at the first sample of the loudest free decay, where its damping is
        told.

        Example: that of `iwan.fit`.
        """
        if not self.backbone:
            raise InvalidValueError(f"there is no mode by curves: {self.law_words}")
        b = self.backbone
        damping = np.clip(b["damping_ratio"], 0.0, 0.99)
        return Mode(curves=ModeCurves(amplitude=b["amplitude"], frequency=b["frequency"], damping_ratio=damping))

    def __str__(self) -> str:
        """Table of the parameters with their intervals, and what the records tell."""
        return "\n".join([*self.table(), *self.words])

    def report(
        self, path: str | PathLike[str], *, names: Sequence[str] | None = None, force: bool = False
    ) -> None:
        """Write the report of `iwan fit`: one self-contained HTML page with tables, intervals and figures.

        `path`: where, whole or not at all; `names`: what the records are called in it; `force`: overwrite what is there.

        Raises `iwan.ExistingFileError` (a `FileExistsError`) or `iwan.FileError` (an `OSError`) when the file cannot be written,
        `iwan.InvalidValueError` for names that are not one per record.

        Example: that of `examples/2_fit_of_a_record.py`.
        """
        self._again().report(path, None if names is None else texts("names", names), self.force_axis, force)

    def to_json(
        self, path: str | PathLike[str] | None = None, *, names: Sequence[str] | None = None, force: bool = False
    ) -> str:
        """Everything that was found as JSON: the text of `fit.json` of `iwan fit`, but for the names of the files beside it.

        `path`: where to write it besides, whole or not at all; None: nowhere; `names`: what the records are called in it; `force`: overwrite
        what is there.

        Raises as `report`.

        Example: that of `examples/2_fit_of_a_record.py`.
        """
        return self._again().json(path, None if names is None else texts("names", names), self.force_axis, self.law, force)

    def _again(self) -> _Identified:
        """What the compiled part knows; a fit that came out of a pickle is identified again, with the same bits."""
        return _identify(self._records, self._request) if self._identified is None else self._identified

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_identified": None}


def _mode_of_law(p: Mapping[str, float]) -> Mode:
    """The mode that the parameters of a law make, by their names."""
    joint: FiveParameter | FourParameter | Jenkins | None = None
    if "theta" in p:
        joint = FiveParameter(k_t=p["k_t"], f_s=p["f_s"], chi=p["chi"], beta=p["beta"], theta=p["theta"])
    elif "chi" in p:
        joint = FourParameter(k_t=p["k_t"], f_s=p["f_s"], chi=p["chi"], beta=p["beta"])
    elif "k_t" in p:
        joint = Jenkins(k_t=p["k_t"], f_s=p["f_s"])
    parts: list[Part] = []
    if "coulomb_force" in p:
        parts.append(Coulomb(force=p["coulomb_force"]))
    if "quadratic_c" in p:
        parts.append(PowerDamping(c=p["quadratic_c"], n=2.0))
    if "damping_c" in p:
        parts.append(PowerDamping(c=p["damping_c"], n=p["damping_n"]))
    if "cubic_k" in p:
        parts.append(Spring(k=p["cubic_k"], exponent=3.0))
    if "spring_k" in p:
        parts.append(Spring(k=p["spring_k"], exponent=p["spring_exponent"]))
    if "pinning_k" in p:
        parts.append(Pinning(k=p["pinning_k"], gap=p["pinning_gap"]))
    return Mode(frequency=p["frequency"], joint=joint, damping_ratio=p["damping_ratio"], parts=parts)


@overload
def fit(
    record: Record | ArrayLike | Sequence[Record | ArrayLike],
    *,
    dt: float | None = None,
    channel: str | int | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] | None = None,
    shape: Sequence[float] | None = None,
    mass: float | None = None,
    band: Pair | None = None,
    near: float | None = None,
    mode: float | None = None,
    method: EnvelopeMethod = "hilbert",
    filter_order: int = 3,
    window: Pair | None = None,
    order: int | None = None,
    start: float | None = None,
    stop: float | None = None,
    hits: Literal["all", "first"] | int = "all",
    force_axis: Literal["modal", "joint"] = "modal",
    hold: Mapping[str, float] | None = None,
    law: str | None = None,
    progress: bool | None = None,
) -> Fit: ...
@overload
def fit(
    record: Record | ArrayLike | Sequence[Record | ArrayLike] | None = None,
    *,
    sweeps: Measurement | Sequence[Measurement],
    backbones: Measurement | Sequence[Measurement] | None = None,
    levels: Sequence[float] | None = None,
    dt: float | None = None,
    channel: str | int | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] | None = None,
    shape: Sequence[float] | None = None,
    mass: float | None = None,
    band: Pair | None = None,
    near: float | None = None,
    mode: float | None = None,
    method: EnvelopeMethod = "hilbert",
    filter_order: int = 3,
    window: Pair | None = None,
    order: int | None = None,
    start: float | None = None,
    stop: float | None = None,
    hits: Literal["all", "first"] | int = "all",
    hold: Mapping[str, float] | None = None,
    progress: bool | None = None,
) -> SweepFit: ...
@overload
def fit(
    record: Record | ArrayLike | Sequence[Record | ArrayLike] | None = None,
    *,
    sweeps: None = None,
    backbones: Measurement | Sequence[Measurement],
    levels: Sequence[float] | None = None,
    dt: float | None = None,
    channel: str | int | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] | None = None,
    shape: Sequence[float] | None = None,
    mass: float | None = None,
    band: Pair | None = None,
    near: float | None = None,
    mode: float | None = None,
    method: EnvelopeMethod = "hilbert",
    filter_order: int = 3,
    window: Pair | None = None,
    order: int | None = None,
    start: float | None = None,
    stop: float | None = None,
    hits: Literal["all", "first"] | int = "all",
    hold: Mapping[str, float] | None = None,
    progress: bool | None = None,
) -> SweepFit: ...
def fit(
    record: Record | ArrayLike | Sequence[Record | ArrayLike] | None = None,
    *,
    sweeps: Measurement | Sequence[Measurement] | None = None,
    backbones: Measurement | Sequence[Measurement] | None = None,
    levels: Sequence[float] | None = None,
    dt: float | None = None,
    channel: str | int | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] | None = None,
    shape: Sequence[float] | None = None,
    mass: float | None = None,
    band: Pair | None = None,
    near: float | None = None,
    mode: float | None = None,
    method: EnvelopeMethod = "hilbert",
    filter_order: int = 3,
    window: Pair | None = None,
    order: int | None = None,
    start: float | None = None,
    stop: float | None = None,
    hits: Literal["all", "first"] | int = "all",
    force_axis: Literal["modal", "joint"] = "modal",
    hold: Mapping[str, float] | None = None,
    law: str | None = None,
    progress: bool | None = None,
) -> Fit | SweepFit:
    """Identify the parameters of a mode with a four-parameter Iwan joint and a viscous damper.

    `record`: a `Record` or a bare array (samples, or channels x samples) with `dt` (s), or a list of them: the force levels
    of one structure, fitted together. Several channels are combined by `shape`, the mode's values at the channels
    (mass-normalised), or else by the shape that dominates in the band; `channel` chooses one. `mass`: modal mass of records that
    are not mass-normalised. `quantity`: goes before what the record says. `band`, `near`, `mode`, `method`, `filter_order`, `window`,
    `order`: as in `iwan.envelope`. `start`, `stop`: only the samples between these times (s, on the record's own clock). `hits`: which
    hits of a record that holds several (`Record.hits`): all, each as a record of its own, the first, or a number counted from 1. `force_axis`: of the curves. `hold`: parameters that keep a value, such as
    `{"damping_ratio": 0.0}`. `law`: name of the law that `Fit.law` and `Fit.law_mode` shall be of, in place of the one that the records
    favour; the book's chapter on laws has the names. `progress`: True, False, or None: where standard error is a terminal, a line says for how
    long the fit has been at work; how far it is, it cannot say.

    `sweeps`, `backbones`: a shaker's test of the mode in place of the record or beside it, one measurement for each day: a file as
    `iwan fit --sweep --backbone` reads it, a mapping with arrays `frequency` (Hz), a motion (`amplitude`, `displacement`, `velocity` or
    `acceleration`), `phase` (rad, against the force) and `excitation`, or for a backbone `frequency`, `damping_ratio` and a motion;
    or what `iwan.frf` (a list of levels is one measurement) and `iwan.backbone` return. `levels`: force of each function of a
    universal file. The result is a `SweepFit` then; `law` and `force_axis` are for ring-downs alone.

    Start values off the curves, least squares on the curves, refinement on the records by simulation, profile likelihood
    (Sec. 2.4, 2.5 and 4.4 of the paper, completed). The interpreter's lock is released; Ctrl-C is honoured. Raises
    `iwan.IdentificationError` where the record does not allow it, `iwan.InvalidValueError`.

    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3)
    >>> response = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(0.2 * joint.phi_max, 0.0), method="half-cycle")
    >>> found = iwan.fit(response.acceleration, dt=2e-4)
    >>> print(found.adequate, f"{found.joint.chi:.2f}", found.identifiable["chi"], found.identifiable["f_s"])
    True -0.18 True False
    >>> by_law = iwan.fit(response.acceleration, dt=2e-4, law="separate-powers").law_mode  # another law than the joint
    >>> print(f"{by_law.frequency:.1f} Hz", len(by_law.parts), found.curve_mode.frequency_at(1e-3) < 124.0)
    124.0 Hz 2 True
    >>> twice = iwan.Record([*response.acceleration, *response.acceleration], dt=2e-4)
    >>> len(iwan.fit(twice).envelopes), len(iwan.fit(twice, hits=2, mode=124.0).envelopes)
    (2, 1)
    >>> shaker = iwan.frf(mode, band=(112.0, 128.0), force=[1.0, 100.0], points=60)
    >>> together = iwan.fit(response.acceleration, dt=2e-4, sweeps=[shaker])
    >>> together.identifiable["f_s"], f"{together.joint.f_s:.0f}"
    (True, '239')
    """
    arguments = request(channel, quantity, shape, mass, band, near, mode, method, filter_order, window, order, hold)
    if law is not None:
        _check_law(law)
    chosen("force_axis", force_axis, ("modal", "joint"))
    if sweeps is not None or backbones is not None:
        if law is not None:
            raise InvalidValueError("law: laws are compared on ring-downs alone; leave it out beside sweeps and backbones")
        if force_axis != "modal":
            raise InvalidValueError("force_axis is of the curves of ring-downs: leave it out beside sweeps and backbones")
        if record is None:
            _without_a_record(arguments, start=start, stop=stop)
        pieces, ring_downs = Stretches([], []), None
        if record is not None:
            pieces = stretches(several(record), dt, start, stop, hits)
            ring_downs = partial(_identify, pieces.records, arguments)
        return fit_sweeps(sweeps, backbones, levels, mass, hold, ring_downs, pieces.notes, progress)
    if record is None:
        raise InvalidTypeError("record is missing: give a record, or a shaker's test as sweeps= or backbones=")
    pieces = stretches(several(record), dt, start, stop, hits)
    with busy(progress, "identifying") as tell:
        identified = _identify(pieces.records, arguments, tell)
    found = made(identified.told(force_axis), pieces.records, arguments, force_axis, identified)
    return by_law(replace(found, notes=[*pieces.notes, *found.notes]), law)


def _without_a_record(arguments: Mapping[str, Any], **times: float | None) -> None:
    """What a ring-down is looked at with is refused where there is none."""
    plain = {"method": "hilbert", "filter_order": 3}
    ring_down = ("channel", "quantity", "shape", "band", "near", "mode", "method", "filter_order", "window", "order")
    given = {name: arguments[name] for name in ring_down} | times
    named = [name for name, value in given.items() if value is not None and value != plain.get(name)]
    if named:
        raise InvalidValueError(f"{named[0]} is for a ring-down, and there is none: leave it out, or give a record")


def by_law(found: Fit, law: str | None) -> Fit:
    """The fit with another law than the one the records favour."""
    if law is None:
        return found
    names = [one["name"] for one in found.laws]
    if law not in names:
        said = f"could not be fitted to these records: choose from {', '.join(names)}" if names else found.law_words
        raise InvalidValueError(f"law = {law!r}: {said}")
    return replace(found, law=law)


def request(
    channel: str | int | None,
    quantity: str | None,
    shape: Sequence[float] | None,
    mass: float | None,
    band: Pair | None,
    near: float | None,
    mode: float | None,
    method: str,
    filter_order: int,
    window: Pair | None,
    order: int | None,
    hold: Mapping[str, float] | None,
) -> dict[str, Any]:
    """The arguments of a fit as the compiled part takes them."""
    return {
        "channel": channel,
        "quantity": quantity,
        "shape": shape,
        "mass": mass,
        "band": band,
        "near": near,
        "mode": mode,
        "method": method,
        "filter_order": filter_order,
        "window": window,
        "order": order,
        "hold": {} if hold is None else hold,
    }


def made(
    told: dict[str, Any],
    records: Sequence[Any],
    asked: Mapping[str, Any],
    force_axis: str,
    identified: _Identified | None,
) -> Fit:
    """A fit of what the compiled part tells."""
    p = told.pop("parameters")
    joint = FourParameter(k_t=p["k_t"], f_s=p["f_s"], chi=p["chi"], beta=p["beta"])
    mode = Mode(frequency=p["frequency"], joint=joint, damping_ratio=p["damping_ratio"])
    bounded = {
        name: name not in asked["hold"] and None not in interval for name, interval in told["intervals"].items()
    }
    told.pop("dissipation_misfit"), told.pop("frequency_misfit")
    return Fit(
        mode=mode,
        identifiable=bounded,
        force_axis=force_axis,
        _records=records,
        _request=asked,
        _identified=identified,
        **told,
    )

"""Modes that may share joints, from records of several modes at once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from iwan import _native
from iwan._native import FourParameter, Mode, Record, _FittedCoupled
from iwan._stretches import disturbed, several, stretches
from iwan.coupled import CoupledModes, SharedJoint
from iwan.errors import InvalidValueError
from iwan.progress import Progress, bar
from iwan.records import as_record
from iwan.types import Array, EnvelopeMethod, Pair
from iwan.updating import Estimate

__all__ = ["CoupledFit", "fit_coupled"]

_PARTS = 1000
"""What progress counts to."""


@dataclass(frozen=True, eq=False)
class CoupledFit:
    """Modes with the joints that they share or do not, as records have them. Made by `fit_coupled`; picklable.

    Example: that of `fit_coupled`.
    """

    chosen: str
    """The model to take: "linear", "uncoupled", "shared 1" or "shared 2"."""
    modes: Sequence[Mode]
    """Stuck modes of that model, called "mode 1", "mode 2" and so on in the order they were asked for."""
    joints: Sequence[SharedJoint]
    """Its joints: one for each mode where the modes do not share any, none where they are linear. A joint's slip is 1 in a unit
    displacement of the first mode that moves it."""
    shape_at_sensor: Sequence[float]
    """Shape of each mode at the sensor that sees their sum; 1 where shapes were given."""
    estimates: Mapping[str, Estimate]
    """Values with 95 % intervals by name, such as "frequency of mode 1", "k_t of joint", "participation of mode 2 in joint"."""
    told: Sequence[tuple[float | None, str]]
    """Combinations of the unknowns in words with their standard deviations, the best told first; None: not told."""
    models: Sequence[Mapping[str, Any]]
    """All models: `name`, `joints`, `unknowns`, `criterion` (Schwarz's; 0 is best, 10 more speak clearly against a model), `misfit` and
    `held_out_misfit` (root mean square over that of the records), both by record and mode in `misfits` and `held_out`, `converged`."""
    in_words: Sequence[str]
    """What was found, in sentences."""
    warnings: Sequence[str]
    """What disturbs the records, what they do not hold and what was assumed, in sentences."""
    initial: Sequence[tuple[Array, Array]]
    """Displacements and velocities of the modes at the first sample of each record fitted; 0 under a force."""
    measured: Sequence[Array]
    """What was compared: for each record, those fitted and then those kept out, modes (or the one sensor) x samples. A free decay begins behind
    its blow, and records end where the modes sink into noise."""
    motions: Sequence[Array]
    """What the model shows in its place, shaped alike."""
    _again: Callable[[], _FittedCoupled] = field(repr=False)
    """Fits again what was given."""
    _fitted: _FittedCoupled | None = field(default=None, repr=False)

    @property
    def model(self) -> CoupledModes:
        """The chosen model, ready to simulate. Raises `iwan.InvalidValueError` where it is linear: then `modes` are all."""
        return CoupledModes(self.modes, self.joints)

    def report(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the report of `iwan fit --coupled`: one self-contained HTML page with the models side by side.

        `path`: where, whole or not at all; `force`: overwrite what is there. A fit that came out of a pickle is made again first, with the
        same bits.

        Raises `iwan.ExistingFileError` (a `FileExistsError`) or `iwan.FileError` (an `OSError`) when the file cannot be written.

        Example: that of `fit_coupled`.
        """
        fitted = self._again() if self._fitted is None else self._fitted
        fitted.report(path, force)

    def to_json(self, path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
        """Everything that was found as JSON: the text of `fit.json` of `iwan fit --coupled`, but for the names of the files beside it.

        `path`: where to write it besides, whole or not at all; None: nowhere; `force`: overwrite what is there.

        Raises as `report`.

        Example: that of the book's chapter on modes that share joints.
        """
        fitted = self._again() if self._fitted is None else self._fitted
        return fitted.json(path, force)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_fitted": None}

    def __str__(self) -> str:
        """What was found, in sentences."""
        return "\n".join(self.in_words)

    def __repr__(self) -> str:
        misfit = next(model["misfit"] for model in self.models if model["name"] == self.chosen)
        return f"<iwan.CoupledFit: {self.chosen}, {len(self.modes)} modes, misfit {misfit:.2g}>"


Given = tuple[str, Record, Any]


def _given(
    records: Any,
    forces: Any,
    dt: float | None,
    cut: tuple[float | None, float | None],
    hits: str | int,
    names: tuple[str, str],
) -> tuple[list[Given], list[str]]:
    """Records with their forces, cut alike, and what is to be said of them."""
    word, of_forces = names
    listed = several(records)
    if forces is None:
        pieces = stretches(listed, dt, *cut, hits)
        given = [(f"{word}[{i}]", record, None) for i, record in enumerate(pieces.records)]
        return given, [f"{word}: {note}" for note in pieces.notes]
    if len(listed) == 1 and not isinstance(forces, (list, tuple)):
        forces = [forces]
    if not isinstance(forces, (list, tuple)) or len(forces) != len(listed):
        count = len(forces) if isinstance(forces, (list, tuple)) else 1
        raise InvalidValueError(f"{of_forces} must be one array for each of {len(listed)} records, but are {count}")
    struck: list[Given] = []
    notes: list[str] = []
    for i, (one, force) in enumerate(zip(listed, forces, strict=True)):
        record = as_record(one, dt=dt)
        own = force if isinstance(force, Record) else Record([force], dt=record.dt, start=record.start)
        if own.samples.shape != (1, record.samples.shape[1]):
            shape = " x ".join(str(n) for n in own.samples.shape)
            raise InvalidValueError(f"{of_forces}[{i}] has {shape} samples: give 1 x {record.samples.shape[1]}, as the record")
        if cut != (None, None):
            record, own = record.between(*cut), own.between(*cut)
        struck.append((f"{word}[{i}]", record, own.samples[0]))
        notes.extend(f"{word}[{i}]: {note}" for note in disturbed(record._overview()[1]))
    return struck, notes


def fit_coupled(
    records: Record | ArrayLike | Sequence[Record | ArrayLike],
    *,
    dt: float | None = None,
    forces: ArrayLike | Sequence[ArrayLike | Record] | None = None,
    shapes: ArrayLike | None = None,
    frequencies: Sequence[float] | None = None,
    bands: Sequence[Pair] | None = None,
    near: Sequence[float] | None = None,
    shape_at_force: Sequence[float] | None = None,
    predict: Record | ArrayLike | Sequence[Record | ArrayLike] = (),
    predict_forces: ArrayLike | Sequence[ArrayLike | Record] | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] | None = None,
    method: EnvelopeMethod = "hilbert",
    start: float | None = None,
    stop: float | None = None,
    hits: Literal["all", "first"] | int = "all",
    threads: int | None = None,
    progress: Progress = None,
) -> CoupledFit:
    """Fit modes that may share joints to records of several modes at once: `iwan fit --coupled`, with the same result to the last digit.

    `records`: a `Record` or an array (channels x samples) with `dt` (s), or a list of them. `forces`: the force at the samples of each
    record, which then begins at rest; without it the records are free decays. `shapes`: mass-normalised mode shapes, modes x channels, with
    `frequencies` (Hz) or `bands` (Hz) of the modes; without shapes the records have one channel, the sum of all modes, and `bands` or
    `near` (rough frequencies, Hz) say which. `shape_at_force`: mass-normalised shape of each mode at the force, where it is known. `predict`,
    `predict_forces`: records that are kept out and predicted. `quantity`: goes before what the records say. `method`: how modes are
    followed by themselves for the start values, as in `iwan.envelope`. `start`, `stop`, `hits`: as in `iwan.fit`; hits in one record are
    told apart in free decays alone. Results do not depend on `threads`; `progress`: as in `iwan.ensemble.simulate`, in thousandths.

    Linear modes, modes with joints of their own and modes that share one joint (two where short records ask for it) are compared by
    Schwarz's criterion; intervals are those of the profile likelihood.

    Raises `iwan.InvalidValueError` for records and modes that do not fit, `iwan.InvalidTypeError`, `iwan.IdentificationError`. The lock
    is released; Ctrl-C is honoured.

    Source: modal Iwan joints by B. J. Deaner et al., J. Vib. Acoust. 137:021001, 2015, doi:10.1115/1.4029082; the shared joint is that of
    `CoupledModes`.

    >>> import numpy as np
    >>> law = iwan.FourParameter(k_t=1500.0, f_s=20.0, chi=-0.3, beta=0.05)
    >>> modes = [iwan.Mode(frequency=f, damping_ratio=5e-4, name=name) for name, f in (("one", 20.0), ("two", 52.0))]
    >>> truth = iwan.CoupledModes(modes, [iwan.SharedJoint(joint=law, participation=[1.0, -2.5], compliance=1e-4)])
    >>> blow = iwan.Haversine(amplitude=600.0, duration=0.01)
    >>> rung = truth.simulate(force=blow, dt=1e-3, duration=1.5)
    >>> hit = [mode.acceleration for mode in rung.modes]
    >>> force = [blow.at(1e-3 * n) for n in range(1501)]
    >>> found = iwan.fit_coupled(np.array(hit), dt=1e-3, forces=np.array(force), shapes=np.eye(2), frequencies=[20.0, 52.0])
    >>> found.chosen, f"{found.joints[0].participation[1]:.1f}"
    ('shared 1', '-2.5')
    >>> found.report("shared.html")
    """
    shapes = None if shapes is None else np.atleast_2d(_native._numbers("shapes", shapes))
    if shapes is not None and near is not None:
        raise InvalidValueError("near goes without shapes: give frequencies= or bands= beside them")
    if shapes is None and frequencies is not None:
        raise InvalidValueError("frequencies go with shapes: give bands= or near= without them")
    if bands is not None and near is not None:
        raise InvalidValueError("near goes without bands: give one of them")
    cut = (start, stop)
    fitted, notes = _given(records, forces, dt, cut, hits, ("records", "forces"))
    kept_out: list[Given] = []
    if not (isinstance(predict, (list, tuple)) and len(predict) == 0):
        kept_out, more = _given(predict, predict_forces, dt, cut, hits, ("predict", "predict_forces"))
        notes += more
    asked = {
        "quantity": quantity,
        "shapes": None if shapes is None else shapes.tolist(),
        "frequencies": frequencies,
        "bands": () if bands is None else bands,
        "near": () if near is None else near,
        "method": method,
        "shape_at_force": shape_at_force,
        "threads": threads,
    }
    with bar(progress, _PARTS) as tell:
        found = _native._fit_coupled(fitted, kept_out, asked, tell)
    return _made(found, notes, partial(_native._fit_coupled, fitted, kept_out, asked, None))


def _made(found: _FittedCoupled, notes: list[str], again: Callable[[], _FittedCoupled]) -> CoupledFit:
    told, values = (json.loads(text) for text in found.told())
    modes = [
        Mode(frequency=frequency, damping_ratio=damping, shape_at_force=shape, name=name)
        for name, frequency, damping, shape in zip(
            values["modes"], values["frequency"], values["damping_ratio"], values["shape_at_force"], strict=True
        )
    ]
    names = [joint["name"] for joint in told["joints"]]

    def joint(j: int) -> SharedJoint:
        k_t, f_s, chi, beta = values["laws"][j]
        compliance = [values["compliance"][j] if i == j else 0.0 for i in range(len(names))]
        law = FourParameter(k_t=k_t, f_s=f_s, chi=chi, beta=beta)
        return SharedJoint(
            joint=law,
            participation=values["participation"][j],
            compliance=compliance,
            slip_at_force=values["slip_at_force"][j],
            name=names[j],
        )

    return CoupledFit(
        chosen=told["chosen"],
        modes=modes,
        joints=[joint(j) for j in range(len(names))],
        shape_at_sensor=values["shape_at_sensor"],
        estimates=_estimates(told),
        told=[(one["deviation"], one["combination"]) for one in told["told"]],
        models=told["models"],
        in_words=told["in_words"],
        warnings=[*notes, *told["warnings"]],
        initial=[(one[0], one[1]) for one in found.initial()],
        measured=[own for own, _ in found.motions()],
        motions=[model for _, model in found.motions()],
        _again=again,
        _fitted=found,
    )


def _estimates(told: Mapping[str, Any]) -> dict[str, Estimate]:
    """Numbers by name; those that are 1 by the choice of units, or held, are left out."""
    found = {}
    for of in [*told["modes"], *told["joints"]]:
        for what, one in of.items():
            if what == "participation":
                for mode, b in one.items():
                    found[f"participation of {mode} in {of['name']}"] = Estimate(**b)
            elif what != "name":
                found[f"{what} of {of['name']}"] = Estimate(**one)
    return {name: one for name, one in found.items() if one.low is None or one.low != one.high}

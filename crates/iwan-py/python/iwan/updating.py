"""Joints of a structure from frequency and damping of several modes, and from blows on several points."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from iwan import _native
from iwan._arguments import texts
from iwan._native import FourParameter
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.identification import Fit
from iwan.progress import Progress, bar
from iwan.structure import StaticCurves, Structure
from iwan.types import Array

__all__ = ["ComparedBlow", "ComparedCurve", "Estimate", "StructureUpdate", "UpdatedJoints", "update"]

_PARTS = 1000
"""What progress counts to."""


@dataclass(frozen=True)
class Estimate:
    """A value with its 95 % interval by profile likelihood. Example: that of `update`."""

    value: float
    """The best value."""
    low: float | None
    """Lower end; None is open."""
    high: float | None
    """Upper end; None is open."""
    identifiable: bool
    """Whether the curves bound it on both sides."""


@dataclass(frozen=True)
class UpdatedJoints:
    """Joints that share one law, as the curves have it. Made by `update`. Example: that of `update`."""

    name: str
    """Name of the group."""
    joints: Sequence[str]
    """Names of its joints."""
    k_t: Estimate
    """Stiffness K_T of each joint, force/length."""
    f_s: Estimate
    """Slip force F_S, force."""
    chi: Estimate
    """Power chi."""
    beta: Estimate
    """Ratio beta."""
    slip_ratio: float
    """Largest slip in the curves over phi_max: macro-slip is seen from 1 on."""

    @property
    def joint(self) -> FourParameter:
        """The law with the best values."""
        return FourParameter(k_t=self.k_t.value, f_s=self.f_s.value, chi=self.chi.value, beta=self.beta.value)


@dataclass(frozen=True, eq=False)
class ComparedCurve:
    """A measured curve beside the structure's; all arrays have one entry per amplitude. Made by `update`.

    Example: that of `update`.
    """

    mode: str
    """Name of the mode."""
    held_out: bool
    """Whether it was kept out of the fit and predicted."""
    displacement: Array
    """Modal displacements (mass^1/2 length)."""
    frequency: Array
    """Measured frequencies, Hz."""
    damping_ratio: Array
    """Measured damping ratios, 0.01 = 1 %."""
    frequency_before: Array
    """Frequencies of the structure as given, Hz; empty where no static load holds it there."""
    damping_ratio_before: Array
    """The same for the damping ratio, of its joints alone."""
    frequency_after: Array
    """Frequencies with the joints found, Hz."""
    damping_ratio_after: Array
    """The same for the damping ratio."""
    frequency_sd: Array
    """Standard deviations of `frequency_after` by what the curves leave open, Hz; nan where nothing bounds it."""
    log_damping_sd: Array
    """The same for the logarithm of the damping ratio."""
    prediction: Mapping[str, Any] | None
    """Of a curve that was kept out: `frequency_misfit` (Hz), `relative_frequency_misfit` and `damping_misfit` where each is missed most,
    `frequency_inside` and `damping_inside` (share of the amplitudes in the 95 % band; None: there is no band), and `not_predicted`, what cannot
    be predicted and why."""


@dataclass(frozen=True, eq=False)
class ComparedBlow:
    """One mode at one point under a blow beside the structure's; arrays have one entry per window. Made by `update`.

    Example: that of `update`.
    """

    source: str
    """Which record: its place in what was given."""
    point: str
    """Output of the structure, or mode."""
    mode: str
    """Mode about whose frequency both are compared."""
    held_out: bool
    """Whether the blow was kept out of the fit and predicted."""
    before: float | None
    """Root mean square of the difference over that of the record there (over 2 % of the loudest mode and point of the blow where it is
    less), with the joints as given; None where these have no motion."""
    after: float
    """The same with the joints found."""
    time: Array
    """Middles of the windows, s."""
    measured: Array
    """Measured amplitudes, in the unit of the record."""
    computed: Array
    """Those of the structure with the joints found."""


@dataclass(frozen=True, eq=False)
class StructureUpdate:
    """Joints of a structure with what is known about them. Made by `update`; picklable.

    Example: that of `update`.
    """

    groups: Sequence[UpdatedJoints]
    """Joints, group by group."""
    factors: Mapping[str, Estimate]
    """Factors on parts of the linear stiffness by name, where they were asked for."""
    viscous: Mapping[str, Estimate]
    """Viscous damping ratio of each measured mode."""
    adequate: bool
    """Whether the structure with these joints tells all curves."""
    verdict: str
    """That in words: which mode leaves the data, and at what amplitude."""
    corrections: Sequence[Mapping[str, Any]]
    """Linear corrections that would explain what is missed: `name`, `factor`, `remaining` (share of the sum of squares), `adequate`."""
    told: Sequence[Mapping[str, Any]]
    """Combinations of unknowns, the best told first: `deviation` (None: not told) and `combination` in words."""
    next_modes: Sequence[Mapping[str, Any]]
    """Modes that would tell what the curves leave open, those that would tell most first: `mode`, `frequency` (Hz), `parameter`, `remaining`,
    `displacement` (at which it is no faster than the measured modes were), `gain`."""
    measure_next: str
    """That in words: also why no mode is named. Empty without curves."""
    front: Sequence[tuple[float, float]]
    """Best compromises: misfit of frequency over its measured shift, and of the logarithm of damping."""
    curves: Sequence[ComparedCurve]
    """Measured curves beside the structure's."""
    blows: Sequence[ComparedBlow]
    """Blows beside the structure's, where joints were found from blows."""
    converged: bool
    """Whether the search ended by itself."""
    text: str | None
    """Text of the structure file with the joints found; None for structures of matrices, whose paths are relative."""

    def write(self, path: str | Path) -> None:
        """Write the structure file with the joints found, for `iwan.Structure.load`. Example: that of `iwan.update`.

        Raises `iwan.InvalidValueError` where there is no such text, `iwan.ExistingFileError` (a `FileExistsError`) or `iwan.FileError` (an
        `OSError`) where the file is there already or cannot be written.
        """
        if self.text is None:
            raise InvalidValueError("the structure is one of matrices: enter the values by hand")
        _native._write_text(path, self.text, False)

    def __repr__(self) -> str:
        verdict = "tells all curves" if self.adequate else "leaves the data"
        return f"<iwan.StructureUpdate: {len(self.groups)} groups of joints, {len(self.curves)} curves, {verdict}>"


Curve: TypeAlias = Mapping[str, ArrayLike] | Fit | StaticCurves


def _columns(mode: str, curve: Curve) -> tuple[bool, ArrayLike, ArrayLike, ArrayLike]:
    if isinstance(curve, StaticCurves):
        q, frequency, loss = curve.displacement, curve.frequency, curve.dissipation
        return True, q, frequency, loss / (2 * np.pi * (2 * np.pi * frequency * q) ** 2)
    columns = curve.curves if isinstance(curve, Fit) else curve
    if not isinstance(columns, Mapping):
        raise InvalidTypeError(
            f"curves['{mode}'] must be an iwan.Fit, an iwan.StaticCurves, or a mapping with displacement, frequency and damping_ratio"
        )
    for key in ("displacement", "frequency", "damping_ratio"):
        if key not in columns:
            raise InvalidValueError(f"curves['{mode}'] has no '{key}': it has {', '.join(map(str, columns))}")
    return False, columns["displacement"], columns["frequency"], columns["damping_ratio"]


def _listed(
    curves: Mapping[str, Curve | Sequence[Curve]], held_out: bool
) -> list[tuple[str, str, bool, bool, ArrayLike, ArrayLike, ArrayLike]]:
    if not isinstance(curves, Mapping):
        raise InvalidTypeError("curves must be a mapping from modes to curves")
    listed = []
    for mode, given in curves.items():
        several = list(given) if isinstance(given, (list, tuple)) else [given]
        for curve in several:
            listed.append((mode, "predict" if held_out else "curves", held_out, *_columns(mode, cast("Curve", curve))))
    return listed


def _blows(
    records: Sequence[Mapping[str, ArrayLike]], held_out: bool
) -> list[tuple[str, bool, float, ArrayLike, list[tuple[str, ArrayLike]]]]:
    word = "predict_records" if held_out else "records"
    if isinstance(records, Mapping) or not isinstance(records, Sequence):
        raise InvalidTypeError(f"{word} must be a sequence of mappings with dt, force and motions")
    listed = []
    for i, given in enumerate(records):
        if not isinstance(given, Mapping):
            raise InvalidTypeError(f"{word}[{i}] must be a mapping with dt, force and motions, not {type(given).__name__}")
        for key in ("dt", "force"):
            if key not in given:
                raise InvalidValueError(f"{word}[{i}] has no '{key}': it has {', '.join(map(str, given))}")
        motions = [(name, samples) for name, samples in given.items() if name not in ("dt", "force")]
        listed.append((f"{word}[{i}]", held_out, _native._number(f"{word}[{i}]['dt']", given["dt"]), given["force"], motions))
    return listed


def update(
    structure: Structure,
    curves: Mapping[str, Curve | Sequence[Curve]] | None = None,
    *,
    records: Sequence[Mapping[str, ArrayLike]] = (),
    predict_records: Sequence[Mapping[str, ArrayLike]] = (),
    modes: Sequence[str] | None = None,
    quantity: Literal["acceleration", "velocity", "displacement"] = "acceleration",
    predict: Mapping[str, Curve | Sequence[Curve]] | None = None,
    groups: Mapping[str, Sequence[str]] | None = None,
    correct: Mapping[str, float | None] | Sequence[str] = (),
    undamped: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> StructureUpdate:
    """Find the joints of a structure from frequency and damping of several of its modes against amplitude, or from blows.

    `curves`: by the structure's name of the mode, one curve or several: an `iwan.Fit`, an `iwan.StaticCurves`, or a mapping with the
    arrays `displacement` (modal, mass^1/2 length), `frequency` (Hz) and `damping_ratio`. `predict`: curves that are kept out and
    predicted. `groups`: names of the joints that share one law, by the name of the group; without it those that move alike in the
    measured modes. `records`: blows on several points from rest, mappings with `dt` (s), `force` on the structure's loads, and samples by the
    names of outputs and modes of the structure, all of one `quantity`; joints are then found from the motion itself, by transients of the
    structure with all modes, the search beginning at what the curves give where there are any. `modes`: about whose frequencies records
    and structure are compared; without it those of the curves. `predict_records`: blows that are kept out and predicted. `correct`: parts of the linear stiffness that may be wrong by a factor ("material", an element set, a lump), with the
    standard deviation of its logarithm where that is known before. `undamped`: no viscous damping beside the joints. Results do not
    depend on `threads`; `progress`: as in `iwan.ensemble.simulate`, in thousandths.

    Raises `iwan.InvalidValueError` for curves, modes, joints or parts that do not fit, `iwan.InvalidTypeError`,
    `iwan.ComputationError`. The lock is released; Ctrl-C is honoured.

    Source: quasi-static curves by H. Festjens et al., Int. J. Mech. Sci. 75:170, 2013, doi:10.1016/j.ijmecsci.2013.06.010.

    >>> beam = iwan.Structure.built_in("paper-a")
    >>> measured = {mode: beam.quasi_static(mode, points=24) for mode in ("bending 1", "bending 3")}
    >>> found = iwan.update(beam, measured, undamped=True)
    >>> print(found, f"{found.groups[0].k_t.value:.3g}", found.groups[1].f_s.identifiable)
    <iwan.StructureUpdate: 2 groups of joints, 2 curves, tells all curves> 2.75e+05 False
    """
    if not isinstance(structure, Structure):
        raise InvalidTypeError("structure must be an iwan.Structure")
    blows = _blows(records, False) + _blows(predict_records, True)
    parts = correct if isinstance(correct, Mapping) else dict.fromkeys(texts("correct", correct))
    if curves is None and len(records) == 0:
        raise InvalidTypeError("curves and records are missing: give what was measured")
    given = _listed({} if curves is None else curves, False) + _listed({} if predict is None else predict, True)
    compared = texts("modes", modes) if modes is not None else list(curves or ())
    if len(records) and not compared:
        raise InvalidValueError("modes is missing: name the modes about whose frequencies records and structure are compared")
    with bar(progress, _PARTS) as tell:
        found, text = _native._update(
            structure._native,
            given,
            groups=groups,
            correct=parts,
            undamped=undamped,
            blows=blows,
            modes=compared,
            quantity=quantity,
            threads=threads,
            progress=tell,
        )
    return _made(json.loads(found), text)


def _made(told: dict[str, Any], text: str | None) -> StructureUpdate:
    keys = ("k_t", "f_s", "chi", "beta")

    def joints(group: dict[str, Any]) -> UpdatedJoints:
        return UpdatedJoints(**{**group, **{key: Estimate(**group[key]) for key in keys}})

    def compared(curve: dict[str, Any]) -> ComparedCurve:
        kept = {key: np.asarray(curve[key], dtype=np.float64) for key in ComparedCurve.__annotations__ if isinstance(curve[key], list)}
        return ComparedCurve(mode=curve["mode"], held_out=curve["held_out"], prediction=curve["prediction"], **kept)

    def struck(blow: dict[str, Any]) -> ComparedBlow:
        return ComparedBlow(**{**blow, **{key: np.asarray(blow[key], dtype=np.float64) for key in ("time", "measured", "computed")}})

    return StructureUpdate(
        groups=[joints(group) for group in told["groups"]],
        factors={name: Estimate(**estimate) for name, estimate in told["factors"]},
        viscous={name: Estimate(**estimate) for name, estimate in told["viscous"]},
        adequate=told["verdict"]["adequate"],
        verdict=told["verdict"]["in_words"],
        corrections=told["corrections"],
        told=told["told"],
        next_modes=told["next_modes"],
        measure_next=told["measure_next"],
        front=[(point["frequency"], point["damping"]) for point in told["front"]],
        curves=[compared(curve) for curve in told["curves"]],
        blows=[struck(blow) for blow in told["blows"]],
        converged=told["converged"],
        text=text,
    )

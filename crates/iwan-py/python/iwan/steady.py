"""Steady vibration of modes: forced responses and backbones by harmonic balance, exact in the continuum."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import overload

from numpy.typing import ArrayLike

from iwan import _native
from iwan._native import Mode
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.types import Array

__all__ = ["Backbone", "SteadyResponse", "backbone", "frf"]


@dataclass(frozen=True, eq=False)
class SteadyResponse:
    """Steady response of a mode at one level, along the curve, which may turn back in frequency. Made by `frf`; picklable.

    Example: that of `frf`.
    """

    control: str
    """What is held: "force", "base_acceleration", "displacement", "velocity" or "acceleration"."""
    level: float
    """Its amplitude."""
    frequency: Array
    """Frequencies of the excitation, Hz."""
    amplitude: Array
    """Amplitudes of the displacement's first harmonic."""
    phase: Array
    """Its phases against the excitation, rad: -pi/2 in resonance."""
    excitation: Array
    """Amplitudes of the force, or of the base's acceleration."""
    harmonics: Mapping[int, tuple[Array, Array]]
    """Amplitudes and phases (rad) of the harmonics 3, 5, ..., where they were asked for."""
    jumps: Sequence[tuple[float, float]]
    """Frequency (Hz) and amplitude of the points at which the curve turns back: a creeping frequency makes the response jump."""
    peak: tuple[float, float] | None
    """Frequency (Hz) and amplitude of the resonance; None on an empty curve."""
    remarks: Sequence[str]
    """What to look at, in words: no resonance in the band, where a curve ends and why."""

    def __repr__(self) -> str:
        peak = "" if self.peak is None else f", peak {self.peak[1]:.6g} at {self.peak[0]:.6g} Hz"
        return f"<iwan.SteadyResponse: {self.control} {self.level:.6g}, {len(self.frequency)} points{peak}>"


@dataclass(frozen=True, eq=False)
class Backbone:
    """Frequency and damping of a mode against its amplitude, all arrays of one entry per amplitude. Made by `backbone`; picklable.

    Example: that of `backbone`.
    """

    amplitude: Array
    """Amplitudes of the modal displacement's first harmonic (mass^1/2 length)."""
    frequency: Array
    """Frequencies, Hz."""
    damping_ratio: Array
    """Damping ratios, 0.01 = 1 %."""
    harmonics: Mapping[int, Array]
    """Amplitudes of the harmonics 3, 5, ..., where they were asked for."""
    remarks: Sequence[str]
    """Where and why the curve ends before the largest amplitude, in words."""

    def __repr__(self) -> str:
        ends = f" from {self.amplitude[0]:.6g} to {self.amplitude[-1]:.6g}" if len(self.amplitude) else ""
        return f"<iwan.Backbone: {len(self.amplitude)} amplitudes{ends}>"


def _modes(mode: Mode | Sequence[Mode]) -> tuple[list[Mode], bool]:
    if isinstance(mode, Mode):
        return [mode], True
    modes = list(mode) if isinstance(mode, Iterable) else []
    if not isinstance(mode, Iterable) or not all(isinstance(one, Mode) for one in modes):
        raise InvalidTypeError("mode must be an iwan.Mode or a sequence of them")
    if not modes:
        raise InvalidValueError("mode is an empty sequence: give at least one mode")
    return modes, False


@overload
def frf(
    mode: Mode,
    *,
    band: tuple[float, float],
    force: ArrayLike | None = None,
    base_acceleration: ArrayLike | None = None,
    displacement: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    at: str | None = None,
    harmonics: int = 1,
    points: int = 400,
    threads: int | None = None,
) -> list[SteadyResponse]: ...
@overload
def frf(
    mode: Sequence[Mode],
    *,
    band: tuple[float, float],
    force: ArrayLike | None = None,
    base_acceleration: ArrayLike | None = None,
    displacement: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    at: str | None = None,
    harmonics: int = 1,
    points: int = 400,
    threads: int | None = None,
) -> list[list[SteadyResponse]]: ...
def frf(
    mode: Mode | Sequence[Mode],
    *,
    band: tuple[float, float],
    force: ArrayLike | None = None,
    base_acceleration: ArrayLike | None = None,
    displacement: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    at: str | None = None,
    harmonics: int = 1,
    points: int = 400,
    threads: int | None = None,
) -> list[SteadyResponse] | list[list[SteadyResponse]]:
    """Steady forced responses of a mode, or of each of several modes (parameter sets), at given force or given response.

    `band`: lowest and highest frequency, Hz. Exactly one of `force`, `base_acceleration` (`shape_at_force` is the mode's
    participation then), `displacement`, `velocity`, `acceleration` is given: what a controller holds, one amplitude for each level.
    `at`: the point among the mode's outputs whose response is held or returned, by default the modal displacement. `harmonics`:
    the highest one, odd; 1 is the fundamental alone, for which each amplitude has two frequencies and nothing is iterated.
    `points`: about so many per level. `threads`: for several modes, all cores by default; the results do not depend on it.

    Returns a list of `SteadyResponse`, one per level, or a list of such lists. Raises `iwan.InvalidValueError` for a value out of
    range or a band that is none. No sliders, no samples, no start values.

    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4)
    >>> weak, strong = iwan.frf(mode, band=(112.0, 128.0), force=[1.0, 100.0])
    >>> f"{weak.peak[0]:.2f} Hz", f"{strong.peak[0]:.2f} Hz"
    ('123.74 Hz', '121.73 Hz')
    """
    levels = {
        "force": force,
        "base_acceleration": base_acceleration,
        "displacement": displacement,
        "velocity": velocity,
        "acceleration": acceleration,
    }
    given = {name: values for name, values in levels.items() if values is not None}
    if len(given) != 1:
        names = ", ".join(levels)
        raise InvalidValueError(f"{len(given)} kinds of level are given: give exactly one of {names}")
    [(control, values)] = given.items()
    modes, single = _modes(mode)
    low, high = band
    found = _native._frf(modes, control, values, (float(low), float(high)), at, harmonics, points, threads)
    curves = [[SteadyResponse(**curve) for curve in of_mode] for of_mode in found]
    return curves[0] if single else curves


@overload
def backbone(
    mode: Mode, *, amplitude: ArrayLike, harmonics: int = 1, threads: int | None = None
) -> Backbone: ...
@overload
def backbone(
    mode: Sequence[Mode], *, amplitude: ArrayLike, harmonics: int = 1, threads: int | None = None
) -> list[Backbone]: ...
def backbone(
    mode: Mode | Sequence[Mode], *, amplitude: ArrayLike, harmonics: int = 1, threads: int | None = None
) -> Backbone | list[Backbone]:
    """Frequency and damping of a mode against its amplitude, or of each of several modes (parameter sets).

    `amplitude`: modal displacements (mass^1/2 length), > 0 and ascending. `harmonics`: the highest one, odd; 1 is the closed
    form of `Mode.frequency_at` and `Mode.damping_ratio_at`. `threads`: for several modes, all cores by default.

    Returns a `Backbone`, or a list of them. Raises `iwan.InvalidValueError` for a value out of range.

    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint)
    >>> curve = iwan.backbone(mode, amplitude=[0.1 * joint.phi_max, joint.phi_max], harmonics=7)
    >>> ", ".join(f"{f:.2f} Hz" for f in curve.frequency)
    '123.70 Hz, 122.04 Hz'
    """
    modes, single = _modes(mode)
    found = [Backbone(**curve) for curve in _native._backbone(modes, amplitude, harmonics, threads)]
    return found[0] if single else found

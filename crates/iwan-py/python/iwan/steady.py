"""Steady vibration: forced responses and backbones by harmonic balance, exact in the continuum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

from numpy.typing import ArrayLike

from iwan import _native
from iwan._arguments import instance, items
from iwan._native import Mode
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.types import Array, Pair

if TYPE_CHECKING:
    from iwan.coupled import CoupledModes

__all__ = ["Backbone", "SteadyResponse", "SteadyStructure", "backbone", "frf"]


@dataclass(frozen=True, eq=False)
class SteadyResponse:
    """Steady response of a mode, of coupled modes or of a structure at one level, along the curve, which may turn back in frequency. Made by `frf`; picklable.

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
    superharmonics: Sequence[tuple[int, float, float]]
    """Superharmonic resonances: which harmonic, frequency of the excitation (Hz), amplitude of the harmonic."""
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
    """Amplitudes of the response's harmonics 3, 5, ..., where they were asked for."""
    response: Array
    """Amplitudes of the response's first harmonic: at the output of a structure, else the modal displacement itself."""
    slips: Mapping[str, Array]
    """Amplitudes of the slips' first harmonics, by the names of the joints; empty for a mode with a joint of its own."""
    remarks: Sequence[str]
    """Where and why the curve ends before the largest amplitude, in words."""

    def __repr__(self) -> str:
        ends = f" from {self.amplitude[0]:.6g} to {self.amplitude[-1]:.6g}" if len(self.amplitude) else ""
        return f"<iwan.Backbone: {len(self.amplitude)} amplitudes{ends}>"


def asked(
    band: Pair, levels: Mapping[str, ArrayLike | None], harmonics: int, points: int
) -> tuple[str, ArrayLike, Pair, int, int]:
    """A sweep as the compiled part takes it, with the one kind of level that is given."""
    given = {name: values for name, values in levels.items() if values is not None}
    if len(given) != 1:
        names = ", ".join(levels)
        raise InvalidValueError(f"{len(given)} kinds of level are given: give exactly one of {names}")
    [(control, values)] = given.items()
    return control, values, band, harmonics, points


class SteadyStructure:
    """Steady vibration of `iwan.Structure`.

    Example: that of `iwan.Structure.frf`.
    """

    _native: _native._Structure

    def frf(
        self,
        *,
        band: Pair,
        force: ArrayLike | None = None,
        base_acceleration: ArrayLike | None = None,
        displacement: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        direction: tuple[float, float, float] | None = None,
        at: str | None = None,
        damping_ratio: float = 0.0,
        basis: int | None = None,
        harmonics: int = 1,
        points: int = 400,
        threads: int | None = None,
    ) -> list[SteadyResponse]:
        """Steady forced responses of the structure with its discrete joints, one curve for each level.

        `band`, the kinds of level, `harmonics`, `points`, `threads`: as in `iwan.frf`; levels are computed on threads. The loads of the
        structure file act together; a `base_acceleration` is that of supports and grounds along `direction` (x, y, z), and responses are
        relative to them. `at`: the output whose motion is held or returned, by default the first one of the file, else where the
        loads act. `damping_ratio`: viscous ratio of all elastic modes; a structure has none of its own. `basis`: stuck modes, 50 unless
        told; attachment vectors of the slips carry the flexibility of all others.

        Raises `iwan.InvalidValueError` for a value out of range, `iwan.StructureError` for a structure without loads, an output that is
        not there, or a base that does not hold the structure.

        >>> beam = iwan.Structure.built_in("paper-a")
        >>> [curve] = beam.frf(band=(125.0, 140.0), force=[0.01], damping_ratio=1e-3, basis=20, harmonics=3)
        >>> f"{curve.peak[0]:.2f} Hz", sorted(curve.harmonics)
        ('132.27 Hz', [3])
        """
        levels = {
            "force": force,
            "base_acceleration": base_acceleration,
            "displacement": displacement,
            "velocity": velocity,
            "acceleration": acceleration,
        }
        sweep = asked(band, levels, harmonics, points)
        given = (at, damping_ratio, basis)
        curves, _ = _native._frf_structure(self._native, sweep, direction, given, threads)
        return [SteadyResponse(**curve) for curve in curves]

    def backbone(
        self,
        mode: str = "bending 1",
        *,
        amplitude: ArrayLike | None = None,
        points: int = 41,
        harmonics: int = 1,
        at: str | None = None,
        damping_ratio: float = 0.0,
        basis: int | None = None,
    ) -> Backbone:
        """Nonlinear mode of the structure: frequency, damping, harmonics and slips against the modal amplitude.

        `mode`: by its name in `modes`; `amplitude`: modal displacements (mass^1/2 length), > 0 and ascending, or `points` of them from a
        thousandth to ten times where the first joint begins macro-slip. Other arguments as in `frf`. Extended periodic motion:
        M. Krack, Computers & Structures 154:59, 2015, doi:10.1016/j.compstruc.2015.03.008.

        Raises `iwan.InvalidValueError` for a value out of range, a mode that does not exist or in which no joint slips.

        >>> beam = iwan.Structure.built_in("paper-a")
        >>> curve = beam.backbone("bending 1", amplitude=[1e-5, 1e-2], harmonics=3, basis=20)
        >>> ", ".join(f"{f:.1f} Hz" for f in curve.frequency), list(curve.slips)[0]
        ('132.3 Hz, 129.9 Hz', 'left link x')
        """
        given = (at, damping_ratio, basis)
        return Backbone(**_native._backbone_structure(self._native, mode, amplitude, points, harmonics, given))


def _modes(mode: object) -> tuple[list[Mode], bool]:
    if isinstance(mode, Mode):
        return [mode], True
    modes = items("mode", mode, "an iwan.Mode or a sequence of them")
    for i, one in enumerate(modes):
        instance(f"mode[{i}]", one, Mode)
    if not modes:
        raise InvalidValueError("mode is an empty sequence: give at least one mode")
    return modes, False


def _whole(mode: object) -> CoupledModes | SteadyStructure | None:
    """What has steady vibrations of its own, or None."""
    from iwan.coupled import CoupledModes  # which imports this module

    return mode if isinstance(mode, (CoupledModes, SteadyStructure)) else None


@overload
def frf(
    mode: Mode | CoupledModes | SteadyStructure,
    *,
    band: Pair,
    force: ArrayLike | None = None,
    base_acceleration: ArrayLike | None = None,
    displacement: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    at: str | None = None,
    harmonics: int = 1,
    points: int = 400,
    threads: int | None = None,
    **options: Any,
) -> list[SteadyResponse]: ...
@overload
def frf(
    mode: Sequence[Mode],
    *,
    band: Pair,
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
    mode: Mode | CoupledModes | SteadyStructure | Sequence[Mode],
    *,
    band: Pair,
    force: ArrayLike | None = None,
    base_acceleration: ArrayLike | None = None,
    displacement: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    at: str | None = None,
    harmonics: int = 1,
    points: int = 400,
    threads: int | None = None,
    **options: Any,
) -> list[SteadyResponse] | list[list[SteadyResponse]]:
    """Steady forced responses of a mode, or of each of several modes (parameter sets), at given force or given response; of
    `iwan.CoupledModes` or an `iwan.Structure` as their own `frf` computes them, with its further `options`.

    `band`: lowest and highest frequency, Hz. Exactly one of `force`, `base_acceleration` (`shape_at_force` is the mode's
    participation then), `displacement`, `velocity`, `acceleration` is given: what a controller holds, one amplitude for each level.
    `at`: the point among the mode's outputs whose response is held or returned, by default the modal displacement. `harmonics`:
    the highest one, odd; 1 is the fundamental alone, for which each amplitude has two frequencies and nothing is iterated.
    `points`: about so many per level. `threads`: for levels and modes, all cores by default; the results do not depend on it.

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
    if (whole := _whole(mode)) is not None:
        own: dict[str, Any] = {**levels, **options}
        return whole.frf(band=band, at=at, harmonics=harmonics, points=points, threads=threads, **own)
    if options:
        raise InvalidTypeError(f"{', '.join(options)}: these are options of structures, and modes have none of them")
    modes, single = _modes(mode)
    found = _native._frf(modes, asked(band, levels, harmonics, points), at, threads)
    curves = [[SteadyResponse(**curve) for curve in of_mode] for of_mode in found]
    return curves[0] if single else curves


@overload
def backbone(
    mode: Mode, *, amplitude: ArrayLike, harmonics: int = 1, threads: int | None = None
) -> Backbone: ...
@overload
def backbone(
    mode: CoupledModes | SteadyStructure, *, amplitude: ArrayLike | None = None, harmonics: int = 1, **options: Any
) -> Backbone: ...
@overload
def backbone(
    mode: Sequence[Mode], *, amplitude: ArrayLike, harmonics: int = 1, threads: int | None = None
) -> list[Backbone]: ...
def backbone(
    mode: Mode | CoupledModes | SteadyStructure | Sequence[Mode],
    *,
    amplitude: ArrayLike | None = None,
    harmonics: int = 1,
    threads: int | None = None,
    **options: Any,
) -> Backbone | list[Backbone]:
    """Frequency and damping of a mode against its amplitude, or of each of several modes (parameter sets); of `iwan.CoupledModes` or
    an `iwan.Structure` as their own `backbone` computes them, with its further `options` (`mode` there is `of` here).

    `amplitude`: modal displacements (mass^1/2 length), > 0 and ascending. `harmonics`: the highest one, odd; 1 is the closed
    form of `Mode.frequency_at` and `Mode.damping_ratio_at`. `threads`: for several modes, all cores by default; one curve is one
    computation.

    Returns a `Backbone`, or a list of them. Raises `iwan.InvalidValueError` for a value out of range.

    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint)
    >>> curve = iwan.backbone(mode, amplitude=[0.1 * joint.phi_max, joint.phi_max], harmonics=7)
    >>> ", ".join(f"{f:.2f} Hz" for f in curve.frequency)
    '123.70 Hz, 122.04 Hz'
    """
    if (whole := _whole(mode)) is not None:
        if "of" in options:
            options["mode"] = options.pop("of")
        if threads is not None and _native._whole("threads", threads) < 1:
            raise InvalidValueError("threads = 0 is out of range: at least 1, or None for all cores")
        return whole.backbone(amplitude=amplitude, harmonics=harmonics, **options)  # type: ignore[arg-type]
    if options:
        raise InvalidTypeError(f"{', '.join(options)}: these are options of structures, and modes have none of them")
    if amplitude is None:
        raise InvalidValueError("amplitude is missing: give modal displacements > 0 in ascending order")
    modes, single = _modes(mode)
    found = [Backbone(**curve) for curve in _native._backbone(modes, amplitude, harmonics, threads)]
    return found[0] if single else found

"""Modes that share joints: stuck modes are linear oscillators, and each joint feels the sum of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from iwan import _native
from iwan._arguments import items as items_of
from iwan._native import Joint, Mode, Pulse, Response
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.steady import Backbone, SteadyResponse, asked
from iwan.types import Array, Grid, Pair

__all__ = ["CoupledModes", "CoupledResponse", "JointHistory", "SharedJoint"]


@dataclass(frozen=True, kw_only=True)
class SharedJoint:
    """A joint that several modes move.

    `joint`: its law, in slip and force; `participation`: its slip b in a unit displacement of each mode (mass^-1/2), one
    number per mode; `compliance`: its slip rho from a unit force through the modes left out (length/force), a number >= 0,
    or one number per joint where joints share such modes; `slip_at_force`: its slip under a unit load, through the modes
    left out; `name`.

    Example: that of `CoupledModes`.
    """

    joint: Joint
    participation: Sequence[float]
    compliance: float | Sequence[float] = 0.0
    slip_at_force: float = 0.0
    name: str = "joint"


@dataclass(frozen=True, eq=False)
class JointHistory:
    """One joint in the course of a response: float64 arrays of one entry per sample. Made by `CoupledModes.simulate`.

    Example: that of `CoupledModes`.
    """

    name: str
    """Name of the joint."""
    slip: Array
    """Slip s (length)."""
    force: Array
    """Force F."""
    slip_ratio: float
    """Largest |s| over phi_max: macro-slip above 1."""
    friction: float
    """Energy that its sliders took."""
    forgotten_force: float
    """Bound on the error of its force from reversals forgotten for lack of room; 0 = exact."""


@dataclass(frozen=True, eq=False)
class CoupledResponse:
    """Response of modes that share joints. Made by `CoupledModes.simulate`.

    Example: that of `CoupledModes`.
    """

    modes: Sequence[Response]
    """One response per mode. Its energy balance is the mode's own: `friction` is the work that it did on the joints."""
    joints: Sequence[JointHistory]
    """The shared joints, then the own joints of the modes that they couple."""
    energy: Mapping[str, float]
    """Energy balance of all coupled modes and joints."""
    energy_error: float
    """What that balance does not account for, relative to the largest energy in play."""

    def __repr__(self) -> str:
        slips = ", ".join(f"{joint.name} {joint.slip_ratio:.4g}" for joint in self.joints)
        return f"<iwan.CoupledResponse: {len(self.modes)} modes, slip ratios: {slips}>"


class CoupledModes:
    """Modes that share joints.

    q_r'' + 2 zeta_r omega_r q_r' + omega_r^2 q_r + sum_j b_jr N_j = phi_r f, with s_j = sum_r b_jr q_r - sum_l rho_jl N_l
    + a_j f and N_j = F_j[s_j] - K_j s_j: the projection of a structure with discrete joints on its stuck modes, of which a
    modal Iwan joint (Deaner et al., Eq. 5) is the case of one mode.

    `modes`: a sequence of `Mode`, whose frequencies are those with all joints stuck; a joint of their own is kept beside the
    shared ones. `joints`: a sequence of `SharedJoint`.

    >>> modes = [iwan.Mode(frequency=132.35, name="bending 1"), iwan.Mode(frequency=719.6, name="bending 3")]
    >>> law = iwan.FourParameter(k_t=3.16e4, f_s=143.8, chi=-0.3, beta=0.02)
    >>> link = iwan.SharedJoint(joint=law, participation=[1.0, -4.905], compliance=9.1e-6, name="link")
    >>> blow = iwan.Haversine(amplitude=7000.0, duration=1.6e-3)
    >>> response = iwan.CoupledModes(modes, [link]).simulate(force=blow, dt=1e-5, duration=0.05)
    >>> len(response.modes[0].t), response.joints[0].slip.shape, response.energy_error < 1e-12
    (5001, (5001,), True)
    """

    modes: Sequence[Mode]
    joints: Sequence[SharedJoint]

    def __init__(self, modes: Sequence[Mode], joints: Sequence[SharedJoint]) -> None:
        self.modes, self.joints = tuple(items_of("modes", modes)), tuple(items_of("joints", joints))
        for kind, name, items in ((Mode, "modes", self.modes), (SharedJoint, "joints", self.joints)):
            if not items:
                raise InvalidValueError(f"{name} is empty: give at least one iwan.{kind.__name__}")
            if wrong := [item for item in items if not isinstance(item, kind)]:
                raise InvalidTypeError(f"{name} must be a sequence of iwan.{kind.__name__}, not {type(wrong[0]).__name__}")

    def simulate(
        self,
        *,
        force: Pulse | ArrayLike | None = None,
        dt: float,
        duration: float,
        sliders: int | None = None,
        grid: Grid | None = None,
        prewarp: bool = True,
        initial: ArrayLike | None = None,
        quality: bool = True,
        threads: int | None = None,
    ) -> CoupledResponse:
        """Simulates all modes together, by Newmark's average acceleration.

        Arguments are those of `iwan.simulate`; `sliders`: None is the exact continuum. `threads` serve modes that no joint
        couples. Raises `iwan.InvalidValueError` for a value out of range, also where so little of the structure is in the
        modes that a step has no unique solution: keep more modes, and give the joints less compliance.

        Example: that of `CoupledModes`.
        """
        told = _native._simulate_coupled(
            self.modes, self._joints(), force, dt, duration, sliders, grid, prewarp, initial, quality, threads
        )
        histories = [JointHistory(**joint) for joint in told["joints"]]
        return CoupledResponse(told["modes"], histories, told["energy"], told["energy_error"])

    def frf(
        self,
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
    ) -> list[SteadyResponse]:
        """Steady forced responses of all modes together, one curve for each level, on threads; arguments as in `iwan.frf`.

        `at`: a point among the outputs of the modes, where they superpose, or the name of a mode, whose modal displacement is the
        response then; by default that of the first mode with its resonance in the band.

        >>> modes = [iwan.Mode(frequency=132.35, name="bending 1"), iwan.Mode(frequency=719.6, name="bending 3")]
        >>> law = iwan.FourParameter(k_t=3.16e4, f_s=143.8, chi=-0.3, beta=0.02)
        >>> link = iwan.SharedJoint(joint=law, participation=[1.0, -4.905], compliance=9.1e-6, name="link")
        >>> weak, strong = iwan.CoupledModes(modes, [link]).frf(band=(125.0, 135.0), force=[0.1, 20.0], harmonics=3)
        >>> weak.peak[0] > strong.peak[0]
        True
        """
        levels = {
            "force": force,
            "base_acceleration": base_acceleration,
            "displacement": displacement,
            "velocity": velocity,
            "acceleration": acceleration,
        }
        sweep = asked(band, levels, harmonics, points)
        curves = _native._frf_coupled(self.modes, self._joints(), sweep, at, threads)
        return [SteadyResponse(**curve) for curve in curves]

    def backbone(self, mode: str | int = 0, *, amplitude: ArrayLike, harmonics: int = 1) -> Backbone:
        """Nonlinear mode that grows out of one of the modes (its name, or its place from 0); all others follow.

        `amplitude`: its modal displacements (mass^1/2 length), > 0 and ascending; `harmonics`: the highest one, odd.

        Example: that of `iwan.backbone`.
        """
        names = [one.name for one in self.modes]
        if isinstance(mode, str) and mode not in names:
            raise InvalidValueError(f"mode = '{mode}' is not known: choose one of {', '.join(names)}")
        number = names.index(mode) if isinstance(mode, str) else _native._whole("mode", mode)
        if number >= len(names):
            raise InvalidValueError(f"mode = {number} is out of range: must be from 0 to {len(names) - 1}")
        return Backbone(**_native._backbone_coupled(self.modes, self._joints(), number, amplitude, harmonics))

    def _joints(self) -> list[tuple[str, Joint, Sequence[float], list[float], float]]:
        """The joints as the compiled part takes them."""
        return [
            (joint.name, joint.joint, joint.participation, self._compliance(i), joint.slip_at_force)
            for i, joint in enumerate(self.joints)
        ]

    def _compliance(self, index: int) -> list[float]:
        given = _native._numbers("compliance", self.joints[index].compliance)
        if given.ndim == 0:
            return [float(given) if other == index else 0.0 for other in range(len(self.joints))]
        return given.ravel().tolist()

    def __repr__(self) -> str:
        names = ", ".join(joint.name for joint in self.joints)
        return f"<iwan.CoupledModes: {len(self.modes)} modes, joints: {names}>"

"""Finite-element structures with discrete Iwan joints: modes, quasi-static curves, transients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from iwan import _native
from iwan._native import FourParameter, Mode, Pulse, Record
from iwan._arguments import chosen
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.progress import Progress, bar
from iwan.steady import SteadyStructure
from iwan.types import Array, Energy, Grid

__all__ = ["StaticCurves", "Structure", "StructureModes", "StructureResponse"]

_PARTS = 1000
"""What progress counts to."""


@dataclass(frozen=True, eq=False)
class StructureModes:
    """Elastic modes of a structure. Made by `Structure.modes`; picklable.

    All arrays have one entry per mode, by ascending frequency with all joints stuck. Shapes are mass-normalised, of dimension
    mass^-1/2. Zero modes (rigid motions, parts that slide freely) are counted, not listed.
    """

    names: Sequence[str]
    """Kind of motion and number among its kind, such as "bending 1"."""
    classes: Sequence[str]
    """Kind of motion: "bending", "lateral", "torsion", "axial" or "other"."""
    frequency: Array
    """Frequency with all joints stuck, the limit of small amplitudes, Hz."""
    frequency_slipping: Array
    """Frequency of the most similar mode with all joints slipping, the limit of large amplitudes, Hz."""
    k_t: Array
    """Modal joint stiffness K_T = omega0^2 - omega_inf^2, 1/s^2; negative where slipping only frees inertia."""
    mac: Array
    """Modal assurance criterion of the stuck and the slipping shape, 1 = alike."""
    shapes: Array
    """Shapes with all joints stuck, modes x nodes x 3, read-only."""
    shapes_slipping: Array
    """Shapes with all joints slipping, modes x nodes x 3, read-only."""
    nodes: Array
    """Positions of the nodes, nodes x 3, read-only."""
    faces: NDArray[np.int64]
    """Outer faces, faces x 4, as in `Structure`."""
    shape_at_force: Array
    """Shapes at the load of the structure file: modal force = that times the force."""
    outputs: Mapping[str, Array]
    """Shapes at the outputs of the structure file, by name."""
    zero_modes: tuple[int, int]
    """Number of zero modes with all joints stuck, and with all slipping."""
    unknowns: int
    """Number of unknowns of the equations."""
    total_mass: float
    """Total mass."""
    warnings: Sequence[str]
    """What to look at, in words."""

    def index(self, name: str) -> int:
        """Number of a mode, from 0, by its name; hyphens may stand for blanks.

        Raises `iwan.InvalidValueError` with the names there are.

        >>> iwan.Structure.built_in("paper-a").modes(4).index("bending-2")
        1
        """
        if not isinstance(name, str):
            raise InvalidTypeError(f"name must be a str, not {type(name).__name__}")
        wanted = name.replace("-", " ")
        if wanted not in self.names:
            raise InvalidValueError(f"there is no mode '{name}': choose from {', '.join(self.names)}")
        return list(self.names).index(wanted)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        ends = f" from {self.frequency[0]:.6g} to {self.frequency[-1]:.6g} Hz" if self.names else ""
        return f"<iwan.StructureModes: {len(self)} elastic modes{ends}>"


@dataclass(frozen=True, eq=False)
class StaticCurves:
    """Curves of one mode over modal displacement, without a transient. Made by `Structure.quasi_static`; picklable."""

    name: str
    """Name of the mode."""
    displacement: Array
    """Modal displacements q (mass^1/2 length)."""
    force: Array
    """Modal loads alpha = omega^2 q."""
    frequency: Array
    """Secant frequencies, Hz."""
    dissipation: Array
    """Dissipation per cycle of amplitude q, by Masing's rule."""
    joint_force: Array
    """Modal joint forces alpha - omega_inf^2 q."""
    slips: Mapping[str, Array]
    """Slips at each displacement, by the name of the slip."""
    frequency_stuck: float
    """Frequency with all joints stuck, Hz."""
    frequency_slipping: float
    """Frequency with all joints slipping, Hz."""
    k_t: float
    """Modal joint stiffness, 1/s^2."""
    mac: float
    """Likeness of the stuck and the slipping shape."""
    whole: bool
    """False where the curves end early: no static load holds the parts beyond, they slide freely."""
    joint: FourParameter | None
    """The modal Iwan joint that fits the curves best; None for a mode that slipping does not soften."""
    dissipation_misfit: float | None
    """Largest relative difference of dissipation between joint and structure."""
    frequency_misfit: float | None
    """Largest difference of frequency over what stuck and slipping differ by."""
    remark: str | None
    """Why there is no joint."""

    @property
    def mode(self) -> Mode:
        """The mode with that joint, linear where there is none; without viscous damping."""
        return Mode(frequency=self.frequency_stuck, joint=self.joint, name=self.name)

    def __repr__(self) -> str:
        return f"<iwan.StaticCurves: {self.name}, {self.displacement.size} displacements, {self.joint or self.remark}>"


@dataclass(frozen=True, eq=False)
class StructureResponse:
    """Response of a structure with its discrete joints. Made by `Structure.simulate`; picklable.

    Histories are float64 arrays of one dimension by name, one entry per `dt`, the state at rest first. Names are those of the
    recorded `modes` (modal coordinates, mass^1/2 length) and of the `outputs` of the structure file (length).
    """

    t: Array
    """Times, s."""
    dt: float
    """Time between samples, s."""
    modes: Sequence[str]
    """Names of the recorded modes."""
    outputs: Sequence[str]
    """Names of the outputs of the structure file."""
    displacement: Mapping[str, Array]
    """Displacements of modes and outputs."""
    velocity: Mapping[str, Array]
    """Velocities."""
    acceleration: Mapping[str, Array]
    """Accelerations."""
    joint_force: Mapping[str, Array]
    """Modal joint force of each recorded mode: what its equation differs by from that of the slipping structure."""
    slip: Mapping[str, Array]
    """Slips of the joints, by name."""
    slip_force: Mapping[str, Array]
    """Their forces."""
    slip_ratio: Mapping[str, float]
    """Largest |slip| over phi_max: macro-slip above 1."""
    energy: Energy
    """The energy balance of the whole run."""
    energy_error: float
    """|residual| of the energy balance over the largest energy in play."""
    time_step_error: Mapping[str, float] | None
    """Estimated error of each displacement from the time step, relative to its peak; None for the full model or without
    `quality`."""
    discretisation_error: Mapping[str, float] | None
    """The same from cutting the joints into sliders; None also for the continuum."""
    forgotten_force: float
    """Bound on the joint forces' error from lack of room for loops, 0 = exact."""
    basis: int | None
    """Modes in the basis of the reduced model; None for the full one."""
    basis_error: float | None
    """Estimated error of the accelerations from the reduction, where a tolerance was given."""
    converged: bool | None
    """Whether it reached the tolerance."""
    seconds: float
    """Time of the integration itself, s."""

    def record(
        self,
        name: str,
        *,
        quantity: Literal["acceleration", "velocity", "displacement"] = "acceleration",
        since: float = 0.0,
    ) -> Record:
        """The history of a mode or output as a `Record`, for `iwan.envelope` and `iwan.fit`: its samples from the time
        `since` (s) on, such as the end of a blow.

        Raises `iwan.InvalidValueError` for a name or quantity that does not exist, or a time beyond the end.

        >>> beam = iwan.Structure.built_in("paper-a")
        >>> blow = iwan.Haversine(amplitude=10.0, duration=1.6e-3)
        >>> truth = beam.simulate(force=blow, dt=1e-4, duration=0.02, basis=25, quality=False)
        >>> truth.record("bending 1", since=2e-3)
        <iwan.Record: acceleration of 1 channels, 181 samples every 0.0001 s>
        """
        histories = {"acceleration": self.acceleration, "velocity": self.velocity, "displacement": self.displacement}
        chosen("quantity", quantity, list(histories))
        if name not in list(self.displacement):
            raise InvalidValueError(f"there is no history '{name}': choose from {', '.join(self.displacement)}")
        first = int(np.searchsorted(self.t, _native._number("since", since) - 1e-9 * self.dt))
        if self.t.size - first < 2:
            raise InvalidValueError(f"since = {since} s leaves no record: the response ends at {self.t[-1]} s")
        samples = histories[quantity][name][first:]
        return Record(samples, dt=self.dt, names=[name], quantity=quantity, start=float(self.t[first]))

    def __repr__(self) -> str:
        how = "full model" if self.basis is None else f"reduced to {self.basis} modes"
        most = max(self.slip_ratio.values(), default=0.0)
        return f"<iwan.StructureResponse: {self.t.size - 1} steps of {self.dt!r} s, {how}, largest slip ratio {most:.4}>"


class Structure(SteadyStructure):
    """A finite-element structure with discrete Iwan joints: mesh, materials, joints, supports, loads and outputs.

    Made by `Structure.load` or `Structure.built_in`; frozen, picklable, `repr` reads back. Modes are computed once and kept.
    """

    def __init__(self, native: _native._Structure) -> None:
        if not isinstance(native, _native._Structure):
            raise InvalidTypeError("a Structure is made by Structure.load or Structure.built_in")
        self._native = native
        told = native.told()
        self.name: str = told["name"]
        """Path of the file, or name of the built-in structure."""
        self.text: str = told["text"]
        """Text of the structure file: that of a built-in one is a start for your own."""
        self.title: str = told["title"]
        """Title of the structure file."""
        self.notes: Sequence[str] = told["notes"]
        """What was noticed on reading, in words."""
        self.nodes: Array = told["nodes"]
        """Positions of the nodes, nodes x 3, read-only."""
        self.faces: NDArray[np.int64] = np.asarray(told["faces"], dtype=np.int64)
        """Outer faces, faces x 4, as indices of their corners into `nodes`, counter-clockwise seen from outside."""
        self.elements: int = told["elements"]
        """Number of elements."""
        self.node_sets: Mapping[str, NDArray[np.int64]] = {
            name: np.asarray(members, dtype=np.int64) for name, members in told["node_sets"].items()
        }
        """Node sets by name, as indices into `nodes`, ascending."""
        self.joints: Sequence[str] = told["joints"]
        """Names of joints and ties."""
        self.loads: Sequence[str] = told["loads"]
        """Names of the loads: where a force acts."""
        self.outputs: Sequence[str] = told["outputs"]
        """Names of the outputs: points whose motion is recorded."""

    @staticmethod
    def load(path: str | PathLike[str]) -> Structure:
        """Read a structure file (TOML; the `text` of a built-in one is a start); paths in it are relative to its folder. Or open the folder
        of a reduced model that `write_reduced` or `iwan modes --write-reduced` wrote: then nothing is factored, as far as its modes go.

        Raises `iwan.MissingFileError` for a file that is not there, `iwan.StructureError` (a `ValueError`) naming file, line, key
        and what helps, for a mesh that cannot be computed with as well.

        >>> with open("beam.toml", "w") as file:
        ...     _ = file.write(iwan.Structure.built_in("paper-a").text)
        >>> iwan.Structure.load("beam.toml").joints
        ['left link', 'right link', 'left washer', 'right washer']
        """
        return Structure(_native._load_structure(path))

    @staticmethod
    def built_in(name: Literal["paper-a", "paper-b"] = "paper-a") -> Structure:
        """A structure that comes with iwan: the beam of Deaner et al. (Sec. 3) with a link bolted on, 1,554 nodes, lbf-in-s.

        `name`: "paper-a" (uniform mesh, rigid patches) or "paper-b" (with the mesh and the averaging patches that meet the paper's
        Table 2). Raises `iwan.StructureError`, a `ValueError`, for another name.

        >>> beam = iwan.Structure.built_in("paper-a")
        >>> beam.nodes.shape, beam.outputs, beam.node_sets["tip"].size
        ((1554, 3), ['tip'], 9)
        """
        return Structure(_native._built_in_structure(name))

    def modes(self, n: int = 20) -> StructureModes:
        """The `n` lowest elastic modes, with all joints stuck and with all slipping. None is missed, repeated ones included.

        Raises `iwan.InvalidValueError` for n < 1, `iwan.ComputationError` when a factorisation fails its own check.

        >>> modes = iwan.Structure.built_in("paper-a").modes(4)
        >>> modes.names
        ['bending 1', 'bending 2', 'bending 3', 'torsion 1']
        >>> print(f"{modes.frequency[0]:.3f} Hz stuck, {modes.frequency_slipping[0]:.3f} Hz slipping", modes.shapes.shape)
        132.351 Hz stuck, 127.766 Hz slipping (4, 1554, 3)
        """
        if _native._whole("n", n) < 1:
            raise InvalidValueError(f"n = {n} is out of range: ask for at least 1 mode")
        return StructureModes(nodes=self.nodes, faces=self.faces, **self._native.modes(n))

    def quasi_static(
        self, mode: str = "bending 1", *, displacement: ArrayLike | None = None, points: int = 81
    ) -> StaticCurves:
        """Curves of a mode from static loads alpha M phi, without any transient, and the modal Iwan joint that fits them.

        `mode`: by its name in `modes`; `displacement`: modal displacements q > 0 (mass^1/2 length, one dimension) in ascending
        order, or `points` of them, evenly spaced on a logarithmic scale from a thousandth to ten times where the first joint
        begins macro-slip. Dissipation by Masing's rule. K_T is that of the modes, F_S, chi and beta are fitted.

        Raises `iwan.InvalidValueError` for a mode that does not exist or a displacement out of range, `iwan.ComputationError` where
        no static load holds a displacement that was given.

        Source: H. Festjens et al., Int. J. Mech. Sci. 75:170, 2013, doi:10.1016/j.ijmecsci.2013.06.010.

        >>> curves = iwan.Structure.built_in("paper-a").quasi_static("bending 1", displacement=[1.989e-4, 1.983e-3])
        >>> [f"{f:.2f} Hz, {d:.1e}" for f, d in zip(curves.frequency, curves.dissipation)]
        ['132.24 Hz, 4.7e-05', '131.76 Hz, 2.7e-02']
        """
        told = _native._quasi_static(self._native, mode, displacement, points)
        parameters = told.pop("parameters")
        joint = None if parameters is None else FourParameter(**dict(zip(("k_t", "f_s", "chi", "beta"), parameters)))
        return StaticCurves(joint=joint, **told)

    def simulate(
        self,
        *,
        force: Pulse | ArrayLike | None = None,
        velocity: Mapping[str, float] | None = None,
        dt: float,
        duration: float,
        modes: Sequence[str] = (),
        model: Literal["reduced", "full"] = "reduced",
        basis: int | None = None,
        tolerance: float | None = None,
        sliders: int | None = 100,
        grid: Grid | None = None,
        quality: bool = True,
        progress: Progress = None,
    ) -> StructureResponse:
        """Simulate the structure with its discrete joints, from rest or from modal velocities: the truth for modal models.

        `force`: a pulse such as `Haversine`, or samples every `dt` seconds, at the loads of the structure file; `velocity`: modal
        velocities at t = 0 s by mode, to start a ring-down in one; `dt`, `duration` (s); `modes`: names of modes whose coordinates
        are recorded, by the exact modal filter q = phi^T M x; the first three bending modes by default.

        `model`: "reduced" to modes and attachment vectors of the slips, with `basis` modes (at most as many as the structure has unknowns) or as many as the accelerations need for
        the relative error `tolerance` (0.05 by default); or "full", all unknowns. Average acceleration (Newmark beta = 1/4)
        without prewarping. `sliders` and `grid`: as in `iwan.simulate`, but
        graded sliders reach down to 1e-6 phi_max, since the joints of a structure slip unequally (in a mode: 0.01 phi_max over their number). `quality`: estimate the errors by companion runs of the
        reduced model. `progress`: as in `iwan.ensemble.simulate`, in thousandths of a run.

        Raises `iwan.InvalidValueError` for a value out of range, `iwan.StructureError` for a structure without loads,
        `iwan.ComputationError` where the slips find no equilibrium. The lock is released; Ctrl-C is honoured.

        >>> beam = iwan.Structure.built_in("paper-a")
        >>> blow = iwan.Haversine(amplitude=10.0, duration=1.6e-3)
        >>> truth = beam.simulate(force=blow, dt=1e-5, duration=0.01, basis=50)
        >>> truth.modes, f"{abs(truth.acceleration['bending 1']).max():.1f}", truth.energy_error < 1e-10
        (['bending 1', 'bending 2', 'bending 3'], '220.8', True)
        """
        with bar(progress, _PARTS) as tell:
            told = _native._simulate_structure(
                self._native,
                force=force,
                velocity={} if velocity is None else velocity,
                dt=dt,
                duration=duration,
                modes=modes,
                model=model,
                basis=basis,
                tolerance=tolerance,
                sliders=sliders,
                grid=grid,
                quality=quality,
                progress=tell,
            )
        steps = next(iter(told["displacement"].values())).size
        return StructureResponse(t=np.arange(steps, dtype=np.float64) * told["dt"], **told)

    def write_matrices(
        self,
        folder: str | PathLike[str],
        *,
        format: Literal["matrix-market", "npz", "mat"] = "matrix-market",
        force: bool = False,
    ) -> list[str]:
        """Write stiffness (joints slipping, and stuck), mass, and the displacements of all nodes from the unknowns, into a folder.

        `format`: "matrix-market" (.mtx), "npz" (`scipy.sparse.load_npz`) or "mat" (MATLAB level 5: K, K0, M, T in one file). rows.csv says what
        each unknown is (node, component; 0 for slips and rigid patches), nodes.csv where the nodes are. Returns the names of the files.

        Raises `iwan.ExistingFileError` where one is there already, unless `force`; `iwan.FileError` where nothing can be written.

        >>> iwan.Structure.built_in("paper-a").write_matrices("matrices", format="npz")
        ['stiffness.npz', 'stuck_stiffness.npz', 'mass.npz', 'displacements.npz', 'rows.csv', 'nodes.csv']
        """
        return _native._write_matrices(self._native, folder, format, force)

    def write_reduced(self, folder: str | PathLike[str], *, modes: int, force: bool = False) -> None:
        """Write a reduced model of `modes` stuck modes and the attachment vectors of the slips into a folder that `load` opens.

        A structure opened from it simulates with that basis unless told otherwise, with the same bits as `simulate(basis=modes)`, without a
        factorisation. Loads, outputs and laws in the folder's reduced-structure.toml may be changed as long as each joint keeps its K_T.

        Raises `iwan.InvalidValueError` for modes < 1 or more than the structure has unknowns, `iwan.ExistingFileError` where a file is there already, unless `force`.

        >>> iwan.Structure.built_in("paper-a").write_reduced("reduced", modes=20)
        >>> iwan.Structure.load("reduced").modes(3).names
        ['bending 1', 'bending 2', 'bending 3']
        """
        _native._write_reduced(self._native, folder, modes, force)

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[type[Structure], tuple[_native._Structure]]:
        return Structure, (self._native,)

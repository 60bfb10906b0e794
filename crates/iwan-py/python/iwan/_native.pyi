"""Types of the compiled part. Shapes: scalars in, scalars out; arrays keep their shape."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, final, overload

from numpy.typing import ArrayLike
from xarray import Dataset

from iwan.types import Array, Energy, EnvelopeMethod, Grid, Method, Motion, Quantity, Statistics

__version__: Final[str]

class Joint:
    @property
    def k_t(self) -> float: ...
    @property
    def f_s(self) -> float: ...
    @property
    def phi_max(self) -> float: ...
    @property
    def phi_min(self) -> float: ...
    @property
    def dirac(self) -> float: ...
    @overload
    def force(self, u: float) -> float: ...
    @overload
    def force(self, u: ArrayLike) -> Array: ...
    @overload
    def tangent(self, u: float) -> float: ...
    @overload
    def tangent(self, u: ArrayLike) -> Array: ...
    @overload
    def secant(self, u: float) -> float: ...
    @overload
    def secant(self, u: ArrayLike) -> Array: ...
    @overload
    def harmonic_stiffness(self, u: float) -> float: ...
    @overload
    def harmonic_stiffness(self, u: ArrayLike) -> Array: ...
    @overload
    def dissipation(self, u: float) -> float: ...
    @overload
    def dissipation(self, u: ArrayLike) -> Array: ...
    @overload
    def energy(self, u: float) -> float: ...
    @overload
    def energy(self, u: ArrayLike) -> Array: ...
    @overload
    def density(self, phi: float) -> float: ...
    @overload
    def density(self, phi: ArrayLike) -> Array: ...
    def force_history(self, u: ArrayLike, sliders: int | None = None, grid: Grid | None = None) -> Array: ...
    def discretise(self, sliders: int = 100, grid: Grid | None = None) -> tuple[Array, Array]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class FourParameter(Joint):
    def __new__(cls, *, k_t: float, f_s: float, chi: float, beta: float) -> FourParameter: ...
    @staticmethod
    def from_density(*, r: float, chi: float, phi_max: float, s: float) -> FourParameter: ...
    @property
    def chi(self) -> float: ...
    @property
    def beta(self) -> float: ...
    @property
    def r(self) -> float: ...
    @property
    def s(self) -> float: ...
    @overload
    def dissipation_printed_eq17(self, u: float) -> float: ...
    @overload
    def dissipation_printed_eq17(self, u: ArrayLike) -> Array: ...

@final
class Jenkins(Joint):
    def __new__(cls, *, k_t: float, f_s: float) -> Jenkins: ...

@final
class Uniform(Joint):
    def __new__(cls, *, k_t: float, f_s: float, width: float) -> Uniform: ...
    @property
    def width(self) -> float: ...

@final
class Tabulated(Joint):
    def __new__(cls, *, strength: ArrayLike, density: ArrayLike, dirac: float = 0.0) -> Tabulated: ...
    @property
    def strength(self) -> Array: ...
    @property
    def table(self) -> Array: ...

class Pulse:
    @overload
    def at(self, t: float) -> float: ...
    @overload
    def at(self, t: ArrayLike) -> Array: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Haversine(Pulse):
    def __new__(cls, *, amplitude: float, duration: float) -> Haversine: ...

@final
class HalfSine(Pulse):
    def __new__(cls, *, amplitude: float, duration: float) -> HalfSine: ...

@final
class Step(Pulse):
    def __new__(cls, *, amplitude: float, duration: float = ...) -> Step: ...

@final
class Sine(Pulse):
    def __new__(cls, *, amplitude: float, frequency: float, duration: float = ...) -> Sine: ...

@final
class Sampled(Pulse):
    def __new__(cls, *, samples: ArrayLike, dt: float) -> Sampled: ...
    @property
    def samples(self) -> Array: ...

class Part:
    @overload
    def harmonic_stiffness(self, a: float, *, frequency: float) -> float: ...
    @overload
    def harmonic_stiffness(self, a: ArrayLike, *, frequency: float) -> Array: ...
    @overload
    def dissipation(self, a: float, *, frequency: float) -> float: ...
    @overload
    def dissipation(self, a: ArrayLike, *, frequency: float) -> Array: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class PowerDamping(Part):
    def __new__(cls, *, c: float, n: float) -> PowerDamping: ...
    @property
    def c(self) -> float: ...
    @property
    def n(self) -> float: ...

@final
class Coulomb(Part):
    def __new__(cls, *, force: float) -> Coulomb: ...
    @property
    def force(self) -> float: ...

@final
class Spring(Part):
    def __new__(cls, *, k: float, exponent: float) -> Spring: ...
    @property
    def k(self) -> float: ...
    @property
    def exponent(self) -> float: ...

@final
class Pinning(Part):
    def __new__(cls, *, k: float, gap: float) -> Pinning: ...
    @property
    def k(self) -> float: ...
    @property
    def gap(self) -> float: ...

@final
class ModeCurves:
    def __new__(
        cls, amplitude: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike, *, extrapolate: bool = False
    ) -> ModeCurves: ...
    @property
    def amplitude(self) -> Array: ...
    @property
    def frequency(self) -> Array: ...
    @property
    def damping_ratio(self) -> Array: ...
    @property
    def extrapolate(self) -> bool: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Mode:
    def __new__(
        cls,
        *,
        frequency: float | None = None,
        joint: Joint | None = None,
        damping_ratio: float = 0.0,
        name: str = "mode",
        shape_at_force: float = 1.0,
        outputs: Mapping[str, float] | None = None,
        allow_negative_residual: bool = False,
        parts: Sequence[Part] | None = None,
        curves: ModeCurves | None = None,
    ) -> Mode: ...
    @property
    def frequency(self) -> float: ...
    @property
    def joint(self) -> Joint | None: ...
    @property
    def parts(self) -> tuple[Part, ...]: ...
    @property
    def curves(self) -> ModeCurves | None: ...
    @property
    def damping_ratio(self) -> float: ...
    @property
    def name(self) -> str: ...
    @property
    def shape_at_force(self) -> float: ...
    @property
    def outputs(self) -> dict[str, float]: ...
    @property
    def allow_negative_residual(self) -> bool: ...
    @property
    def k_inf(self) -> float: ...
    @overload
    def frequency_at(self, a: float) -> float: ...
    @overload
    def frequency_at(self, a: ArrayLike) -> Array: ...
    @overload
    def damping_ratio_at(self, a: float) -> float: ...
    @overload
    def damping_ratio_at(self, a: ArrayLike) -> Array: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Response:
    @property
    def t(self) -> Array: ...
    @property
    def dt(self) -> float: ...
    @property
    def displacement(self) -> Array: ...
    @property
    def velocity(self) -> Array: ...
    @property
    def acceleration(self) -> Array: ...
    @property
    def joint_force(self) -> Array: ...
    @property
    def energy_error(self) -> float: ...
    @property
    def energy(self) -> Energy: ...
    @property
    def statistics(self) -> Statistics: ...
    def to_xarray(self) -> Dataset: ...
    def __len__(self) -> int: ...

@overload
def simulate(
    mode: Mode,
    *,
    force: Pulse | ArrayLike | None = None,
    dt: float,
    duration: float,
    method: Method = "newmark",
    sliders: int | None = 100,
    grid: Grid | None = None,
    prewarp: bool = True,
    beta: float = 0.25,
    gamma: float = 0.5,
    initial: ArrayLike | None = None,
    quality: bool = True,
    threads: int | None = None,
) -> Response: ...
@overload
def simulate(
    mode: Sequence[Mode],
    *,
    force: Pulse | ArrayLike | None = None,
    dt: float,
    duration: float,
    method: Method = "newmark",
    sliders: int | None = 100,
    grid: Grid | None = None,
    prewarp: bool = True,
    beta: float = 0.25,
    gamma: float = 0.5,
    initial: ArrayLike | None = None,
    quality: bool = True,
    threads: int | None = None,
) -> list[Response]: ...
def _simulate_coupled(
    modes: Sequence[Mode],
    joints: Sequence[tuple[str, Joint, Sequence[float], Sequence[float], float]],
    force: Pulse | ArrayLike | None,
    dt: float,
    duration: float,
    sliders: int | None,
    grid: Grid | None,
    prewarp: bool,
    initial: ArrayLike | None,
    quality: bool,
    threads: int | None,
) -> dict[str, Any]: ...
def superpose(modes: Sequence[Mode], responses: Sequence[Response]) -> dict[str, Motion]: ...
@final
class Record:
    def __new__(
        cls,
        samples: ArrayLike,
        *,
        dt: float,
        names: Sequence[str] | None = None,
        quantity: Quantity = "unknown",
        unit: str = "",
        start: float = 0.0,
    ) -> Record: ...
    @property
    def samples(self) -> Array: ...
    @property
    def dt(self) -> float: ...
    @property
    def rate(self) -> float: ...
    @property
    def start(self) -> float: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def quantity(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def t(self) -> Array: ...
    def channel(self, channel: str | int | None = None) -> Array: ...
    def between(self, start: float | None = None, stop: float | None = None) -> Record: ...
    def hits(self) -> list[Record]: ...
    def spectral_peaks(self) -> list[dict[str, Any]]: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

def read_record(
    path: str | PathLike[str],
    *,
    format: Literal["text", "npy", "npz", "uff", "mat", "lvm", "wav"] | None = None,
    time: str | None = None,
    channels: Sequence[str] = ...,
    rate: float | None = None,
    quantity: Quantity | None = None,
    resample: bool = False,
    time_unit: Literal["s", "ms", "us", "ns", "min", "h"] | None = None,
    unit: str | None = None,
    start: float | None = None,
    stop: float | None = None,
) -> Record: ...
@final
class Envelope:
    @property
    def t(self) -> Array: ...
    @property
    def amplitude(self) -> Array: ...
    @property
    def frequency(self) -> Array: ...
    @property
    def damping_ratio(self) -> Array: ...
    @property
    def log_amplitude_sd(self) -> Array: ...
    @property
    def frequency_sd(self) -> Array: ...
    @property
    def damping_ratio_sd(self) -> Array: ...
    @property
    def trusted(self) -> tuple[float, float]: ...
    @property
    def method(self) -> str: ...
    @property
    def order(self) -> int: ...
    @property
    def noise(self) -> float: ...
    @property
    def notes(self) -> list[str]: ...
    def __len__(self) -> int: ...

def envelope(
    record: Record | ArrayLike,
    *,
    dt: float | None = None,
    channel: str | int | None = None,
    band: tuple[float, float] | None = None,
    near: float | None = None,
    method: EnvelopeMethod = "hilbert",
    filter_order: int = 3,
    window: tuple[float, float] | None = None,
    order: int | None = None,
    mode: float | None = None,
) -> Envelope: ...

# Behind iwan.ensemble.
def _ensemble(
    columns: Sequence[Array],
    *,
    force: Pulse | ArrayLike | None,
    dt: float,
    duration: float,
    method: Method,
    sliders: int | None,
    grid: Grid | None,
    prewarp: bool,
    keep: Sequence[str],
    shape: Sequence[int],
    first: int,
    threads: int | None,
    progress: Callable[[int], object] | None,
) -> tuple[list[Array], list[Array], int]: ...
def _envelopes(
    records: Sequence[Record | ArrayLike],
    *,
    dt: float | None,
    channel: str | int | None,
    band: tuple[float, float] | None,
    near: float | None,
    method: EnvelopeMethod,
    filter_order: int,
    window: tuple[float, float] | None,
    order: int | None,
    first: int,
    threads: int | None,
    progress: Callable[[int], object] | None,
) -> list[Envelope]: ...

# Behind iwan.Structure.
@final
class _Structure:
    def told(self) -> dict[str, Any]: ...
    def modes(self, count: int) -> dict[str, Any]: ...

def _load_structure(path: str | PathLike[str]) -> _Structure: ...
def _built_in_structure(name: str) -> _Structure: ...
def _write_matrices(structure: _Structure, folder: str | PathLike[str], format: str, force: bool) -> list[str]: ...
def _write_reduced(structure: _Structure, folder: str | PathLike[str], modes: int, force: bool) -> None: ...
def _quasi_static(
    structure: _Structure, mode: str, displacement: ArrayLike | None, points: int
) -> dict[str, Any]: ...
def _update(
    structure: _Structure,
    curves: Sequence[tuple[str, str, bool, bool, ArrayLike, ArrayLike, ArrayLike]],
    *,
    groups: Mapping[str, Sequence[str]] | None,
    correct: Sequence[tuple[str, float | None]],
    undamped: bool,
    threads: int | None,
    progress: Callable[[int], object] | None,
) -> tuple[str, str | None]: ...
def _reproduce(*, threads: int | None, progress: Callable[[int], object] | None) -> str: ...
def _fit_sweeps(
    sweeps: Sequence[str | PathLike[str] | tuple[str, Sequence[tuple[str, ArrayLike]]]],
    backbones: Sequence[str | PathLike[str] | tuple[str, Sequence[tuple[str, ArrayLike]]]],
    levels: Sequence[float],
    mass: float | None,
    hold: Sequence[tuple[str, float]],
    ring_downs: _Identified | None,
) -> _FittedSweeps: ...
@final
class _FittedSweeps:
    def told(self) -> dict[str, Any]: ...
    def report(self, path: str | PathLike[str], force: bool) -> None: ...

def _frf(
    modes: Sequence[Mode],
    asked: tuple[str, ArrayLike, tuple[float, float], int, int],
    at: str | None,
    threads: int | None,
) -> list[list[dict[str, Any]]]: ...
def _frf_coupled(
    modes: Sequence[Mode],
    joints: Sequence[tuple[str, Joint, Sequence[float], Sequence[float], float]],
    asked: tuple[str, ArrayLike, tuple[float, float], int, int],
    at: str | None,
    threads: int | None,
) -> list[dict[str, Any]]: ...
def _backbone_coupled(
    modes: Sequence[Mode],
    joints: Sequence[tuple[str, Joint, Sequence[float], Sequence[float], float]],
    mode: int,
    amplitude: ArrayLike,
    harmonics: int,
) -> dict[str, Any]: ...
def _frf_structure(
    structure: _Structure,
    asked: tuple[str, ArrayLike, tuple[float, float], int, int],
    direction: tuple[float, float, float] | None,
    given: tuple[str | None, float, int | None],
    threads: int | None,
) -> tuple[list[dict[str, Any]], str]: ...
def _backbone_structure(
    structure: _Structure,
    mode: str,
    amplitude: ArrayLike | None,
    points: int,
    harmonics: int,
    given: tuple[str | None, float, int | None],
) -> dict[str, Any]: ...
def _modal_fit(
    forces: ArrayLike | None, responses: ArrayLike, request: dict[str, Any]
) -> dict[str, Any]: ...
def _backbone(
    modes: Sequence[Mode], amplitude: ArrayLike, harmonics: int, threads: int | None
) -> list[dict[str, Any]]: ...
def _simulate_structure(
    structure: _Structure,
    *,
    force: Pulse | ArrayLike | None,
    velocity: Sequence[tuple[str, float]],
    dt: float,
    duration: float,
    modes: Sequence[str],
    model: str,
    basis: int | None,
    tolerance: float | None,
    sliders: int | None,
    grid: Grid | None,
    quality: bool,
    progress: Callable[[int], object] | None,
) -> dict[str, Any]: ...

# Behind the command `iwan`.
def _command(arguments: Sequence[str]) -> int: ...

# Behind iwan.fit and iwan.log_likelihood.
@final
class _Identified:
    def told(self, force_axis: str) -> dict[str, Any]: ...
    def report(
        self, path: str | PathLike[str], names: Sequence[str] | None, force_axis: str, force: bool
    ) -> None: ...
    def likelihood(self) -> _Likelihood: ...

@final
class _Likelihood:
    @property
    def names(self) -> list[str]: ...
    @property
    def best(self) -> Array: ...
    def log(self, theta: ArrayLike, threads: int | None) -> Array: ...

def _identify(records: Sequence[Record | ArrayLike], request: Mapping[str, Any]) -> _Identified: ...
def _identify_many(
    groups: Sequence[Sequence[Record | ArrayLike]],
    request: Mapping[str, Any],
    *,
    threads: int | None,
    progress: Callable[[int], object] | None,
) -> list[_Identified | Exception]: ...

# Behind iwan.as_record.
def _read_bytes(
    name: str,
    bytes: bytes,
    time: str | None,
    channels: Sequence[str],
    rate: float | None,
    quantity: str | None,
    resample: bool,
) -> Record: ...

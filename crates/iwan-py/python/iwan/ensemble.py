"""Many parameter sets or many records in one call.

The work is done in Rust on all cores; with a `dask.distributed` client (extra `iwan-ringdown[dask]`) on all its workers. Results
are the same, to the last bit, whatever the number of threads or workers.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from iwan import _native
from iwan._arguments import chosen, items, texts
from iwan._checkpoint import Checkpoint
from iwan._stretches import check_hits, several, stretches
from iwan.errors import InvalidTypeError, InvalidValueError, IwanError
from iwan.identification import Fit, made, request as _request
from iwan.progress import Progress, bar
from iwan.types import Array, EnvelopeMethod, Grid, History, Method, Pair

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Ensemble", "Fits", "envelope", "fit", "simulate"]

_Result = TypeVar("_Result")

_PARAMETERS = ("frequency", "damping_ratio", "k_t", "f_s", "chi", "beta")

_CHUNK_SECONDS = 0.1
"""Aim for the pieces that workers get: at least 50 ms each, on workers twice as fast as this machine too."""

_KEPT = 64
"""Pieces of a checkpoint: so much of a work is lost at most, and writing them costs nothing beside it."""

_RETRIES = 3
"""How often a piece is computed again after an error of its worker."""


@dataclass(frozen=True, eq=False)
class Ensemble:
    """Responses of many members; arrays have the broadcast shape of the parameters.

    Histories have one axis more, the samples.
    """

    peak_displacement: Array
    """Largest |q| among the samples."""
    final_displacement: Array
    """Displacement at the last sample."""
    slip_ratio: Array
    """Peak |q| over phi_max: macro-slip above 1."""
    energy_error: Array
    """|residual| of the energy balance, relative."""
    histories: Mapping[str, Array]
    """The histories that were to be kept, by name."""
    t: Array
    """Times of their samples, s."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the ensemble."""
        return self.peak_displacement.shape


def simulate(
    *,
    frequency: ArrayLike,
    k_t: ArrayLike,
    f_s: ArrayLike,
    chi: ArrayLike,
    beta: ArrayLike,
    damping_ratio: ArrayLike = 0.0,
    shape_at_force: ArrayLike = 1.0,
    displacement: ArrayLike = 0.0,
    velocity: ArrayLike = 0.0,
    force: _native.Pulse | ArrayLike | None = None,
    dt: float,
    duration: float,
    method: Method = "half-cycle",
    sliders: int | None = 100,
    grid: Grid | None = None,
    prewarp: bool = True,
    keep: Sequence[History] = (),
    checkpoint: str | PathLike[str] | None = None,
    threads: int | None = None,
    client: Client | None = None,
    progress: Progress = None,
) -> Ensemble:
    """Simulate the ring-downs of many modes with four-parameter joints.

    The parameters of `Mode` and `FourParameter`, and `displacement` and `velocity` at t = 0 s, are numbers or arrays that are
    broadcast against each other. `force`, `dt`, `duration`, `sliders`, `grid`, `prewarp`: as in `iwan.simulate`, shared
    by all; `shape_at_force` scales the force of a member. `method`: the half-cycle map by default, which needs no time
    steps, so that `dt` is only the distance of the samples. `keep`: histories to return; they need 8 bytes a sample.

    `checkpoint`: a folder in which what is done is kept, a sixty-fourth of the members at a time. A call with the same arguments
    and the same folder goes on from there, to the same bits, also after the process was killed; a folder of other work is
    refused. The folder is yours to remove; it is read by `pickle`, so take only your own.

    `threads`: all cores by default. `client`: a `dask.distributed` client, whose workers then do the work in pieces of at
    least 50 ms; what a lost worker had is computed again. `progress`: True, False, a function of the numbers done and in
    all, or None: shown where standard error is a terminal.

    Raises `iwan.InvalidValueError` naming the first parameter set out of range, `iwan.ComputationError`.

    >>> import numpy as np
    >>> many = iwan.ensemble.simulate(
    ...     frequency=124.0, k_t=4.45e4, f_s=np.linspace(100.0, 300.0, 1000), chi=-0.183, beta=[[0.3], [3.0]],
    ...     displacement=1e-3, dt=1e-3, duration=0.2, keep=["displacement"],
    ... )
    >>> many.shape, many.histories["displacement"].shape
    ((2, 1000), (2, 1000, 201))
    >>> bool(np.all(np.diff(np.abs(many.slip_ratio[0])) < 0))  # the stronger the joint, the less it slips
    True
    """
    parameters = {
        "frequency": frequency,
        "damping_ratio": damping_ratio,
        "k_t": k_t,
        "f_s": f_s,
        "chi": chi,
        "beta": beta,
        "shape_at_force": shape_at_force,
        "displacement": displacement,
        "velocity": velocity,
    }
    arrays = _broadcast({name: _native._numbers(name, given) for name, given in parameters.items()})
    keep = cast("list[History]", texts("keep", keep))
    shape, columns = arrays[0].shape, [array.ravel() for array in arrays]
    options: dict[str, Any] = {
        "force": force,
        "dt": dt,
        "duration": duration,
        "method": method,
        "sliders": sliders,
        "grid": grid,
        "prewarp": prewarp,
        "keep": keep,
        "shape": shape,
    }
    if checkpoint is not None:
        _alone(checkpoint, client)
        members = columns[0].size
        kept = Checkpoint(checkpoint, "iwan.ensemble.simulate", [columns, *options.items()], members, _kept_at_once(members))

        def compute(first: int, last: int) -> _Piece:
            part = [column[first:last] for column in columns]
            return _native._ensemble(part, **options, first=first, threads=threads, progress=None)

        with bar(progress, members) as tell:
            pieces = kept.pieces(compute, tell)
    elif client is None:
        with bar(progress, columns[0].size) as tell:
            pieces = [_native._ensemble(columns, **options, first=0, threads=threads, progress=tell)]
    else:
        pieces = _on_workers(client, _simulate_piece, columns, options, progress)
    return _joined(pieces, shape, keep, _native._number("dt", dt))


def _broadcast(given: Mapping[str, Array]) -> Sequence[Array]:
    """Arrays of one shape."""
    try:
        shape = np.broadcast_shapes(*[array.shape for array in given.values()])
    except ValueError as error:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in given.items() if array.ndim)
        raise InvalidValueError(f"shapes that do not go together: {shapes}") from error
    bytes_ = 8 * len(given) * math.prod(shape)
    _native._ask(f"an ensemble of the shape {shape}", bytes_, "take fewer members")
    return np.broadcast_arrays(*given.values())


def _kept_at_once(members: int) -> int:
    """Members in a piece of a checkpoint."""
    return max(1, -(-members // _KEPT))


def _alone(checkpoint: str | PathLike[str], client: Client | None) -> None:
    if client is not None:
        raise InvalidValueError(
            f"checkpoint {str(checkpoint)!r} together with client: the workers of a client keep nothing; leave out one of them"
        )


def _simulate_piece(columns: list[Array], options: dict[str, Any], first: int) -> _Piece:
    return _native._ensemble(columns, **options, first=first, threads=1, progress=None)


_Piece: TypeAlias = tuple[list[Array], list[Array], int]


def _joined(pieces: Sequence[_Piece], shape: tuple[int, ...], keep: Sequence[str], dt: float) -> Ensemble:
    """Put pieces together, in their order; a single one is not copied."""
    samples = pieces[0][2]

    def whole(parts: list[Array]) -> Array:
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    figures = [whole([piece[0][i] for piece in pieces]).reshape(shape) for i in range(4)]
    peak_displacement, final_displacement, slip_ratio, energy_error = figures
    histories = {
        name: whole([piece[1][i] for piece in pieces]).reshape(*shape, samples) for i, name in enumerate(keep)
    }
    times = np.arange(samples, dtype=np.float64) * dt
    return Ensemble(peak_displacement, final_displacement, slip_ratio, energy_error, histories, times)


def envelope(
    records: Sequence[_native.Record | ArrayLike],
    *,
    dt: float | None = None,
    channel: str | int | None = None,
    band: Pair | None = None,
    near: float | None = None,
    method: EnvelopeMethod = "hilbert",
    filter_order: int = 3,
    window: Pair | None = None,
    order: int | None = None,
    threads: int | None = None,
    client: Client | None = None,
    progress: Progress = None,
) -> list[_native.Envelope]:
    """Envelope and frequency of one mode of each of many records.

    Arguments as in `iwan.envelope`, for all records; `threads`, `client` and `progress` as in `simulate`. Returns a list of
    `Envelope` in the order of the records. Raises what `iwan.envelope` raises, naming the first record concerned.

    >>> import numpy as np
    >>> t = np.arange(8192) / 4096.0
    >>> records = [np.exp(-t) * np.cos(2 * np.pi * f * t) for f in (60.0, 80.0)]
    >>> [round(float(np.median(e.frequency)), 2) for e in iwan.ensemble.envelope(records, dt=1 / 4096)]
    [60.0, 80.0]
    """
    options: dict[str, Any] = {
        "dt": dt,
        "channel": channel,
        "band": band,
        "near": near,
        "method": method,
        "filter_order": filter_order,
        "window": window,
        "order": order,
    }
    records = items("records", records)
    if client is None:
        with bar(progress, len(records)) as tell:
            return _native._envelopes(records, **options, first=0, threads=threads, progress=tell)
    pieces = _on_workers(client, _envelope_piece, [records], options, progress)
    return [found for piece in pieces for found in piece]


def _envelope_piece(columns: list[Any], options: dict[str, Any], first: int) -> list[_native.Envelope]:
    return _native._envelopes(columns[0], **options, first=first, threads=1, progress=None)


@dataclass(frozen=True, eq=False)
class Fits:
    """Fits of many records. Made by `iwan.ensemble.fit`; picklable."""

    fits: Sequence[Fit | None]
    """One for each record, in their order; None where there is none."""
    failures: Mapping[int, Exception]
    """Why there is none, by the number of the record from 0."""

    @property
    def parameters(self) -> dict[str, Array]:
        """The parameters by name, one entry per record; not a number where there is no fit."""
        return {
            name: np.array([np.nan if fit is None else fit.parameters[name] for fit in self.fits], dtype=np.float64)
            for name in _PARAMETERS
        }

    def __len__(self) -> int:
        return len(self.fits)

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed: {', '.join(map(str, self.failures))}" if self.failures else ""
        return f"<iwan.ensemble.Fits: {len(self)} records{failed}>"

    def __str__(self) -> str:
        """What failed, record by record."""
        return "\n".join([repr(self), *[f"record {i}: {error}" for i, error in self.failures.items()]])


def fit(
    records: Sequence[_native.Record | ArrayLike | Sequence[_native.Record | ArrayLike]],
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
    checkpoint: str | PathLike[str] | None = None,
    threads: int | None = None,
    client: Client | None = None,
    progress: Progress = None,
) -> Fits:
    """Fit many records, each by itself: many tests, or many structures.

    `records`: each a `Record`, an array with `dt`, or a list of them (force levels of one structure, fitted together). The
    other arguments are those of `iwan.fit`, for all records; `checkpoint`, `threads`, `client` and `progress` as in `simulate`.

    Returns `Fits`. A record that cannot be fitted stops nothing: its error stands in `failures`. Raises
    `iwan.InvalidValueError` for arguments that no record can be fitted with.

    >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
    >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=1e-3)
    >>> response = iwan.simulate(mode, dt=2e-4, duration=0.4, initial=(0.2 * joint.phi_max, 0.0), method="half-cycle")
    >>> found = iwan.ensemble.fit([response.acceleration, response.acceleration[:20]], dt=2e-4)
    >>> found, found.parameters["chi"].round(2).tolist()
    (<iwan.ensemble.Fits: 2 records, 1 failed: 1>, [-0.18, nan])
    """
    records = items("records", records)
    chosen("force_axis", force_axis, ("modal", "joint"))
    # What would be refused in each record is refused once.
    for name, given in (("dt", dt), ("start", start), ("stop", stop), ("mass", mass), ("near", near), ("mode", mode)):
        if given is not None:
            _native._number(name, given)
    if quantity is not None:
        chosen("quantity", quantity, ("acceleration", "velocity", "displacement"))
    if not (channel is None or isinstance(channel, (str, int, np.integer)) and not isinstance(channel, bool)):
        raise InvalidTypeError(f"channel must be the name or the number of a channel, not {type(channel).__name__}")
    request = _request(channel, quantity, shape, mass, band, near, mode, method, filter_order, window, order, hold)
    check_hits(hits)
    failures: dict[int, Exception] = {}
    groups: dict[int, list[_native.Record]] = {}
    seen: dict[int, list[str]] = {}
    for i, record in enumerate(records):
        try:
            pieces = stretches(several(record), dt, start, stop, hits)
            groups[i], seen[i] = pieces.records, pieces.notes
        except IwanError as error:
            failures[i] = error
    natives: list[_native._Identified | Exception] | None = None
    if checkpoint is not None:
        _alone(checkpoint, client)
        all_groups = list(groups.values())
        asked = [channel, quantity, shape, mass, band, near, mode, method, filter_order, window, order, hold, force_axis]
        kept = Checkpoint(checkpoint, "iwan.ensemble.fit", [all_groups, asked], len(all_groups), _kept_at_once(len(all_groups)))

        def compute(first: int, last: int) -> list[dict[str, Any] | Exception]:
            found = _native._identify_many(all_groups[first:last], request, threads=threads, progress=None)
            return _told(found, force_axis)

        with bar(progress, len(all_groups)) as tell:
            told = [one for piece in kept.pieces(compute, tell) for one in piece]
    elif client is None:
        with bar(progress, len(groups)) as tell:
            natives = _native._identify_many(list(groups.values()), request, threads=threads, progress=tell)
        told = _told(natives, force_axis)
    else:
        options = {"request": request, "force_axis": force_axis}
        told = [one for piece in _on_workers(client, _fit_piece, [list(groups.values())], options, progress) for one in piece]
    fits: list[Fit | None] = [None] * len(records)
    for n, ((i, group), one) in enumerate(zip(groups.items(), told, strict=True)):
        if isinstance(one, Exception):
            failures[i] = one
        else:
            native = None if natives is None else cast(_native._Identified, natives[n])
            fit = made(one, group, request, force_axis, native)
            fits[i] = replace(fit, notes=[*seen[i], *fit.notes])
    return Fits(fits, dict(sorted(failures.items())))


def _fit_piece(columns: list[Any], options: dict[str, Any], first: int) -> list[dict[str, Any] | Exception]:
    return _told(_native._identify_many(columns[0], options["request"], threads=1, progress=None), options["force_axis"])


def _told(
    found: Sequence[_native._Identified | Exception], force_axis: str
) -> list[dict[str, Any] | Exception]:
    return [one if isinstance(one, Exception) else one.told(force_axis) for one in found]


def _on_workers(
    client: Client,
    compute: Callable[[list[Any], dict[str, Any], int], _Result],
    columns: list[Any],
    options: dict[str, Any],
    progress: Progress,
) -> list[_Result]:
    """Compute pieces of the columns on the workers of a client; a lost worker's pieces are computed again by others."""
    if not hasattr(client, "submit"):
        raise InvalidTypeError(f"client must be a dask.distributed.Client, not {type(client).__name__}")
    import distributed

    # The library has no types.
    as_completed, untyped = cast(Any, distributed).as_completed, cast(Any, client)

    members = len(columns[0])
    size = _piece_size(compute, columns, options)
    starts = range(0, max(members, 1), size)
    futures = [
        untyped.submit(compute, [c[first : first + size] for c in columns], options, first, pure=False, retries=_RETRIES)
        for first in starts
    ]
    try:
        with bar(progress, members) as tell:
            done = 0
            for future in as_completed(futures):
                if future.status == "error":
                    break
                done += size
                if tell is not None:
                    tell(min(done, members))
        # In the order of the members: the first error is the one that threads would have raised.
        return [future.result() for future in futures]
    finally:
        untyped.cancel([future for future in futures if not future.done()])


def _piece_size(compute: Callable[..., object], columns: list[Any], options: dict[str, Any]) -> int:
    """Members that make a piece of about `_CHUNK_SECONDS`, from a trial here."""
    members, size = len(columns[0]), 1
    while True:
        start = time.perf_counter()
        compute([c[:size] for c in columns], options, 0)
        seconds = time.perf_counter() - start
        if seconds > 0.1 * _CHUNK_SECONDS or size >= members:
            return max(1, int(np.ceil(size * _CHUNK_SECONDS / max(seconds, 1e-9))))
        size *= 4

"""Records from what other libraries hand out: pyuff, scipy.io, pandas and xarray."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from iwan._arguments import texts
from iwan._native import Record, _number, _numbers, _read_bytes, _seconds_in
from iwan.errors import InvalidTypeError, InvalidValueError, RecordError
from iwan.types import Quantity

__all__ = ["as_record"]

_UFF_TIME_RESPONSE = 1
"""Dataset 58, function type: the others are spectra and frequency responses."""

_UFF_QUANTITIES: dict[int, Quantity] = {8: "displacement", 9: "force", 11: "velocity", 12: "acceleration", 13: "force"}
"""Dataset 58, ordinate data type."""


def as_record(
    data: Any,
    *,
    dt: float | None = None,
    time: str | None = None,
    channels: Sequence[str] = (),
    quantity: Quantity | None = None,
    resample: bool = False,
) -> Record:
    """Make a `Record` of what other libraries hand out; `iwan.envelope` and `iwan.fit` do so by themselves.

    `data`: a dataset 58 of `pyuff` (a dict) or a list of them; the dict of `scipy.io.loadmat` or of named arrays; a pandas
    Series or DataFrame or an xarray DataArray with times as its index (numbers, durations or dates), or a DataFrame with its times in a
    column; an array with `dt` (s); a `Record`, returned as it is. Units of times, in `units` or in names such as `Time [ms]`, are obeyed, and
    those that are no units of time refused. `time`, `channels`, `quantity`, `resample`: as in `iwan.read_record`; what goes without a kind of data
    is refused beside it. Names that hold no real numbers are left out and stand in `Record.warnings`.

    Raises `iwan.InvalidValueError` or `iwan.RecordError` for data that are no record, `iwan.InvalidTypeError`.

    >>> record = iwan.as_record({"time": [0.0, 0.1, 0.2], "acc1": [1.0, 2.0, 4.0]})
    >>> record.names, record.dt, record.quantity
    (['acc1'], 0.1, 'acceleration')
    """
    if dt is not None:
        dt = _number("dt", dt)
        if not 0.0 < dt < np.inf:
            raise InvalidValueError(f"dt = {dt} is out of range: must be a finite number of seconds > 0")
    channels = texts("channels", channels)
    if time is not None and not isinstance(time, str):
        raise InvalidTypeError(f"time must be a str, the name of the times, not {type(time).__name__}")
    if not isinstance(resample, (bool, np.bool_)):
        raise InvalidTypeError(f"resample must be True or False, not {type(resample).__name__}")
    given = {"dt": dt, "time": time, "channels": channels or None, "quantity": quantity, "resample": resample or None}
    if isinstance(data, Record):
        _without(given, given, "a Record, for a Record has its own: cut it with its methods, or make another")
        return data
    sets = data if isinstance(data, (list, tuple)) else [data]
    if sets and all(isinstance(one, Mapping) and "ordinate_spec_data_type" in one for one in sets):
        _without(given, ("dt", "time", "channels", "resample"), "datasets 58, which say so themselves")
        return _of_uff(sets, quantity)
    if hasattr(data, "data_vars"):
        raise InvalidTypeError(f"a Dataset of xarray holds several arrays: choose one of {', '.join(map(str, data.data_vars))}")
    if isinstance(data, Mapping):
        return _of_names(data.items(), dt, time, channels, quantity, resample)
    if hasattr(data, "to_numpy") and hasattr(data, "index"):
        return _of_pandas(data, dt, time, channels, quantity, resample)
    if hasattr(data, "coords") and hasattr(data, "dims"):
        _without(given, ("time",), "a DataArray, whose coordinate holds the times")
        return _of_xarray(data, dt, channels, quantity, resample)
    if isinstance(data, (str, os.PathLike)):
        raise InvalidTypeError(f"data is a path, {str(data)!r}: read it with iwan.read_record")
    _without(given, ("time", "channels", "resample"), "a bare array: give a mapping of named arrays")
    if dt is None:
        raise InvalidValueError("dt is missing: a bare array needs its sampling interval in seconds, dt=")
    samples = _numbers("data", data)
    shape = samples.shape
    if len(shape) == 2 and shape[1] < _FEWEST <= shape[0]:
        raise InvalidValueError(f"the array has the shape {shape}: it must be channels x samples; transpose it")
    return Record(samples, dt=dt, quantity="unknown" if quantity is None else quantity)


def _without(given: Mapping[str, Any], names: Iterable[str], kind: str) -> None:
    """Refuse arguments that a kind of data goes without: they would be ignored."""
    for name in names:
        if given[name] is not None:
            raise InvalidValueError(f"{name} does not go with {kind}")


_FEWEST = 16
"""Samples that any method needs: an array with fewer of them in a row, and more rows, stands the other way round."""


def _of_uff(sets: Sequence[Mapping[str, Any]], quantity: Quantity | None) -> Record:
    """Datasets 58 as pyuff reads them: one channel each, sampled alike."""
    rows, names, axes = [], [], []
    for i, one in enumerate(sets):
        for key in ("func_type", "data", "x"):
            if key not in one:
                raise RecordError(f"dataset {i} has no {key!r}: give datasets 58 as pyuff reads them")
        if int(one["func_type"]) != _UFF_TIME_RESPONSE:
            raise RecordError(f"dataset {i}: function type {one['func_type']} is no time response: choose datasets of type 1")
        values = np.asarray(one["data"])
        if np.iscomplexobj(values) and np.any(values.imag):
            raise RecordError(f"dataset {i}: the samples are complex: choose a time response")
        unit = str(one.get("abscissa_axis_units_lab") or "").strip()
        axis = _seconds(np.asarray(one["x"]), f"x of dataset {i}", "" if unit.upper() == "NONE" else unit)
        rows.append(np.real(values).astype(np.float64))
        names.append(str(one.get("id1", "")).strip() or f"channel {i}")
        axes.append(axis)
    if any(axis.shape != axes[0].shape or not np.allclose(axis, axes[0], rtol=1e-9) for axis in axes):
        raise RecordError("the datasets were not sampled alike: make a record of each")
    kinds = {int(one["ordinate_spec_data_type"]) for one in sets}
    units = {str(one.get("ordinate_axis_units_lab", "")).strip() for one in sets}
    return Record(
        rows,
        dt=_step(axes[0]),
        names=names,
        quantity=quantity or (_UFF_QUANTITIES.get(kinds.pop(), "unknown") if len(kinds) == 1 else "unknown"),
        unit=units.pop() if len(units) == 1 else "",
        start=float(axes[0][0]),
    )


def _step(axis: np.ndarray[Any, Any]) -> float:
    """Interval of a uniform axis."""
    times = np.asarray(axis, dtype=np.float64)
    if times.ndim != 1 or times.size < 2:
        raise RecordError(f"{times.size} times: a record needs at least 2 samples")
    mean = float(times[-1] - times[0]) / (times.size - 1)
    if not mean > 0.0 or np.abs(np.diff(times) - mean).max() > 1e-3 * mean:
        raise RecordError("the times are not uniform: give dt=, or resample")
    return mean


def _of_pandas(
    data: Any,
    dt: float | None,
    time: str | None,
    channels: Sequence[str],
    quantity: Quantity | None,
    resample: bool,
) -> Record:
    """A Series or a DataFrame. Its index holds the times, unless it counts rows or `time` names a column."""
    columns = (
        [(str(name), _plain(data.iloc[:, i])) for i, name in enumerate(data.columns)]
        if hasattr(data, "columns")
        else [(str(data.name or "channel 0"), _plain(data))]
    )
    index = data.index
    if dt is not None or time not in (None, index.name):
        return _of_names(columns, dt, time, channels, quantity, resample)
    if index.name is None and _counts_rows(np.asarray(index)):
        if len(columns) == 1:
            raise RecordError("the index counts rows and is no time: give dt=, or times as the index")
        return _of_names(columns, dt, time, channels, quantity, resample)
    if getattr(index, "tz", None) is not None:
        index = index.tz_convert(None)
    return _of_axis(_seconds(np.asarray(index), str(index.name or "")), columns, channels, quantity, resample)


def _counts_rows(index: np.ndarray[Any, Any]) -> bool:
    """Whether an index without a name counts: whole numbers, one by one."""
    return index.dtype.kind in "iu" and index.ndim == 1 and bool(np.all(np.diff(index) == 1))


def _of_axis(
    axis: np.ndarray[Any, Any],
    columns: Sequence[tuple[str, Any]],
    channels: Sequence[str],
    quantity: Quantity | None,
    resample: bool,
) -> Record:
    """Columns over times in seconds that stand beside them."""
    if axis.size < 2:
        raise RecordError(f"{axis.size} times: a record needs at least 2 samples")
    return _of_names([(_INDEX, axis), *columns], None, _INDEX, channels, quantity, resample)


_INDEX = "index [s]"
"""Name of the times of an index among the columns, with their unit."""


def _plain(column: Any) -> np.ndarray[Any, Any]:
    """Numbers of a column; pandas' own types of numbers with nothing where one is missing."""
    values = column.to_numpy()
    if values.dtype == object and getattr(column.dtype, "kind", "O") in "fiu":
        return np.asarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
    return np.asarray(values)


def _seconds(axis: np.ndarray[Any, Any], name: str, unit: str = "") -> np.ndarray[Any, Any]:
    """Times in seconds: durations and dates by their own unit, numbers by the one beside them or in their name, `Time [ms]`."""
    if axis.dtype.kind == "M":
        axis = axis - axis[:1] if axis.size else axis.astype("m8[ns]")
    if axis.dtype.kind == "m":
        return axis / np.timedelta64(1, "s")
    if axis.dtype.kind not in "fiu":
        raise InvalidTypeError(f"the index holds {axis.dtype}, no times: give dt=, or times in seconds as the index")
    return axis.astype(np.float64) * _seconds_in(name, unit)


def _of_xarray(
    data: Any, dt: float | None, channels: Sequence[str], quantity: Quantity | None, resample: bool
) -> Record:
    if not 1 <= data.ndim <= 2:
        raise InvalidValueError(f"an array of {data.ndim} dimensions is no record: give times, or channels and times")
    along = next((dim for dim in data.dims if dim in ("t", "time")), data.dims[-1])
    others = [dim for dim in data.dims if dim != along]
    rows = data.transpose(*others, along).to_numpy()
    labels = [str(x) for x in data[others[0]].to_numpy()] if others else [str(data.name or "channel 0")]
    columns = list(zip(labels, rows if others else [rows], strict=True))
    if dt is not None:
        return _of_names(columns, dt, None, channels, quantity, resample)
    if along not in data.coords:
        raise RecordError(f"the dimension {along!r} has no coordinate and no times: give dt=, or times as its coordinate")
    times = data[along]
    axis = _seconds(times.to_numpy(), str(along), str(times.attrs.get("units", "")))
    return _of_axis(axis, columns, channels, quantity, resample)


def _leaves(name: str, value: Any) -> Iterator[tuple[str, np.ndarray[Any, Any] | str]]:
    """Numbers with dotted names: structures of MATLAB are arrays with fields, however deep. In place of other vectors, what they hold."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(f"{name}.{key}" if name else str(key), inner)
        return
    if np.ma.is_masked(value):
        raise InvalidValueError(f"{name} hides numbers under a mask: cut them off, or fill them (.filled)")
    try:
        array = np.asarray(value)
    except Exception as error:  # whatever a foreign object raises
        raise InvalidTypeError(f"{name} must hold real numbers: {error}") from error
    while array.dtype == object and array.size == 1 and isinstance(array.item(), np.ndarray):
        array = array.item()
    if array.dtype.names:
        for field in array.dtype.names:
            yield from _leaves(f"{name}.{field}" if name else field, array[field])
    elif array.dtype.kind in "mM" and array.size > 1:
        yield f"{name} [s]" if "[" not in name else name, _seconds(np.squeeze(array), "")
    elif array.dtype.kind in "fiu" and array.size:
        yield name, np.squeeze(array).astype(np.float64, copy=False)
    elif array.size > 1:
        yield name, f"it holds {array.dtype}, no real numbers"


def _of_names(
    data: Iterable[tuple[Any, Any]],
    dt: float | None,
    time: str | None,
    channels: Sequence[str],
    quantity: Quantity | None,
    resample: bool,
) -> Record:
    """Named vectors, by the rules of the reader of NPZ files."""
    leaves: dict[str, np.ndarray[Any, Any]] = {}
    left_out: dict[str, str] = {}
    for key, value in data:
        if str(key).startswith("__"):
            continue
        for name, leaf in _leaves(str(key), value):
            if name in leaves or name in left_out:
                raise RecordError(f"two arrays are called {name!r}: rename one of them")
            if isinstance(leaf, str):
                left_out[name] = leaf
            else:
                leaves[name] = leaf
    wanted = [name for name in (time, *channels) if name in left_out]
    if wanted:
        raise InvalidTypeError(f"{wanted[0]!r} is no vector of a record: {left_out[wanted[0]]}")
    if not any(leaf.size > 1 for leaf in leaves.values()):
        seen = "".join(f"; {name!r}: {reason}" for name, reason in left_out.items())
        raise InvalidTypeError(f"there is no vector of real numbers in these data{seen}")
    file = io.BytesIO()
    # As numpy.savez does, which cannot take every name.
    with zipfile.ZipFile(file, "w") as archive:
        for name, leaf in leaves.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, leaf, allow_pickle=False)
    rate = None if dt is None else 1.0 / dt
    return _read_bytes("data.npz", file.getvalue(), time, list(channels), rate, quantity, resample, list(left_out.items()))

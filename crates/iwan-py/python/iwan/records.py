"""Records from what other libraries hand out: pyuff, scipy.io, pandas and xarray."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from iwan._native import Record, _read_bytes
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
    Series or DataFrame or an xarray DataArray with times as its index (numbers, durations or dates; `units` and names such as
    `Time [ms]` are obeyed), or a DataFrame with its times in a column; an array with `dt` (s); a `Record`, returned as it is.
    `time`, `channels`, `quantity`, `resample`: as in `iwan.read_record`.

    Raises `iwan.InvalidValueError` or `iwan.RecordError` for data that are no record, `iwan.InvalidTypeError`.

    >>> record = iwan.as_record({"time": [0.0, 0.1, 0.2], "acc1": [1.0, 2.0, 4.0]})
    >>> record.names, record.dt, record.quantity
    (['acc1'], 0.1, 'acceleration')
    """
    if isinstance(data, Record):
        if dt is not None:
            raise InvalidValueError("dt goes with a bare array: a Record has its own")
        return data
    sets = data if isinstance(data, (list, tuple)) else [data]
    if sets and all(isinstance(one, Mapping) and "ordinate_spec_data_type" in one for one in sets):
        return _of_uff(sets)
    if isinstance(data, Mapping):
        return _of_names(data, dt, time, channels, quantity, resample)
    if hasattr(data, "to_numpy") and hasattr(data, "index"):
        return _of_pandas(data, dt, time, channels, quantity, resample)
    if hasattr(data, "coords") and hasattr(data, "dims"):
        return _of_xarray(data, dt, quantity)
    if isinstance(data, (str, os.PathLike)):
        raise InvalidTypeError(f"{os.fspath(data)!r} is a path: read it with iwan.read_record")
    if dt is None:
        raise InvalidValueError("dt is missing: a bare array needs its sampling interval in seconds, dt=")
    shape = np.shape(data)
    if len(shape) == 2 and shape[1] < _FEWEST <= shape[0]:
        raise InvalidValueError(f"the array has the shape {shape}: it must be channels x samples; transpose it")
    return Record(data, dt=dt, quantity=quantity or "unknown")


_FEWEST = 16
"""Samples that any method needs: an array with fewer of them in a row, and more rows, stands the other way round."""


def _of_uff(sets: Sequence[Mapping[str, Any]]) -> Record:
    """Datasets 58 as pyuff reads them: one channel each, sampled alike."""
    rows, names, axes = [], [], []
    for i, one in enumerate(sets):
        if int(one["func_type"]) != _UFF_TIME_RESPONSE:
            raise RecordError(f"dataset {i}: function type {one['func_type']} is no time response: choose datasets of type 1")
        values = np.asarray(one["data"])
        if np.iscomplexobj(values) and np.any(values.imag):
            raise RecordError(f"dataset {i}: the samples are complex: choose a time response")
        axis = np.asarray(one["x"], dtype=np.float64)
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
        quantity=_UFF_QUANTITIES.get(kinds.pop(), "unknown") if len(kinds) == 1 else "unknown",
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


def _on_axis(
    columns: Mapping[str, Any], axis: np.ndarray[Any, Any], dt: float | None, quantity: Quantity | None
) -> Record:
    start, step = (0.0, dt) if dt is not None else (float(axis[0]) if axis.size else 0.0, _step(axis))
    return Record(
        list(columns.values()), dt=step, names=list(columns), quantity=quantity or "unknown", start=start
    )


def _of_pandas(
    data: Any,
    dt: float | None,
    time: str | None,
    channels: Sequence[str],
    quantity: Quantity | None,
    resample: bool,
) -> Record:
    """A Series or a DataFrame. Its index holds the times, unless it counts rows or `time` names a column."""
    columns = {str(name): _plain(data[name]) for name in data.columns} if hasattr(data, "columns") else {
        str(data.name or "channel 0"): _plain(data)
    }
    index = data.index
    counts_rows = type(index).__name__ == "RangeIndex" and index.name is None
    if dt is None and (counts_rows or time in columns):
        if len(columns) == 1:
            raise RecordError("the index counts rows and is no time: give dt=, or times as the index")
        return _of_names(columns, dt, time, channels, quantity, resample)
    if dt is not None:
        return _of_names(columns, dt, None, channels, quantity, resample)
    if getattr(index, "tz", None) is not None:
        index = index.tz_convert(None)
    axis = _seconds(np.asarray(index), str(index.name or ""))
    if axis.size < 2:
        raise RecordError(f"{axis.size} times: a record needs at least 2 samples")
    if _INDEX in columns:
        raise RecordError(f"a column is called {_INDEX!r} beside an index of times: rename it, or give dt=, or time= of iwan.as_record")
    return _of_names({_INDEX: axis, **columns}, None, _INDEX, channels, quantity, resample)


_INDEX = "index [s]"
"""Name of the times of an index among the columns, with their unit."""


def _plain(column: Any) -> np.ndarray[Any, Any]:
    """Numbers of a column; pandas' own types of numbers with nothing where one is missing."""
    values = column.to_numpy()
    if values.dtype == object and getattr(column.dtype, "kind", "O") in "fiu":
        return np.asarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
    return np.asarray(values)


_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Units of time and their factors to seconds."""


def _seconds(axis: np.ndarray[Any, Any], name: str, unit: str = "") -> np.ndarray[Any, Any]:
    """Times in seconds: durations and dates by their own unit, numbers by the one beside them or in their name, `Time [ms]`."""
    if axis.dtype.kind == "M":
        axis = axis - axis[:1] if axis.size else axis.astype("m8[ns]")
    if axis.dtype.kind == "m":
        return axis / np.timedelta64(1, "s")
    if axis.dtype.kind not in "fiu":
        raise InvalidTypeError(f"the index holds {axis.dtype}, no times: give dt=, or times in seconds as the index")
    found = re.search(r"[\[(]([^\])]*)[\])]\s*$", name) or re.search(r"[_ ,](ms|us|µs|μs|ns|s)$", name)
    unit = unit.strip() or (found.group(1).strip() if found else "")
    words = {"second": "s", "millisecond": "ms", "microsecond": "us", "nanosecond": "ns", "minute": "min", "hour": "h", "sec": "s"}
    unit = words.get(unit.lower().rstrip("s"), unit)
    if unit and unit not in _UNITS:
        raise RecordError(f"the times are in {unit!r}, which is no unit of time (known are {', '.join(_UNITS)}): give dt=")
    return axis.astype(np.float64) * _UNITS[unit or "s"]


def _of_xarray(data: Any, dt: float | None, quantity: Quantity | None) -> Record:
    along = [dim for dim in data.dims if dim in ("t", "time")] or [data.dims[-1]]
    if data.ndim > 2:
        raise InvalidValueError(f"an array of {data.ndim} dimensions is no record: channels and times at most")
    rows = data.transpose(..., along[0]).to_numpy().reshape(-1, data.sizes[along[0]])
    others = [dim for dim in data.dims if dim != along[0]]
    labels = [str(x) for x in data[others[0]].to_numpy()] if others else [str(data.name or "channel 0")]
    times = data[along[0]]
    axis = _seconds(times.to_numpy(), str(along[0]), str(times.attrs.get("units", "")))
    return _on_axis(dict(zip(labels, rows, strict=True)), axis, dt, quantity)


def _leaves(name: str, value: Any) -> Iterator[tuple[str, np.ndarray[Any, Any]]]:
    """Numeric vectors with dotted names: structures of MATLAB are arrays with fields, however deep."""
    array = np.asarray(value)
    while array.dtype == object and array.size == 1 and isinstance(array.item(), np.ndarray):
        array = array.item()
    if array.dtype.names:
        for field in array.dtype.names:
            yield from _leaves(f"{name}.{field}" if name else field, array[field])
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(f"{name}.{key}" if name else str(key), inner)
    elif np.ma.is_masked(value):
        raise InvalidValueError(f"{name} hides numbers under a mask: cut them off, or fill them (.filled)")
    elif array.dtype.kind in "mM" and array.size > 1:
        yield f"{name} [s]" if "[" not in name else name, _seconds(np.squeeze(array), "")
    elif array.dtype.kind in "fiu" and array.size > 1:
        yield name, np.squeeze(array)


def _of_names(
    data: Mapping[str, Any],
    dt: float | None,
    time: str | None,
    channels: Sequence[str],
    quantity: Quantity | None,
    resample: bool,
) -> Record:
    """Named vectors, by the rules of the reader of NPZ files."""
    leaves = dict(leaf for key, value in data.items() if not str(key).startswith("__") for leaf in _leaves(str(key), value))
    if not leaves:
        raise InvalidTypeError("there is no vector of real numbers in these data")
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **leaves)
    rate = None if dt is None else 1.0 / dt
    return _read_bytes("data.npz", file.getvalue(), time, list(channels), rate, quantity, resample)

"""Which parts of which records a fit uses: lists of records, times between which they are cut, and the hits in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from iwan import _native
from iwan._native import Record
from iwan.errors import InvalidValueError
from iwan.records import as_record


@dataclass(frozen=True)
class Stretches:
    """Records as a fit uses them."""

    records: list[Record]
    notes: list[str]
    """Which hits of a record they are, where a structure is let go, and what disturbs them."""


def check_hits(hits: str | int) -> None:
    """Which hits are wanted: refused unless it is a choice that there can be."""
    number = isinstance(hits, (int, np.integer)) and not isinstance(hits, bool) and hits > 0
    if not number and not (isinstance(hits, str) and hits in ("all", "first")):
        raise InvalidValueError(f"hits = {hits!r}: must be 'all', 'first', or the number of a hit counted from 1")


def disturbed(disturbances: Sequence[Mapping[str, Any]]) -> list[str]:
    """What disturbs a record, in words with a remedy; but for clipping, which every fit looks after itself."""
    words = []
    for seen in disturbances:
        if seen["kind"] != "clipped":
            at = f"{seen['time']:.6f}"
            words.append(f"{seen['what']}, at {at} s; cut there with stop={at} or start={at}")
    return words


def stretches(
    records: Sequence[Any], dt: float | None, start: float | None, stop: float | None, hits: str | int
) -> Stretches:
    """What a fit uses of some records: the samples between two times, and of several hits in a record those that are wanted."""
    check_hits(hits)
    used: list[Record] = []
    notes = []
    for n, one in enumerate(records):
        record = as_record(one, dt=dt)
        if start is not None or stop is not None:
            record = record.between(start, stop)
        found, disturbances = record._overview()
        place = f"record {n}: " if len(records) > 1 else ""
        if len(found) > 1:
            times = ", ".join(f"{hit.start:.4f}" for hit in found)
            which = "each is used as a record of its own" if hits == "all" else f"number {1 if hits == 'first' else hits} is used"
            notes.append(f"{place}{len(found)} hits, at {times} s; {which} (hits=)")
        elif found[0].start > record.start:
            notes.append(f"{place}before {found[0].start:.6f} s the structure is pulled, held, handled or driven: the record begins there")
        notes.extend(f"{place}{words}" for words in disturbed(disturbances))
        if hits == "all":
            used.extend(found)
            continue
        number = 1 if hits == "first" else _native._whole("hits", hits)
        if number > len(found):
            raise InvalidValueError(f"{place}there is no hit {number} ({len(found)} found): choose hits='all', 'first', or one of those")
        used.append(found[number - 1])
    return Stretches(used, notes)


def several(record: Any) -> list[Any]:
    """A list of records: a list of numbers, of lists of numbers, or of datasets of `pyuff` (one channel each) is one record."""

    def is_record(one: Any) -> bool:
        table = hasattr(one, "to_numpy") and (hasattr(one, "index") or hasattr(one, "dims"))
        named = isinstance(one, Mapping) and "ordinate_spec_data_type" not in one
        return table or named or isinstance(one, (Record, np.ndarray))

    if isinstance(record, (list, tuple)) and record and all(is_record(one) for one in record):
        return list(record)
    return [record]

"""`iwan.reproduce` gives the numbers that the command writes: both are held to the same stored values."""

import json
from pathlib import Path
from typing import Any

import pytest

import iwan

STORED = Path(__file__).parents[2] / "iwan-cli" / "tests" / "reproduce.values.json"


def number(found: Any, entry: dict[str, Any]) -> float:
    """The number of a stored entry: at a JSON pointer, or by the names of its finding and of itself."""
    if "path" in entry:
        for key in entry["path"].split("/")[1:]:
            found = found[int(key) if isinstance(found, list) else key]
        return found
    [finding] = [f for f in found["findings"] if f["id"] == entry["finding"]]
    [own] = [n for n in finding["numbers"] if n["name"] == entry["number"]]
    return own["value"]


def band(entry: dict[str, Any]) -> tuple[float, float]:
    """What a stored entry allows, both ends included."""
    if "at_least" in entry:
        return entry["at_least"], entry["at_most"]
    half = entry["absolute"] if "absolute" in entry else entry["relative"] * abs(entry["value"])
    return entry["value"] - half, entry["value"] + half


def test_the_numbers_are_those_of_the_command() -> None:
    shares: list[int] = []
    found = iwan.reproduce(threads=2, progress=lambda done, total: shares.append(done))
    assert shares[-1] == 1000 and shares == sorted(shares)
    # Printed in Table 2 of the paper for the first mode of configuration B.
    rows = [row for row in found["table_2"] if row["configuration"] == "B"]
    assert rows[0]["printed"]["k_t"] == 4.45e4
    # The command's test (crates/iwan-cli/tests/reproduce.rs) holds its run without threads to these.
    for entry in json.loads(STORED.read_text())["values"]:
        low, high = band(entry)
        assert low <= number(found, entry) <= high, entry


def test_no_threads_at_all() -> None:
    with pytest.raises(iwan.InvalidValueError, match="threads = 0"):
        iwan.reproduce(threads=0)

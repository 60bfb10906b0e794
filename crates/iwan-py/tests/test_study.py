"""`iwan.reproduce` is what the command writes."""

import json
import os
import subprocess
from pathlib import Path

import pytest

import iwan


def test_the_numbers_are_those_of_the_command(tmp_path: Path) -> None:
    shares: list[int] = []
    found = iwan.reproduce(threads=2, progress=lambda done, total: shares.append(done))
    assert shares[-1] == 1000 and shares == sorted(shares)
    # Printed in Table 2 of the paper for the first mode of configuration B.
    rows = [row for row in found["table_2"] if row["configuration"] == "B"]
    assert rows[0]["printed"]["k_t"] == 4.45e4
    program = os.environ.get("IWAN_PROGRAM")
    if program is None:
        pytest.skip("IWAN_PROGRAM does not name the command")
    subprocess.run([program, "reproduce", "--quiet", "--out", tmp_path / "r"], check=True, capture_output=True)
    written = json.loads((tmp_path / "r" / "reproduce.json").read_text())
    for key in ("version", "figures", "files"):
        del written[key]
    assert found == written


def test_no_threads_at_all() -> None:
    with pytest.raises(iwan.InvalidValueError, match="threads = 0"):
        iwan.reproduce(threads=0)

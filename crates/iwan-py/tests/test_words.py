"""Errors, warnings and notes name the arguments of the function that was called, never options of the command line."""

import inspect
import re
from pathlib import Path

import numpy as np
import pytest

import iwan
import iwan.ensemble

ERRORS = (Path(__file__).parents[3] / "book/src/errors.md").read_text()
T = np.arange(4096) / 2048
UNEVEN, BACKWARDS, STUTTERS = T + 1e-4 * np.sin(40 * T), np.where(T == T[9], T[7], T), np.floor(np.arange(4096) / 2) / 1024


def decay(f, ratio=1.5e-3, t=T):
    return np.exp(-ratio * 2 * np.pi * f * t) * np.sin(2 * np.pi * f * t)


def said_of(text, functions):
    """No option is left, and every argument that is named is one of the function that was called, or of the function it is said to be of."""
    assert not re.search(r"(?<![\w-])--[a-z]", text), text
    for name, _, of in re.findall(r"(?<![\w.'\"])([a-z][a-z_]*)=(\S*)(?: of iwan\.(\w+))?", text):
        owners = [getattr(iwan, of)] if of else functions
        assert any(name in inspect.signature(owner).parameters for owner in owners), (name, text)
    return text


def written(path, columns):
    names = ",".join(columns)
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=names, comments="", fmt="%.9g")
    return path


FROM_FILES = {
    "no-time": {"a": np.cos(np.arange(64.0)), "b": np.sin(np.arange(64.0))},
    "time-order": {"time": BACKWARDS, "a": T},
    "time-repeated": {"time": STUTTERS, "a": T},
    "time-uneven": {"time": UNEVEN, "a": T},
    "several-times": {"one.time": T, "one.a": T, "two.time": 2 * T, "two.a": T},
}
"""Columns that are no record, by the kind of error that says so."""


@pytest.mark.parametrize("kind", FROM_FILES)
def test_what_is_wrong_in_files_and_in_data(kind, tmp_path):
    columns = FROM_FILES[kind]
    np.savez(tmp_path / "record.npz", **columns)
    calls = [
        (lambda: iwan.read_record(tmp_path / "record.npz"), [iwan.read_record]),
        (lambda: iwan.as_record(columns), [iwan.as_record]),
        # Whatever makes a record by `iwan.as_record` has fewer arguments.
        (lambda: iwan.envelope(columns), [iwan.envelope]),
        (lambda: iwan.fit(columns), [iwan.fit]),
    ]
    for call, functions in calls:
        with pytest.raises(iwan.RecordError) as caught:
            call()
        assert caught.value.kind == kind
        assert "=" in said_of(str(caught.value), functions)


def test_what_else_is_wrong_in_files(tmp_path):
    rows = {"time": T[:64], "a": T[:64]}
    no_unit = tmp_path / "no_unit.csv"
    no_unit.write_text("time [s],a [m/s^2],b [furlong]\n" + "".join(f"{t},{t},{t}\n" for t in T[:64]))
    np.savez(tmp_path / "lengths.npz", a=T[:64], b=T[:32])
    np.savez(tmp_path / "kinds.npz", time=T[:64], force=T[:64], pressure=T[:64])
    for kind, call in [
        ("time-unit", lambda: iwan.read_record(written(tmp_path / "unit.csv", {"t [furlong]": T[:64], "a": T[:64]}))),
        ("unit", lambda: iwan.read_record(no_unit, channels=["b"], unit="SI")),
        ("ambiguous", lambda: iwan.read_record(tmp_path / "lengths.npz", rate=10.0)),
        ("ambiguous", lambda: iwan.read_record(tmp_path / "kinds.npz")),
        ("value", lambda: iwan.read_record(written(tmp_path / "r.csv", rows), rate=-1.0)),
        ("unknown-name", lambda: iwan.read_record(tmp_path / "r.csv", channels=["z"])),
        ("stretch", lambda: iwan.read_record(tmp_path / "r.csv", start=7.0)),
    ]:
        with pytest.raises(iwan.IwanError) as caught:
            call()
        said_of(str(caught.value), [iwan.read_record])
        assert caught.value.kind == kind, (kind, caught.value.kind, str(caught.value))
    left_out = iwan.read_record(no_unit)
    assert left_out.names == ["a"] and left_out.warnings
    for warning in left_out.warnings:
        said_of(warning, [iwan.read_record])


def test_what_is_wrong_with_modes():
    two = decay(80.0, 0.01) + 0.9 * np.sin(2 * np.pi * 81.0 * T)
    beside = decay(80.0, 0.02) + 0.05 * np.sin(2 * np.pi * 84.0 * T)
    one, band = decay(80.0), (70.0, 90.0)
    for functions, call in [
        ([iwan.envelope], lambda: iwan.envelope(two, dt=1 / 2048, band=band)),
        ([iwan.fit], lambda: iwan.fit(two, dt=1 / 2048, band=band)),
        ([iwan.ensemble.envelope], lambda: iwan.ensemble.envelope([two], dt=1 / 2048, band=band)),
        ([iwan.envelope], lambda: iwan.envelope(beside, dt=1 / 2048, band=band)),
        ([iwan.fit], lambda: iwan.fit(beside, dt=1 / 2048, band=band)),
        ([iwan.envelope], lambda: iwan.envelope(one, dt=1 / 2048, window=(3.0, 1.0))),
        ([iwan.envelope], lambda: iwan.envelope(one[::-1], dt=1 / 2048)),
        ([iwan.envelope], lambda: iwan.envelope(iwan.Record(one, dt=1 / 2048, quantity="pressure"))),
        ([iwan.fit], lambda: iwan.fit(iwan.Record(one, dt=1 / 2048, quantity="pressure"))),
        ([iwan.fit_coupled], lambda: iwan.fit_coupled(one, dt=1 / 2048, bands=[band])),
        ([iwan.fit_coupled], lambda: iwan.fit_coupled(np.array([one, two]), dt=1 / 2048, bands=[band, (100.0, 120.0)])),
        ([iwan.fit_coupled], lambda: iwan.fit_coupled(one, dt=1 / 2048, shapes=[[1.0]], frequencies=[80.0])),
        ([iwan.modal_fit], lambda: iwan.modal_fit(None, one[None], 1 / 2048, band=(500.0, 600.0))),
    ]:
        with pytest.raises(iwan.IwanError) as caught:
            call()
        said_of(str(caught.value), functions)


def test_notes_of_a_fit_name_arguments():
    """What was assumed, and that a tone is higher than the mode: an argument takes the other."""
    hums = decay(80.0) + 0.9 * np.sin(2 * np.pi * 50.0 * T)
    for functions, notes in [
        ([iwan.envelope], iwan.envelope(hums, dt=1 / 2048).notes),
        ([iwan.fit], iwan.fit(hums, dt=1 / 2048).notes),
        ([iwan.fit], iwan.fit(hums, dt=1 / 2048).words),
    ]:
        for note in notes:
            said_of(note, functions)
    said = "\n".join(iwan.envelope(hums, dt=1 / 2048).notes)
    assert "(mode=50.0000 takes the line)" in said and "quantity= of iwan.Record says otherwise" in said


def test_the_catalogue_has_no_other_options():
    """Every kind whose remedy names an option is provoked above, or cannot be met in Python."""
    rows = re.findall(r"\| `([a-z-]+)` \| \d+ \| (.*) \| (.*) \|", ERRORS)
    assert len(rows) > 30
    named = {kind for kind, *words in rows if "--" in "".join(words)}
    here = {*FROM_FILES, "time-unit", "unit", "ambiguous", "stretch"}
    elsewhere = {
        "usage",  # of the command line alone
        "exists",  # test_fit.py, test_reports_appear_whole_or_not_at_all
        "memory",  # there is no such argument, and the limits of the system have no option
        "strict",  # of the command line alone
        "interrupted",  # KeyboardInterrupt
    }
    assert named <= here | elsewhere, named - here - elsewhere

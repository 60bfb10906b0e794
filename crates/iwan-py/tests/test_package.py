"""The package as a whole: documentation, types, names."""

import doctest
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import iwan
import iwan.errors

HERE = Path(__file__).parent
PUBLIC = [getattr(iwan, name) for name in iwan.__all__ if name != "__version__"]


def documented():
    """Every public object with its name: functions, classes, and what classes have."""
    modules = [thing for thing in PUBLIC if inspect.ismodule(thing)]
    for thing in PUBLIC + [getattr(module, name) for module in modules for name in module.__all__]:
        yield thing.__name__, thing
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            # What a class has of `iwan.steady` is written down there alone.
            classes = [thing, *(base for base in thing.__mro__[1:] if base.__module__ == "iwan.steady")]
            for name in [name for one in classes for name in vars(one)]:
                if not name.startswith("_"):
                    yield f"{thing.__name__}.{name}", getattr(thing, name)


THINGS = dict(documented())


def test_everything_public_is_documented():
    missing = [name for name, thing in THINGS.items() if not (inspect.getdoc(thing) or "").strip()]
    assert not missing


def test_every_function_has_an_example():
    functions = {n: t for n, t in THINGS.items() if callable(t) and not (inspect.isclass(t) and issubclass(t, Exception))}
    assert len(functions) > 30
    made_by_others = {"Ensemble", "Envelope", "Fit", "Fits", "Joint", "Pulse", "Response", "StaticCurves", "Structure", "StructureModes", "StructureResponse"}
    shown = [n for n, t in functions.items() if ">>>" in (t.__doc__ or "") or "Example: that of" in (t.__doc__ or "")]
    without = [n for n in functions if n not in shown and n not in made_by_others]
    assert not without


@pytest.mark.parametrize("name", [n for n, t in THINGS.items() if ">>>" in (inspect.getdoc(t) or "")] + ["package"])
def test_examples_in_docstrings(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = inspect.getdoc(THINGS.get(name, iwan))
    test = doctest.DocTestParser().get_doctest(text, {"iwan": iwan}, name, None, 0)
    assert test.examples
    assert doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


def test_types_are_those_of_the_stubs(tmp_path):
    """mypy's stubtest compares the stubs with what is there; mypy --strict checks package and use."""
    environment = os.environ | {"MYPY_CACHE_DIR": str(tmp_path)}
    for arguments in [
        ["mypy.stubtest", "iwan", "--ignore-disjoint-bases", "--allowlist", str(HERE / "stubtest.txt")],
        ["mypy", "--strict", "-p", "iwan"],
        ["mypy", "--strict", str(HERE / "typed_use.py")],
    ]:
        run = subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=tmp_path, env=environment)
        assert run.returncode == 0, run.stdout + run.stderr


def test_errors_have_the_kinds_of_the_catalogue(tmp_path):
    assert iwan.IwanError.kind == "failed" and iwan.InvalidValueError("x").kind == "value"
    times = tmp_path / "times.csv"
    times.write_text("t,a\n" + "".join(f"{t},1\n" for t in [0, 1, 2, 1.5, 3, 4]))
    garbage = tmp_path / "garbage.mat"
    garbage.write_bytes(b"MATLAB 5.0 MAT-file" + bytes(200))
    beam = tmp_path / "beam.toml"
    beam.write_text("[nothing]\n")
    short = np.sin(np.arange(20.0))
    for kind, call in [
        ("unreadable", lambda: iwan.read_record(tmp_path / "nowhere.csv")),
        ("time-order", lambda: iwan.read_record(times)),
        ("input", lambda: iwan.Structure.load(beam)),
        ("too-short", lambda: iwan.fit(short, dt=1e-3)),
        ("value", lambda: iwan.FourParameter(k_t=-1.0, f_s=1.0, chi=0.0, beta=0.0)),
    ]:
        with pytest.raises(iwan.IwanError) as caught:
            call()
        assert caught.value.kind == kind, (kind, caught.value.kind, caught.value)
    with pytest.raises(iwan.RecordError) as caught:
        iwan.read_record(garbage)
    assert caught.value.kind in {"damaged", "cut-short", "unsupported", "unknown-format"}, caught.value.kind


def test_errors_are_one_tree():
    classes = [c for c in vars(iwan.errors).values() if inspect.isclass(c)]
    assert len(classes) >= 8 and all(issubclass(c, iwan.IwanError) for c in classes)
    for c in classes:
        assert getattr(iwan, c.__name__) is c
    assert issubclass(iwan.InvalidValueError, ValueError) and issubclass(iwan.FileError, OSError)


PAGES = {"package": HERE.parent / "README.md", "project": HERE.parents[2] / "README.md", "book": HERE.parents[2] / "book/src/python.md"}


BOOK = HERE.parents[2] / "book/src"


def blocks_of(page):
    found = re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.S)
    assert found
    return found


@pytest.mark.parametrize("page", PAGES.values(), ids=PAGES.keys())
def test_readme_examples(page):
    """Blocks of a page that is read from its begin to its end."""
    names = {}
    for block in blocks_of(page):
        exec(compile(block, str(page), "exec"), names)


@pytest.mark.parametrize("page", sorted(page.stem for page in BOOK.glob("*.md") if "```python" in page.read_text() and page.stem != "python"))
def test_blocks_of_the_other_chapters_run_alone(page, tmp_path, monkeypatch):
    """Each of them: they stand in the middle of pages, and are what a reader copies."""
    monkeypatch.chdir(tmp_path)
    matplotlib.use("Agg")
    for block in blocks_of(BOOK / f"{page}.md"):
        exec(compile(block, page, "exec"), {})


def test_the_version_is_the_distributions():
    from importlib.metadata import version

    assert iwan.__version__ == version("iwan-ringdown")

"""Arguments of functions that are written in Python: converted, or refused by their names with errors of `iwan.errors`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from iwan.errors import InvalidTypeError, InvalidValueError

_Of = TypeVar("_Of")


def texts(name: str, given: Any) -> list[str]:
    """A list of texts; one text is no list of its letters."""
    listed = items(name, given)
    for i, one in enumerate(listed):
        if not isinstance(one, str):
            raise InvalidTypeError(f"{name}[{i}] must be a str, not {type(one).__name__}")
    return listed


def items(name: str, given: Any, wanted: str = "a sequence, such as a list") -> list[Any]:
    """The items of any iterable but a text."""
    if isinstance(given, (str, bytes)) or not isinstance(given, Iterable):
        raise InvalidTypeError(f"{name} must be {wanted}, not {type(given).__name__}")
    try:
        return list(given)
    except Exception as error:  # whatever a foreign object raises
        raise InvalidTypeError(f"{name} must be {wanted}: {error}") from error


def chosen(name: str, given: Any, choices: Sequence[str]) -> str:
    """One of several words."""
    known = "', '".join(choices)
    if not isinstance(given, str):
        raise InvalidTypeError(f"{name} must be one of '{known}', not {type(given).__name__}")
    if given not in choices:
        raise InvalidValueError(f"{name} = '{given}' is not known: choose one of '{known}'")
    return given


def instance(name: str, given: Any, kind: type[_Of]) -> _Of:
    """A value of one of the package's classes."""
    if not isinstance(given, kind):
        raise InvalidTypeError(f"{name} must be an iwan.{kind.__name__}, not {type(given).__name__}")
    return given


def by_name(name: str, given: Any, kind: type[_Of], alone: str) -> dict[str, _Of]:
    """Values of a class by their names; one of them alone is called `alone`."""
    if isinstance(given, kind):
        return {alone: given}
    if not isinstance(given, Mapping):
        raise InvalidTypeError(f"{name} must be an iwan.{kind.__name__} or a mapping of them by name, not {type(given).__name__}")
    return {str(key): instance(f"{name}[{key!r}]", one, kind) for key, one in given.items()}


def path(name: str, given: Any) -> Path:
    """A path."""
    try:
        return Path(os.fspath(given))
    except Exception as error:  # whatever a foreign object raises
        raise InvalidTypeError(f"{name} must be a path, a str or os.PathLike, not {type(given).__name__}") from error

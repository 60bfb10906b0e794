"""Long work in pieces that are kept: what was done before a process was killed is not done again."""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from iwan import _native
from iwan._arguments import path as path_of
from iwan.errors import FileError, InvalidValueError

_Piece = TypeVar("_Piece")

_SAID = "checkpoint.json"
"""What the pieces in the folder are of."""

_TEMPORARY = re.compile(r"(?:checkpoint|piece-[0-9]+)\.([0-9]+)")
"""Files that are being written end with the number of their process."""


class Checkpoint:
    """A folder with one file for each piece that is done.

    `of` names the work, `given` is all that its results depend on: a folder with pieces of other work is refused, so that results
    are never mixed. Pieces are written whole or not at all.
    """

    def __init__(self, folder: str | os.PathLike[str], of: str, given: Iterable[object], members: int, size: int) -> None:
        self.folder, self.members, self.size = path_of("checkpoint", folder), members, size
        said = {"of": of, "version": _native.__version__, "members": members, "size": size, "given": _digest(given)}
        path = self.folder / _SAID
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            _clear(self.folder)
            if not path.exists():
                if any(_TEMPORARY.fullmatch(other.name) is None for other in self.folder.iterdir()):
                    raise InvalidValueError(f"checkpoint {self.folder}: holds files, but no {_SAID}; give a folder of its own")
                _write(path, json.dumps(said, indent=1).encode())
            found = json.loads(path.read_text())
        except OSError as error:
            raise FileError(f"checkpoint {self.folder}: {error}; give a folder that may be written to") from error
        except ValueError as error:
            if isinstance(error, InvalidValueError):
                raise
            raise InvalidValueError(f"checkpoint {path}: is damaged ({error}); remove the folder") from error
        if found != said:
            keys = [key for key in said if not isinstance(found, dict) or found.get(key) != said[key]]
            raise InvalidValueError(
                f"checkpoint {self.folder}: is of other work ({', '.join(keys)} differ); "
                "call with the same arguments, or give another folder"
            )

    def pieces(self, compute: Callable[[int, int], _Piece], tell: Callable[[int], object] | None) -> list[_Piece]:
        """What `compute` gives for the members from one number to another, piece by piece; those that are done are read."""
        done = []
        for first in range(0, max(self.members, 1), self.size):
            last = min(first + self.size, self.members)
            path = self.folder / f"piece-{first:09}.pickle"
            piece = _read(path)
            if piece is None:
                piece = (compute(first, last),)
                _write(path, pickle.dumps(piece))
            done.append(piece[0])
            if tell is not None:
                tell(last)
        return done


def _read(path: Path) -> tuple[Any] | None:
    """The piece, in a tuple of its own; none where it is not done, or where its file is not whole."""
    try:
        piece = pickle.loads(path.read_bytes())
    except (OSError, EOFError, pickle.UnpicklingError, ValueError, AttributeError, ImportError, IndexError):
        return None
    return piece if isinstance(piece, tuple) and len(piece) == 1 else None


def _clear(folder: Path) -> None:
    """Remove what processes that live no longer have left half written: one killed while it began would be refused for ever."""
    for path in folder.iterdir():
        temporary = _TEMPORARY.fullmatch(path.name)
        if temporary and not _lives(int(temporary[1])):
            path.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    """Whether a process of this number lives, as far as the system can tell."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True


def _write(path: Path, content: bytes) -> None:
    temporary = path.with_suffix(f".{os.getpid()}")
    try:
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise FileError(f"{path}: cannot be written: {error}; check that the disk has space") from error


def _digest(given: Iterable[object]) -> str:
    """A number for all that results depend on."""
    digest = hashlib.sha256()
    for one in given:
        for part in _parts(one):
            digest.update(len(part).to_bytes(8, "little"))
            digest.update(part)
    return digest.hexdigest()


def _parts(one: object) -> Iterable[bytes]:
    if isinstance(one, _native.Record):
        yield repr((one.dt, one.start, one.names, one.quantity, one.unit)).encode()
        yield from _parts(one.samples)
    elif isinstance(one, np.ndarray):
        yield repr((one.dtype.str, one.shape)).encode()
        yield np.ascontiguousarray(one).tobytes()
    elif isinstance(one, list | tuple):
        for part in one:
            yield from _parts(part)
        yield b"end"
    else:
        yield repr(one).encode()

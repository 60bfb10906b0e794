"""Progress of long work: a line on a terminal, the caller's function, or nothing."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TypeAlias

from iwan.errors import InvalidTypeError

Progress: TypeAlias = bool | Callable[[int, int], object] | None
"""True, False, a function of the numbers done and in all, or None: shown where standard error is a terminal."""


def _shown(progress: bool | None) -> bool:
    """Whether a line is drawn: where it was asked for, or on a terminal."""
    return progress or (progress is None and sys.stderr.isatty())


class bar:
    """What to call with the number done: a line on a terminal, the caller's function, or nothing."""

    def __init__(self, progress: Progress, total: int) -> None:
        if not (progress is None or isinstance(progress, bool) or callable(progress)):
            raise InvalidTypeError(f"progress must be True, False, None or a function of two numbers, not {type(progress).__name__}")
        self.total, self.shown = total, False
        self.tell: Callable[[int], object] | None
        if callable(progress):
            self.tell = lambda done: progress(done, total)
        elif _shown(progress):
            self.tell = self.draw
        else:
            self.tell = None

    def draw(self, done: int) -> None:
        share = done / self.total if self.total else 1.0
        width = 40
        sys.stderr.write(f"\r[{'#' * int(share * width):<{width}}] {done}/{self.total}")
        sys.stderr.flush()
        self.shown = True

    def __enter__(self) -> Callable[[int], object] | None:
        return self.tell

    def __exit__(self, *_: object) -> None:
        if self.shown:
            sys.stderr.write("\n")


class busy:
    """A line on a terminal that says what is done and for how long, for work that cannot say how far it is."""

    def __init__(self, progress: bool | None, doing: str) -> None:
        if not (progress is None or isinstance(progress, bool)):
            raise InvalidTypeError("progress must be True, False or None here: this work cannot say how far it is")
        self.doing, self.begun, self.seconds = doing, time.monotonic(), -1
        self.tell = self.draw if _shown(progress) else None

    def draw(self, _: int) -> None:
        seconds = int(time.monotonic() - self.begun)
        if seconds > self.seconds:
            self.seconds = seconds
            sys.stderr.write(f"\r{self.doing}, {seconds} s")
            sys.stderr.flush()

    def __enter__(self) -> Callable[[int], object] | None:
        return self.tell

    def __exit__(self, *_: object) -> None:
        if self.seconds >= 0:
            sys.stderr.write("\n")

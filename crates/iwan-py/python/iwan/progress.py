"""Progress of long work: a line on a terminal, the caller's function, or nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TypeAlias

Progress: TypeAlias = bool | Callable[[int, int], object] | None
"""True, False, a function of the numbers done and in all, or None: shown where standard error is a terminal."""


class bar:
    """What to call with the number done: a line on a terminal, the caller's function, or nothing."""

    def __init__(self, progress: Progress, total: int) -> None:
        self.total, self.shown = total, False
        self.tell: Callable[[int], object] | None
        if callable(progress):
            self.tell = lambda done: progress(done, total)
        elif progress or (progress is None and sys.stderr.isatty()):
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

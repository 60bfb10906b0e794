"""The paper's tables and figures beside ours, as numbers."""

from __future__ import annotations

import json
from typing import Any

from iwan import _native
from iwan.progress import Progress, bar

#: Parts in which the compiled part tells how far it is.
_PARTS = 1000


def reproduce(*, threads: int | None = None, progress: Progress = None) -> dict[str, Any]:
    """Computes the beam of Deaner, Allen, Starr and Segalman anew, and everything that the paper says about it.

    The beam in two configurations under blows of 1 to 10,000 lbf with all discrete joints, its modal Iwan models, and a
    laboratory's view of it. Takes some ten seconds on two cores; the numbers do not depend on `threads` (all cores by default).

    Returns what `iwan reproduce` writes as reproduce.json, but for the lists of figures and files: `table_1` to `table_4`,
    `truth` (one entry per configuration), `lab`, `findings` (each with `title`, `kind`, `text` and `numbers`) and `units`.
    `progress`: as in `iwan.ensemble.simulate`, in thousandths. Raises `iwan.ComputationError` where a computation fails. The lock is
    released; Ctrl-C is honoured.

    Example: that of `iwan reproduce --json`, whose numbers these are.
    """
    with bar(progress, _PARTS) as tell:
        found: dict[str, Any] = json.loads(_native._reproduce(threads=threads, progress=tell))
    return found

"""Where figures are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from iwan.errors import IwanError

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def axes(ax: Axes | None) -> Axes:
    """The caller's axes, or new ones."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise IwanError("iwan.plot needs matplotlib: pip install 'iwan-ringdown[plot]'") from error
    return pyplot.subplots(layout="constrained")[1]

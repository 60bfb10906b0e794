"""Figures of mode shapes; part of `iwan.plot`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from iwan._axes import axes
from iwan._native import _number, _numbers
from iwan.errors import InvalidTypeError, InvalidValueError
from iwan.types import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from iwan.structure import StructureModes


def mode_shapes(
    position: ArrayLike, shapes: ArrayLike | Mapping[str, ArrayLike], *, ax: Axes | None = None
) -> Axes:
    """Draw mode shapes along a line.

    `position`: of the points, n numbers; `shapes`: modes x n, or one list of n numbers per name. Positions need no order.

    >>> import numpy as np
    >>> x = np.linspace(-1.0, 1.0, 21)
    >>> iwan.plot.mode_shapes(x, {"bending 1": x**2 - 0.3, "bending 2": x**3 - 0.6 * x}).get_legend().get_texts()[1].get_text()
    'bending 2'
    """
    ax = axes(ax)
    x = _numbers("position", position)
    if isinstance(shapes, Mapping):
        named = {str(name): _numbers(f"shapes['{name}']", shape) for name, shape in shapes.items()}
    else:
        rows = np.atleast_2d(_numbers("shapes", shapes))
        named = {f"mode {i + 1}": row for i, row in enumerate(rows)}
    order = np.argsort(x, kind="stable")
    for name, shape in named.items():
        if x.ndim != 1 or shape.shape != x.shape:
            raise InvalidValueError(f"shape '{name}' has {shape.size} values for {x.size} positions: one each")
        ax.plot(x[order], shape[order], marker=".", label=name)
    ax.axhline(0.0, linewidth=0.5, color="grey", zorder=0)
    ax.set(xlabel="position", ylabel="mass-normalised mode shape")
    ax.legend()
    return ax


def mode_shape(
    modes: StructureModes,
    mode: str = "bending 1",
    *,
    slipping: bool = False,
    part: float = 0.08,
    view: tuple[float, float] = (30.0, 28.0),
    ax: Axes | None = None,
) -> Axes:
    """Draw the outside of a structure, deformed by a mode and coloured by the size of its displacement.

    `modes`: of `Structure.modes`; `mode`: by name; `slipping`: the shape with all joints slipping; `part`: largest displacement
    drawn, over the diagonal of the structure; `view`: azimuth and elevation in degrees, the longest side running to the right
    and the shortest up. Parallel projection, faces from back to front.

    Raises `iwan.InvalidValueError` for a mode that does not exist.

    >>> modes = iwan.Structure.built_in("paper-a").modes(4)
    >>> iwan.plot.mode_shape(modes, "torsion 1").get_title()
    'torsion 1, 779.84 Hz, stuck'
    """
    from matplotlib.collections import PolyCollection

    if not isinstance(view, (tuple, list)) or len(view) != 2:
        raise InvalidTypeError("view must be two numbers: azimuth and elevation in degrees")
    view = _number("view[0]", view[0]), _number("view[1]", view[1])
    part = _number("part", part)
    number = modes.index(mode)
    shape = (modes.shapes_slipping if slipping else modes.shapes)[number]
    size = np.linalg.norm(shape, axis=1)
    sides = np.ptp(modes.nodes, axis=0)
    moved = modes.nodes + part * np.linalg.norm(sides) / max(float(size.max()), 1e-300) * shape
    corners = (moved @ _view(sides, *view).T)[modes.faces]
    across, along = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    towards = across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0] > 0
    order = np.flatnonzero(towards)[np.argsort(corners[towards, :, 2].mean(axis=1), kind="stable")]
    ax = axes(ax)
    drawn = PolyCollection(
        [face[:, :2] for face in corners[order]],
        array=size[modes.faces[order]].mean(axis=1),
        cmap="viridis",
        edgecolors="black",
        linewidths=0.2,
    )
    drawn.set_clim(0.0, float(size.max()))
    ax.add_collection(drawn)
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.set_axis_off()
    frequency = (modes.frequency_slipping if slipping else modes.frequency)[number]
    ax.set_title(f"{modes.names[number]}, {frequency:.2f} Hz, {'slipping' if slipping else 'stuck'}")
    return ax


def _view(sides: Array, azimuth: float, elevation: float) -> Array:
    """Rows: to the right, up, to the viewer, for a structure with these sides."""
    order = np.argsort(-sides, kind="stable")
    a, e = np.radians([azimuth, elevation])
    own = np.array([
        [np.cos(a), np.sin(a), 0.0],
        [-np.sin(a) * np.sin(e), np.cos(a) * np.sin(e), np.cos(e)],
        [np.sin(a) * np.cos(e), -np.cos(a) * np.cos(e), np.sin(e)],
    ])
    mixed = np.empty((3, 3))
    mixed[:, order] = own
    # An odd permutation mirrors: the middle side runs the other way then.
    mixed[:, order[1]] *= np.sign(np.linalg.det(mixed))
    return mixed

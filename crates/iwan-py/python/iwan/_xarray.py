"""Results for xarray."""

from __future__ import annotations

from typing import TYPE_CHECKING

from iwan._native import Response
from iwan.errors import IwanError

if TYPE_CHECKING:
    from xarray import Dataset


def dataset(response: Response) -> Dataset:
    """The histories of a response over time."""
    try:
        import xarray
    except ImportError as error:
        raise IwanError("this needs xarray: pip install 'iwan-ringdown[xarray]'") from error
    names = ("displacement", "velocity", "acceleration", "joint_force")
    histories = {name: ("t", getattr(response, name)) for name in names}
    figures = {name: value for name, value in response.statistics.items() if value is not None}
    return xarray.Dataset(histories, coords={"t": ("t", response.t, {"units": "s"})}, attrs=figures)

"""Types of arguments and results, for annotations."""

from collections.abc import Sequence
from typing import Literal, NotRequired, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""Any array of float64."""

Grid: TypeAlias = Literal["graded", "uniform"] | float
"""How a density is cut into sliders: graded, uniform, or the ratio > 1 of neighbouring strengths."""

Method: TypeAlias = Literal["newmark", "half-cycle", "averaging", "event"]
"""Methods of `simulate`."""

EnvelopeMethod: TypeAlias = Literal["hilbert", "peaks", "pff", "demodulation", "freevib"]
"""Methods of `envelope`."""

History: TypeAlias = Literal["displacement", "velocity", "acceleration", "joint_force"]
"""Histories that an ensemble may keep."""

Quantity: TypeAlias = Literal["acceleration", "velocity", "displacement", "force", "pressure", "voltage", "strain", "unknown"]
"""What a record measures."""


Pair: TypeAlias = Sequence[float]
"""Lower and upper end of a range, such as a band in Hz: a tuple, a list or any other sequence of two numbers."""


class Statistics(TypedDict):
    """Figures of a run; errors are relative to the peak displacement."""

    peak_displacement: float
    final_displacement: float
    slip_ratio: float
    energy_error: float
    time_step_error: float | None
    discretisation_error: float | None
    forgotten_force: float
    below_curves_from: NotRequired[float]
    above_curves_from: NotRequired[float]
    steps: int
    seconds: float


class Energy(TypedDict):
    """initial + input = kinetic + elastic + stored + viscous + friction + residual, mass-normalised."""

    initial: float
    input: float
    kinetic: float
    elastic: float
    stored: float
    viscous: float
    friction: float
    residual: float


class Motion(TypedDict):
    """Response at a point."""

    displacement: Array
    velocity: Array
    acceleration: Array

"""What fits of a mode with a four-parameter joint have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from iwan._native import FourParameter, Mode

Interval = tuple[float | None, float | None]


class SixParameters:
    """A mode with its joint and the 95 % intervals of the six parameters."""

    mode: Mode
    intervals: Mapping[str, Interval]

    @property
    def joint(self) -> FourParameter:
        """The joint, as identified."""
        return cast(FourParameter, self.mode.joint)

    @property
    def frequency(self) -> float:
        """Frequency at small amplitude, Hz."""
        return self.mode.frequency

    @property
    def damping_ratio(self) -> float:
        """Viscous damping ratio, in parallel with the joint."""
        return self.mode.damping_ratio

    @property
    def parameters(self) -> dict[str, float]:
        """All six by name."""
        joint = self.joint
        own = {"k_t": joint.k_t, "f_s": joint.f_s, "chi": joint.chi, "beta": joint.beta}
        return {"frequency": self.frequency, "damping_ratio": self.damping_ratio} | own

    def table(self) -> list[str]:
        """A line for each parameter: its name, its value and its interval.

        Example: that of `iwan.fit`.
        """

        def end(x: float | None) -> str:
            return "open" if x is None else f"{x:.6g}"

        return [
            f"{name:<14}{value:>14.7g}   95 %: {end(self.intervals[name][0])} to {end(self.intervals[name][1])}"
            for name, value in self.parameters.items()
        ]

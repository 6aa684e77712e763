"""How much of something is there, as a ratio of two sums: over pixels, and over as many frames as one likes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Share:
    """`part` of `whole`; added up, both sums grow, so that a frame with little to see counts little.

    Parameters
    ----------
    part, whole : float
        Of one unit.
    """

    part: float = 0.0
    whole: float = 0.0

    def __add__(self, other: Share) -> Share:
        return Share(self.part + other.part, self.whole + other.whole)

    @property
    def value(self) -> float:
        """The ratio; NaN where there is nothing, `whole` not being above 0."""
        return self.part / self.whole if self.whole > 0 else float("nan")

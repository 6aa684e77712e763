"""`Share`: a ratio of two sums over pixels, which can be added up over frames."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Share:
    """The ratio of `part` to `whole`. Adding shares adds both sums, so that a frame with few pixels counts little.

    Parameters
    ----------
    part, whole : float
        Both have the same unit. In an empty share both are 0.
    """

    part: float = 0.0
    whole: float = 0.0

    def __add__(self, other: Share) -> Share:
        return Share(self.part + other.part, self.whole + other.whole)

    @property
    def value(self) -> float:
        """The ratio; NaN if `whole` is not above 0."""
        return self.part / self.whole if self.whole > 0 else float("nan")

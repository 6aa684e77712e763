"""How much faster than Open Image Denoise the filter has to be."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.race import Spread


@dataclass(frozen=True)
class Bar:
    """At least `factor` times as fast as `rival`.

    Parameters
    ----------
    kind : str
        "bar", or "aim" for what would be better still.
    rival : str
        Who is raced against.
    factor : float
    """

    kind: str
    rival: str
    factor: float

    def __str__(self) -> str:
        return f"{self.kind}: {self.factor:g} x {self.rival}"

    def verdict(self, ratio: Spread) -> str:
        """Say whether the median of the ratios, round by round, reaches the bar."""
        return "holds" if ratio.median >= self.factor else "missed"


BARS = (Bar("bar", "OIDN high", 15.0), Bar("bar", "OIDN fast", 8.0), Bar("aim", "OIDN fast", 15.0))

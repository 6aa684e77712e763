"""How a buffer's planes are kept, in 32 bits or in 16; kernels/storage.clh shows the same from inside."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.filters.pipeline import Inputs, kind_of
from svgf_cl.settings import Settings

LIGHT = ("demodulated", "accumulated", "history", "moments", "level")
NORMALS = 3  # planes of the guide, behind all others


@dataclass(frozen=True)
class Planes:
    """How many planes make up a buffer: so many of 32 bits and, behind them, so many of 16."""

    full: int
    half: int = 0

    @property
    def depth(self) -> int:
        """Bits of a pixel."""
        return 32 * self.full + 16 * self.half

    @property
    def is_mixed(self) -> bool:
        """Whether there are planes of both kinds."""
        return bool(self.full and self.half)

    def over(self, other: Planes) -> Planes:
        """What has room for either."""
        return Planes(max(self.full, other.full), max(self.half, other.half))


def stored(buffer: str, inputs: Inputs, settings: Settings) -> Planes:
    """The planes of a buffer of the pass table."""
    kind, count = kind_of(buffer), inputs.planes(buffer)
    if kind in LIGHT and settings.half_history:
        return Planes(0, count)
    if kind == "guide" and settings.half_guides:
        return Planes(count - NORMALS, NORMALS)
    return Planes(count)

"""Which pixels around its own a pass reads: what it loads follows from that, and how wide an image's halo must be."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

Offset = tuple[int, int]


@dataclass(frozen=True)
class Taps:
    """Pixels that a work-item reads.

    Parameters
    ----------
    offsets : frozenset of (int, int), pixels
        (dx, dy) from its own pixel, or from that at or above and left of where the pixel was in the previous frame.
    follow_motion : bool
        Whether they lie around where the pixel was, so anywhere in the image.
    """

    offsets: frozenset[Offset]
    follow_motion: bool = False

    def __or__(self, other: Taps) -> Taps:
        return Taps(self.offsets | other.offsets, self.follow_motion or other.follow_motion)

    @property
    def reach(self) -> int:
        """Pixels along a row or a column to the farthest; 0 for taps that follow motion, as those are clamped."""
        return 0 if self.follow_motion else max(max(abs(dx), abs(dy)) for dx, dy in self.offsets)


def square(coordinates: Iterable[int]) -> frozenset[Offset]:
    """All pairs of these coordinates."""
    along = tuple(coordinates)
    return frozenset((dx, dy) for dx in along for dy in along)


def grid(radius: int, step: int = 1) -> Taps:
    """The (2 radius + 1)^2 pixels around the own one, `step` apart."""
    return Taps(square(range(-radius * step, radius * step + 1, step)))


def footprint(width: int) -> Taps:
    """The width x width pixels, an even number, around where the pixel was in the previous frame."""
    return Taps(square(range(1 - width // 2, width // 2 + 1)), follow_motion=True)


HERE = grid(0)
BLOCK = Taps(square(range(2)))
CROSS = Taps(frozenset({(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)}))

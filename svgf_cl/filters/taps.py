"""The pixels around its own that a pass reads; the halo of an image and the loads of a pass follow from them."""

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
        (dx, dy) from the pixel itself; if the taps follow motion, from the pixel at or above and left of the previous
        position.
    follow_motion : bool
        Whether the taps are around the pixel's position in the previous frame, which may be anywhere in the image.
    """

    offsets: frozenset[Offset]
    follow_motion: bool = False

    def __or__(self, other: Taps) -> Taps:
        return Taps(self.offsets | other.offsets, self.follow_motion or other.follow_motion)

    @property
    def reach(self) -> int:
        """The distance in pixels to the farthest tap, along a row or a column; 0 if taps follow motion.

        Taps that follow motion are clamped into the image.
        """
        return 0 if self.follow_motion else max(max(abs(dx), abs(dy)) for dx, dy in self.offsets)


def square(coordinates: Iterable[int]) -> frozenset[Offset]:
    """All pairs of these coordinates."""
    along = tuple(coordinates)
    return frozenset((dx, dy) for dx in along for dy in along)


def grid(radius: int, step: int = 1) -> Taps:
    """The (2 radius + 1)^2 pixels around the pixel itself, including it, `step` apart."""
    return Taps(square(range(-radius * step, radius * step + 1, step)))


def footprint(width: int) -> Taps:
    """The width x width pixels around the position in the previous frame; `width` is even."""
    return Taps(square(range(1 - width // 2, width // 2 + 1)), follow_motion=True)


HERE = grid(0)
BLOCK = Taps(square(range(2)))
CROSS = Taps(frozenset({(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)}))

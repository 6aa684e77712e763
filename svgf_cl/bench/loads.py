"""The bytes that a pass loads into registers: a plane is fetched from memory once, but loaded once for every neighbour.

A vector of neighbouring pixels that begins where vectors do is aligned. One that begins beside lies in two lines of the
cache, and many CPUs take two or three times as long to load it.
"""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.bench.traffic import FLOAT, bytes_moved, light_bytes, normal_bytes
from svgf_cl.device.layout import WIDEST_VECTOR
from svgf_cl.filters.pipeline import Inputs, Pass
from svgf_cl.settings import Settings

# Pixels (dx, dy) off a work-item's own.
Offsets = frozenset[tuple[int, int]]

HERE: Offsets = frozenset({(0, 0)})


@dataclass(frozen=True)
class Loads:
    """Bytes loaded; of a pixel, or of an image.

    Parameters
    ----------
    aligned : float
        In vectors that begin where a cache line does.
    offset : float
        In vectors that begin elsewhere.
    """

    aligned: float = 0.0
    offset: float = 0.0

    def __add__(self, other: Loads) -> Loads:
        return Loads(self.aligned + other.aligned, self.offset + other.offset)

    def __mul__(self, count: int) -> Loads:
        return Loads(self.aligned * count, self.offset * count)

    @property
    def bytes(self) -> float:
        """Both kinds."""
        return self.aligned + self.offset


def loads(entry: Pass, inputs: Inputs, settings: Settings) -> Loads:
    """What a pass loads per pixel."""
    if entry.kernel == "atrous":
        return atrous(entry, inputs, settings)
    return sum((loads_of(entry, name, inputs, settings) for name in entry.reads), Loads())


def square(radius: int, step: int = 1) -> Offsets:
    """The (2 radius + 1)^2 pixels around a work-item's own, `step` apart."""
    reach = range(-radius * step, radius * step + 1, step)
    return frozenset((dx, dy) for dx in reach for dy in reach)


def of_planes(planes: int, size: int, offsets: Offsets) -> Loads:
    """Loads of so many planes at each of these offsets, of elements of `size` bytes."""
    aligned = sum(dx % WIDEST_VECTOR == 0 for dx, _ in offsets)
    return Loads(aligned, len(offsets) - aligned) * (planes * size)


def atrous(entry: Pass, inputs: Inputs, settings: Settings) -> Loads:
    """Every tap of a level; depth and variance of the nearest neighbours too, for slope and 3x3 Gaussian."""
    assert entry.step is not None
    near, taps = square(1), square(settings.radius, entry.step)
    light = light_bytes(settings)
    guide = of_planes(1, FLOAT, near | taps) + of_planes(3, normal_bytes(settings), taps)
    return guide + (of_planes(3, light, taps) + of_planes(1, light, near | taps)) * inputs.signals


def loads_of(entry: Pass, buffer: str, inputs: Inputs, settings: Settings) -> Loads:
    """What any other pass loads of a buffer or a user's array."""
    moved = bytes_moved(entry, buffer, inputs, settings)
    match entry.kernel, buffer:
        case "temporal", "guide":  # the depth's four neighbours, for the slope
            return Loads(moved + 2 * FLOAT, 2 * FLOAT)
        case "temporal", "previous guide" | "history" | "previous moments":  # 2x2 taps, at any place
            return Loads(0, 4 * moved)
        case "taa", "guide" | "modulated":
            return of_planes(1, moved, square(1))
        case "taa", "previous antialiased":  # 4x4 taps, at any place
            return Loads(0, 16 * moved)
    return of_planes(1, moved, HERE)

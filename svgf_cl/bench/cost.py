"""Computes how much a pass must at least move, load and compute per pixel, as its filter declares it.

Bytes: every plane that a pass needs is read once, and every plane that it makes is written once. Neighbours come from a
cache. Loads: every neighbour is loaded from there. Operations: see `svgf_cl.filters.operations`.
"""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.device.layout import WIDEST_VECTOR
from svgf_cl.filters.pipeline import Pass, Use, spacing_of


@dataclass(frozen=True)
class Loads:
    """Bytes loaded into registers, for a pixel or an image.

    A vector of neighbouring pixels is aligned if it begins where a cache line does. Any other vector lies in two cache
    lines, and many CPUs take two or three times as long to load it.

    Parameters
    ----------
    aligned : float
        Bytes in aligned vectors.
    offset : float
        Bytes in other vectors.
    """

    aligned: float = 0.0
    offset: float = 0.0

    def __add__(self, other: Loads) -> Loads:
        return Loads(self.aligned + other.aligned, self.offset + other.offset)

    def __mul__(self, count: float) -> Loads:
        return Loads(self.aligned * count, self.offset * count)

    @property
    def bytes(self) -> float:
        """Bytes of both kinds."""
        return self.aligned + self.offset


@dataclass(frozen=True)
class Cost:
    """Bytes moved, bytes loaded and floating-point operations, for a pixel or an image."""

    bytes: float
    loads: Loads
    flops: float

    def __mul__(self, pixels: int) -> Cost:
        return Cost(self.bytes * pixels, self.loads * pixels, self.flops * pixels)


def cost(entry: Pass) -> Cost:
    """Return the cost of a pass per pixel."""
    moved = sum(use.quantity.nbytes / spacing_of(each) ** 2 for each in entry.accesses for use in each.uses)
    loaded = sum((loads(use) for each in entry.reads for use in each.uses), Loads())
    share = 1 / entry.spacing**2  # the share of the image's pixels that the pass writes
    return Cost(moved, loaded * share, entry.operations * share)


def loads(use: Use) -> Loads:
    """Return how much a pass loads of a quantity per pixel."""
    offsets = use.taps.offsets
    aligned = 0 if use.taps.follow_motion else sum(dx % WIDEST_VECTOR == 0 for dx, _ in offsets)
    return Loads(aligned, len(offsets) - aligned) * use.quantity.nbytes

"""The layout of an image on the device: a stack of planes with a halo. kernels/layout.clh is the kernels' side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

HALO = 32  # pixels on every side: the reach of the widest a-trous level, 2 taps of step 16
WIDEST_VECTOR = 16  # pixels: rows begin at a whole vector
ROW_ALIGNMENT = 64  # pixels: then the taps of the widest level, 16 rows apart, lie at the same place in a page
PAGE = 1024  # pixels, 4 KiB: if all rows were a multiple of this apart, they would compete for a few cache lines


@dataclass(frozen=True)
class Layout:
    """Where the pixels of a (height, width) image lie in a plane.

    Parameters
    ----------
    height, width : int, pixels, >= 1
    row_alignment : int, pixels
        The distance between rows is a multiple of it, but not of `PAGE`. It is a multiple of `WIDEST_VECTOR`, and less
        than `PAGE`.
    """

    height: int
    width: int
    row_alignment: int = ROW_ALIGNMENT

    @property
    def pitch(self) -> int:
        """Elements from one row to the next."""
        aligned = rounded_up(self.width + 2 * HALO, self.row_alignment)
        return aligned if aligned % PAGE else aligned + self.row_alignment

    def every(self, spacing: int) -> Layout:
        """Return the layout of an image that has one pixel in `spacing`, along both axes, from the first on."""
        return replace(self, height=-(-self.height // spacing), width=-(-self.width // spacing))

    @property
    def rows(self) -> int:
        """Rows of a plane, halo included."""
        return self.height + 2 * HALO

    @property
    def plane(self) -> int:
        """Elements of a plane."""
        return self.rows * self.pitch

    def vectors(self, width: int, step: int = 1) -> tuple[int, int]:
        """Return how many vectors of `width` pixels there are along a row, and how many rows.

        The number of rows is rounded up to a multiple of `step`, because atrous.cl takes every `step`-th row in turn.
        """
        return -(-self.width // width), rounded_up(self.height, step)

    def indexable(self, planes: int) -> bool:
        """Whether the kernels' 32-bit indices reach every element of a buffer of `planes` planes."""
        return planes * self.plane < 2**31

    @property
    def size(self) -> np.ndarray:
        """The kernels' `size` argument, an int4."""
        return np.array([self.width, self.height, self.pitch, self.plane], np.int32)

    def nbytes(self, depth: int) -> int:
        """Bytes of a buffer that has `depth` bits a pixel."""
        return depth // 8 * self.plane

    def crop(self, planes: np.ndarray) -> np.ndarray:
        """Return a view of the image without its halo: (n * plane,) -> (n, height, width).

        An incomplete plane at the end is left out.
        """
        stack = planes[: len(planes) // self.plane * self.plane].reshape(-1, self.rows, self.pitch)
        return stack[:, HALO : HALO + self.height, HALO : HALO + self.width]


def rounded_up(length: int, unit: int) -> int:
    """Return the least multiple of `unit` that is no less than `length`."""
    return -(-length // unit) * unit

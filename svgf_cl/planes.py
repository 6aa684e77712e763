"""The device's layout of an image: a stack of planes with a halo; kernels/common.clh shows the same from inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

HALO = 32  # pixels on every side: the reach of the widest a-trous level, 2 taps of step 16
ROW_ALIGNMENT = 16  # pixels: the widest vector
LARGEST_BUFFER = 8  # planes: colour and variance of two signals


@dataclass(frozen=True)
class Layout:
    """Where the pixels of a (height, width) image lie in a plane.

    Parameters
    ----------
    height, width : int, pixels, >= 1
    """

    height: int
    width: int

    @property
    def pitch(self) -> int:
        """Elements from one row to the next."""
        return -(-self.width // ROW_ALIGNMENT) * ROW_ALIGNMENT + 2 * HALO

    @property
    def rows(self) -> int:
        """Rows of a plane, halo included."""
        return self.height + 2 * HALO

    @property
    def plane(self) -> int:
        """Elements of a plane."""
        return self.rows * self.pitch

    def work_items(self, vector_width: int, group: tuple[int, int]) -> tuple[int, int]:
        """Vectors along a row and rows, each rounded up to whole work-groups; kernels skip those outside the image."""
        vectors = -(-self.width // vector_width)
        return -(-vectors // group[0]) * group[0], -(-self.height // group[1]) * group[1]

    @property
    def indexable(self) -> bool:
        """Whether the kernels' 32-bit indices reach every element of the largest buffer."""
        return LARGEST_BUFFER * self.plane < 2**31

    @property
    def size(self) -> np.ndarray:
        """The kernels' `size` argument, an int4."""
        return np.array([self.width, self.height, self.pitch, self.plane], np.int32)

    def nbytes(self, planes: int) -> int:
        """Bytes of a buffer of so many float32 planes."""
        return 4 * planes * self.plane

    def crop(self, planes: np.ndarray) -> np.ndarray:
        """The image inside: (n * plane,) -> (n, height, width), a view."""
        stack = planes.reshape(-1, self.rows, self.pitch)
        return stack[:, HALO : HALO + self.height, HALO : HALO + self.width]

"""How planes store numbers, in 32 or in 16 bits, and how they are read back; kernels/storage.clh does the same."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

SNORM_MAX = 32767  # the integer that stands for 1
HALF_MAX = 65504.0  # the largest finite 16-bit float


class Format(Enum):
    """The type of a plane's elements, and how an element represents a value."""

    FLOAT = "float32", "the value"
    SNORM = "int16", "a value of -1..1 times SNORM_MAX"
    HALF = "float16", "the value"
    ROOT = "float16", "the square root: a variance itself would leave the range of 16 bits"

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """The type of an element."""
        return np.dtype(self.value[0])

    @property
    def nbytes(self) -> int:
        """Bytes of an element."""
        return self.dtype.itemsize

    def encoded(self, value: float) -> NDArray[np.generic]:
        """The element that represents a value, as an array without axes."""
        if self is Format.SNORM:
            return np.array(round(value * SNORM_MAX), self.dtype)
        return np.array(value**0.5 if self is Format.ROOT else value, self.dtype)

    def decoded(self, elements: NDArray[np.generic]) -> NDArray[np.float32]:
        """The values that elements represent, as a copy."""
        values = np.array(elements, np.float32, order="C")
        if self is Format.SNORM:
            values /= SNORM_MAX
        return values * values if self is Format.ROOT else values


@dataclass(frozen=True)
class Planes:
    """The number of planes of a buffer: planes of 32 bits, followed by planes of 16 bits."""

    full: int
    half: int = 0

    @property
    def depth(self) -> int:
        """Bits per pixel."""
        return 32 * self.full + 16 * self.half

    @property
    def count(self) -> int:
        """Planes of both kinds."""
        return self.full + self.half

    @property
    def is_mixed(self) -> bool:
        """Whether there are planes of both kinds."""
        return bool(self.full and self.half)

    def over(self, other: Planes) -> Planes:
        """The smallest number of planes of each kind that has room for either buffer."""
        return Planes(max(self.full, other.full), max(self.half, other.half))

"""How the numbers of a plane are kept, in 32 bits or in 16, and read back; kernels/storage.clh matches it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

SNORM_MAX = 32767  # the whole number that stands for 1
HALF_MAX = 65504.0  # the greatest 16-bit float


class Format(Enum):
    """What a plane's elements are: their type, and what they hold of a value."""

    FLOAT = "float32", "the value"
    SNORM = "int16", "a value of -1..1 times SNORM_MAX"
    HALF = "float16", "the value"
    ROOT = "float16", "the square root: a variance itself would leave the range of 16 bits"

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """Of an element."""
        return np.dtype(self.value[0])

    @property
    def nbytes(self) -> int:
        """Of an element."""
        return self.dtype.itemsize

    def encoded(self, value: float) -> NDArray[np.generic]:
        """The element that stands for a value, as an array without axes."""
        if self is Format.SNORM:
            return np.array(round(value * SNORM_MAX), self.dtype)
        return np.array(value**0.5 if self is Format.ROOT else value, self.dtype)

    def decoded(self, elements: NDArray[np.generic]) -> NDArray[np.float32]:
        """What elements stand for, as a copy."""
        values = np.array(elements, np.float32, order="C")
        if self is Format.SNORM:
            values /= SNORM_MAX
        return values * values if self is Format.ROOT else values


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
    def count(self) -> int:
        """Planes of either kind."""
        return self.full + self.half

    @property
    def is_mixed(self) -> bool:
        """Whether there are planes of both kinds."""
        return bool(self.full and self.half)

    def over(self, other: Planes) -> Planes:
        """What has room for either."""
        return Planes(max(self.full, other.full), max(self.half, other.half))

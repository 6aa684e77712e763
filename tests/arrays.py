"""The same values in every form in which a user may hold them."""

from __future__ import annotations

from pathlib import Path

import numpy as np


def strided(value: np.ndarray) -> np.ndarray:
    """The same values as every other element of a larger array."""
    return np.repeat(value, 2, axis=1)[:, ::2]


def backwards(value: np.ndarray) -> np.ndarray:
    """The same values with rows from last to first in memory."""
    return value[::-1].copy()[::-1]


def inside(value: np.ndarray) -> np.ndarray:
    """The same values as a part of a larger picture."""
    return np.pad(value, [(1, 1)] * 2 + [(0, 0)] * (value.ndim - 2))[1:-1, 1:-1]


def read_only(value: np.ndarray) -> np.ndarray:
    value = value.copy()
    value.flags.writeable = False
    return value


def unaligned(value: np.ndarray) -> np.ndarray:
    """The same values, one byte off."""
    memory = np.empty(value.nbytes + 1, np.uint8)
    odd = memory[1:].view(value.dtype).reshape(value.shape)
    odd[:] = value
    return odd


def mapped_file(value: np.ndarray, path: Path) -> np.ndarray:
    """The same values in pages that nobody can write to, 8 bytes off their beginning."""
    np.concatenate([np.zeros(2, value.dtype), value.ravel()]).tofile(path)
    return np.memmap(path, value.dtype, "r", 8, value.shape)


def big_endian(value: np.ndarray) -> np.ndarray:
    return value.astype(value.dtype.newbyteorder(">"))


def one_row(value: np.ndarray) -> np.ndarray:
    """The first row, seen in the place of every other: all rows are the same memory."""
    return np.broadcast_to(value[:1], value.shape)

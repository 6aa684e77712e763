"""The same values in every form in which a user may hold them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array


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


def like(queue: cl.CommandQueue, host: np.ndarray, view: np.ndarray) -> cl_array.Array:
    """What `view` is of `host`, of its copy on the device."""
    buffer = cl.Buffer(queue.context, cl.mem_flags.COPY_HOST_PTR, hostbuf=host)
    offset = view.ctypes.data - host.ctypes.data
    return cl_array.Array(queue, view.shape, view.dtype, data=buffer, offset=offset, strides=view.strides)


def behind_others(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """The same values, at an offset."""
    whole = np.ascontiguousarray(np.concatenate([value[:1], value]))
    return like(queue, whole, whole[1:])


def in_columns(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """The same values, column by column."""
    whole = value.copy("F")
    return like(queue, whole.T, whole)


def in_pixels_of_16(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """The same values as some channels of an image of many: (H, W, 16)."""
    channels = value.shape[2] if value.ndim == 3 else 1
    whole = np.zeros((*value.shape[:2], 16), value.dtype)
    view = whole[..., 3 : 3 + channels]
    view[...] = value.reshape(view.shape)
    return like(queue, whole, view if value.ndim == 3 else whole[..., 3])


def in_planes(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """The same values with one plane a channel: (C, H, W), behind another plane."""
    planes = np.moveaxis(value.reshape(*value.shape[:2], -1), -1, 0)
    whole = np.ascontiguousarray(np.concatenate([planes[:1], planes]))
    return like(queue, whole, np.moveaxis(whole[1:], 0, -1) if value.ndim == 3 else whole[1])


def bottom_up(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """The same values with rows from last to first in memory."""
    whole = value[::-1].copy()
    return like(queue, whole, whole[::-1])


def of_one_row(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    """The same values, if those of all rows are the same: only one is in memory."""
    whole = np.ascontiguousarray(value)
    return like(queue, whole, one_row(whole))


STRIDED: tuple[Callable[[cl.CommandQueue, np.ndarray], cl_array.Array], ...] = (
    behind_others,
    in_columns,
    in_pixels_of_16,
    in_planes,
    bottom_up,
)


def fetched(value: np.ndarray | cl_array.Array) -> np.ndarray:
    """A numpy array of it, whatever the strides."""
    if isinstance(value, np.ndarray):
        return value
    memory = np.empty(value.base_data.size, np.uint8)
    cl.enqueue_copy(value.queue or cl.CommandQueue(value.context), memory, value.base_data, wait_for=value.events)
    return np.ndarray(value.shape, value.dtype, memory, value.offset, value.strides)

"""Images whose elements lie anywhere in a buffer, as `pyopencl.array.Array` describes them, and copies between them."""

from __future__ import annotations

from typing import cast

import numpy as np
import numpy.typing as npt
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device import programs

WORD = 4  # bytes of an element, be it float32 or uint32


class StridedCopies:
    """The kernel that copies images between layouts, for one queue and one thread at a time.

    pyopencl does not copy Arrays with strides. OpenCL's copies of rectangles cannot change the order of axes, and take
    rows only at multiples of the distance between pixels.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._by_rows = copies_rows(queue.device)
        program = programs.build(queue.context, queue.device, "strided_copy", {})
        self._kernel = cl.Kernel(program, "strided_copy")

    def enqueue(self, source: cl_array.Array, target: cl_array.Array) -> cl.Event:
        """Copy (H, W) or (H, W, C) elements; the two must not be the same memory."""
        height, width, channels = (*source.shape, 1)[:3]
        # A work-group of one has Intel's compiler leave the loop over a row as it is: ten times as fast as with
        # vectors that gather.
        run, work_group = (width, (1, 1)) if self._by_rows else (1, None)
        self._kernel.set_args(
            *map(np.int32, (width, channels, run)),
            *(layout(source), layout(target), buffer_of(source), buffer_of(target)),
        )
        return cl.enqueue_nd_range_kernel(self._queue, self._kernel, (width // run, height), work_group)


def copies_rows(device: cl.Device) -> bool:
    """Whether a work-item is to copy a row, not a pixel."""
    return bool(device.type & cl.device_type.CPU)


def buffer_of(array: cl_array.Array) -> cl.Buffer:
    """The buffer that an Array lies in; memory of a pool, and SVM, are handed to kernels just like one."""
    return cast("cl.Buffer", array.base_data)


def layout(array: cl_array.Array) -> npt.NDArray[np.int64]:
    """Offset, then the strides of rows, pixels and channels, in elements."""
    return np.array((array.offset, *array.strides, 0)[:4], np.int64) // WORD


def is_plain(array: cl_array.Array) -> bool:
    """Whether the elements fill a buffer from its first byte on, in C order."""
    return not array.offset and bool(array.flags.c_contiguous)


def is_aligned(array: cl_array.Array) -> bool:
    """Whether every element lies at a multiple of its size."""
    return all(step % WORD == 0 for step in (array.offset, *array.strides))


def span(array: cl_array.Array) -> tuple[int, int]:
    """The first byte of all elements in their buffer, and that behind the last; below 0 before its beginning."""
    reach = [(count - 1) * step for count, step in zip(array.shape, array.strides, strict=True)]
    return array.offset + sum(min(0, step) for step in reach), array.offset + sum(max(0, step) for step in reach) + WORD


def is_apart(array: cl_array.Array) -> bool:
    """Whether no two elements can be the same memory: each axis steps over all that those of smaller steps reach."""
    axes = sorted((abs(step), count) for count, step in zip(array.shape, array.strides, strict=True) if count > 1)
    reach = 0
    for step, count in axes:
        if step <= reach:
            return False
        reach += (count - 1) * step
    return True

"""Copies images with any offset and strides, as `pyopencl.array.Array` describes them."""

from __future__ import annotations

from typing import cast

import numpy as np
import numpy.typing as npt
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device import programs

WORD = 4  # bytes of an element, float32 or uint32


class StridedCopies:
    """The kernel that copies images between layouts, for one queue and one thread at a time.

    pyopencl does not copy Arrays with strides. OpenCL's copies of rectangles cannot change the order of axes, and need
    rows at multiples of the distance between pixels.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._by_rows = copies_rows(queue.device)
        program = programs.build(queue.context, queue.device, "strided_copy", {})
        self._kernel = cl.Kernel(program, "strided_copy")

    def enqueue(self, source: cl_array.Array, target: cl_array.Array) -> cl.Event:
        """Queue a copy of (H, W) or (H, W, C) elements; the two Arrays must not share memory."""
        height, width, channels = (*source.shape, 1)[:3]
        # With a work-group of one, Intel's compiler does not vectorise the loop over a row: ten times as fast as with
        # vectors that gather.
        run, work_group = (width, (1, 1)) if self._by_rows else (1, None)
        self._kernel.set_args(
            *map(np.int32, (width, channels, run)),
            *(layout(source), layout(target), buffer_of(source), buffer_of(target)),
        )
        return cl.enqueue_nd_range_kernel(self._queue, self._kernel, (width // run, height), work_group)


def copies_rows(device: cl.Device) -> bool:
    """Whether a work-item copies a row, not a pixel."""
    return bool(device.type & cl.device_type.CPU)


def buffer_of(array: cl_array.Array) -> cl.Buffer:
    """Return the buffer that an Array lies in; kernels take memory of a pool, and SVM, in the same way."""
    return cast("cl.Buffer", array.base_data)


def layout(array: cl_array.Array) -> npt.NDArray[np.int64]:
    """Return the offset, then the strides of rows, pixels and channels, in elements."""
    return np.array((array.offset, *array.strides, 0)[:4], np.int64) // WORD


def is_plain(array: cl_array.Array) -> bool:
    """Whether the elements are C-contiguous and begin at the buffer's first byte."""
    return not array.offset and bool(array.flags.c_contiguous)


def is_aligned(array: cl_array.Array) -> bool:
    """Whether every element lies at a multiple of its size."""
    return all(step % WORD == 0 for step in (array.offset, *array.strides))


def span(array: cl_array.Array) -> tuple[int, int]:
    """Return the first byte of all elements in their buffer, and the byte after the last.

    A negative number lies before the buffer.
    """
    reach = [(count - 1) * step for count, step in zip(array.shape, array.strides, strict=True)]
    return array.offset + sum(min(0, step) for step in reach), array.offset + sum(max(0, step) for step in reach) + WORD


def is_apart(array: cl_array.Array) -> bool:
    """Whether no two elements share memory: each axis steps over all bytes that the axes of smaller steps reach."""
    axes = sorted((abs(step), count) for count, step in zip(array.shape, array.strides, strict=True) if count > 1)
    reach = 0
    for step, count in axes:
        if step <= reach:
            return False
        reach += (count - 1) * step
    return True

"""The way in and out for the user's arrays: device arrays as they are, numpy arrays in place on a CPU, else copied."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeGuard, cast

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device.opencl_errors import allocate, lack_of_room
from svgf_cl.filters.pipeline import OUT
from svgf_cl.frame import UserArray, check_array, wrong


class UserArrays:
    """Lets kernels read a frame's arrays and write its result.

    Where the call waits for a numpy result anyway, and the device works in the host's memory, numpy arrays stay where
    they are. Else they are copied, by way of buffers that are kept from frame to frame.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._kept: dict[str, cl.Buffer] = {}

    def buffers(self, fields: Mapping[str, UserArray], result: UserArray) -> dict[str, cl.Buffer]:
        """The device buffers of a frame's fields and, under the name `OUT`, of its result.

        Raises
        ------
        FrameError, ArgumentError
            If an Array is not plain memory of this queue's context, or the result is the memory of a field.
        DeviceError
            If the device has no room.
        """
        arrays = {OUT: result} | {name: as_read(name, value) for name, value in fields.items()}
        device = {name: self._given(name, value) for name, value in arrays.items() if isinstance(value, cl_array.Array)}
        check_apart(device)
        host = {name: value for name, value in arrays.items() if isinstance(value, np.ndarray)}
        wrapped = self._wrapped(host) if self._works_in_place(result) else {}
        copied = {name: self._copied(name, value) for name, value in host.items() if name not in wrapped}
        return device | wrapped | copied

    def drop_copies(self) -> None:
        """Give back what was kept for frames of another size or with other fields."""
        self._kept.clear()

    @contextmanager
    def in_use(self, buffers: Mapping[str, cl.Buffer], result: UserArray) -> Iterator[None]:
        """Around the passes: afterwards a numpy result is complete, and all numpy arrays are their owners' again."""
        try:
            yield
            if self._works_in_place(result):
                self._show(buffers[OUT], result)
            elif isinstance(result, np.ndarray):
                cl.enqueue_copy(self._queue, result, buffers[OUT])
        finally:
            if self._works_in_place(result):  # after an error too: passes before it may still be at work
                self._queue.finish()

    def _works_in_place(self, result: UserArray) -> TypeGuard[np.ndarray]:
        return isinstance(result, np.ndarray) and result.flags.aligned and shares_memory(self._queue.device)

    def _given(self, name: str, value: cl_array.Array) -> cl.Buffer:
        """The buffer behind a user's `Array`, used as it is."""
        wanted = np.dtype(np.uint32 if name == "id" else np.float32)
        if value.dtype != wanted:
            raise wrong(name, f"dtype {wanted}", f"dtype {value.dtype}")
        if value.offset or not value.flags.c_contiguous:
            raise wrong(name, "a C-contiguous Array with offset 0 (use .copy())", "a view")
        if value.context != self._queue.context:
            raise wrong(name, "an Array in the context of Denoiser(queue=...)", "one of another context")
        if not isinstance(value.base_data, cl.MemoryObjectHolder):
            raise wrong(name, "an Array in a buffer or memory pool", type(value.base_data).__name__)
        if value.base_data.size < value.nbytes:
            raise wrong(name, f"a buffer of {value.nbytes} bytes", f"one of {value.base_data.size}")
        return cast("cl.Buffer", value.base_data)  # one from a pool is used just like it

    def _wrapped(self, arrays: Mapping[str, np.ndarray]) -> dict[str, cl.Buffer]:
        """Buffers that are the arrays' own memory; no two may overlap (OpenCL 1.2, 5.2.1), so others are left out."""
        chosen: dict[str, np.ndarray] = {}
        for name, value in arrays.items():
            if not any(np.may_share_memory(value, other) for other in chosen.values()):
                chosen[name] = value
        return {name: wrap(self._queue, value) for name, value in chosen.items()}

    def _copied(self, name: str, value: np.ndarray) -> cl.Buffer:
        """A buffer that stays with the denoiser; a field's values are in it when this returns."""
        if name not in self._kept or self._kept[name].size != value.nbytes:
            self._kept[name] = allocate(self._queue, value.nbytes, value.nbytes)
        if name != OUT:
            cl.enqueue_copy(self._queue, self._kept[name], value, is_blocking=True)
        return self._kept[name]

    def _show(self, buffer: cl.Buffer, result: np.ndarray) -> None:
        """Have the host see what kernels wrote to a wrapped array."""
        mapped, _ = cl.enqueue_map_buffer(self._queue, buffer, cl.map_flags.READ, 0, result.shape, result.dtype)
        mapped.base.release(self._queue)


def shares_memory(device: cl.Device) -> bool:
    """Whether a device works in the host's memory as well as in its own; a GPU without its own is left to copies."""
    return bool(device.type & cl.device_type.CPU)


def as_read(name: str, value: UserArray) -> UserArray:
    """A field as kernels read it: a numpy array of another type, order or alignment is converted."""
    if isinstance(value, cl_array.Array):
        return value
    with np.errstate(over="ignore"):  # beyond float32 is infinite, and treated as such
        return np.require(value, np.uint32 if name == "id" else np.float32, ("C", "ALIGNED"))


def wrap(queue: cl.CommandQueue, value: np.ndarray) -> cl.Buffer:
    """A buffer that is a numpy array's own memory, and keeps it alive.

    It says nothing of reading or writing: marked as read only, arrays that do not begin at a multiple of 128 bytes
    would be copied by Intel's runtime, at 10 ms for an image of 720p.
    """
    with lack_of_room(queue.device, value.nbytes, value.nbytes):
        return cl.Buffer(queue.context, cl.mem_flags.USE_HOST_PTR, hostbuf=value)


def check_apart(buffers: Mapping[str, cl.Buffer]) -> None:
    """Raise `ArgumentError` where the result would overwrite a field that neighbouring pixels still read."""
    if OUT not in buffers:
        return
    result, begin, end = place(buffers[OUT])
    for name, buffer in buffers.items():
        memory, first, last = place(buffer)
        if name != OUT and memory == result and first < end and begin < last:
            raise wrong(OUT, "memory of its own", f"that of {name}")


def place(buffer: cl.Buffer) -> tuple[int, int, int]:
    """Where a buffer lies: in which memory, as it may be part of another; its first byte and that behind its last."""
    whole = cast("cl.Buffer | None", buffer.get_info(cl.mem_info.ASSOCIATED_MEMOBJECT)) or buffer
    return whole.int_ptr, buffer.offset, buffer.offset + buffer.size


def check_out(out: Any, shape: tuple[int, int, int]) -> None:
    """Raise `ArgumentError` unless a result of this shape can be written to `out`."""
    check_array(OUT, out)
    if tuple(out.shape) != shape or out.dtype != np.float32:
        raise wrong(OUT, f"shape {shape}, float32", f"shape {tuple(out.shape)}, {out.dtype}")
    if not out.flags.c_contiguous or (isinstance(out, np.ndarray) and not out.flags.writeable):
        raise wrong(OUT, "a writable C-contiguous array", "a view or read-only array")

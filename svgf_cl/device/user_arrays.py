"""The way in and out for the user's arrays: in place where kernels can work on them as they lie, else copied."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeGuard, cast

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device.opencl_errors import allocate, lack_of_room
from svgf_cl.device.strided import StridedCopies, buffer_of, is_aligned, is_apart, is_plain, span
from svgf_cl.filters.pipeline import OUT
from svgf_cl.frame import ALPHA, check_array, element_type, wrong
from svgf_cl.interchange import UserArray


class Copy(NamedTuple):
    """A copy on the device from one Array to another, and what it is called in a profile."""

    label: str
    source: cl_array.Array
    target: cl_array.Array


@dataclass(frozen=True)
class Exchange:
    """What the passes of one frame work on, and the copies around them.

    Parameters
    ----------
    buffers : dict of str to pyopencl.Buffer
        What the passes read, by the names of fields, and, under the name `OUT`, write: in C order from the first byte.
    landing : pyopencl.Buffer
        Where the result is on the device in the end.
    before, after : sequence of Copy
        To be made before the passes and after them.
    """

    buffers: dict[str, cl.Buffer]
    landing: cl.Buffer
    before: Sequence[Copy]
    after: Sequence[Copy]


class UserArrays:
    """Lets kernels read a frame's arrays and write its result.

    Where the call waits for a numpy result anyway, and the device works in the host's memory, numpy arrays stay where
    they are. Else they are copied, by way of buffers that are kept from frame to frame. Arrays are used as they are,
    unless they have strides or an offset, or alpha: these are copied on the device, from and to buffers that are kept.
    """

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._kept: dict[str, cl.Buffer] = {}
        self._strided: StridedCopies | None = None  # built where it is needed

    def exchange(self, fields: Mapping[str, UserArray], result: UserArray) -> Exchange:
        """What the passes work on for these fields and this result.

        Parameters
        ----------
        fields : mapping of str to array
            Those that the passes read, as `Frame.layer` gives them; and `ALPHA` where the result has four channels.
        result : (H, W, 3) or (H, W, 4) array

        Raises
        ------
        FrameError, ArgumentError
            If an Array is not memory of this queue's context, or the passes would write to what they read.
        DeviceError
            If the device has no room.
        """
        arrays = {OUT: result} | {name: as_read(name, value) for name, value in fields.items()}
        given = {name: value for name, value in arrays.items() if isinstance(value, cl_array.Array)}
        for name, value in given.items():
            check_given(name, value, self._queue.context)
        direct = {name: buffer_of(value) for name, value in given.items() if is_plain(value)}
        if ALPHA in fields:
            direct.pop(OUT, None)
        check_apart(direct)
        before = {name: self._gather(name, value) for name, value in given.items() if name not in (OUT, *direct)}
        gathered = {name: buffer_of(copy.target) for name, copy in before.items()}
        host = {name: value for name, value in arrays.items() if isinstance(value, np.ndarray)}
        buffers = direct | gathered | self._from_host(host, result)
        landing = buffers[OUT] if OUT in buffers else buffer_of(given[OUT])
        after = []
        if ALPHA in fields or OUT not in buffers:
            target = given[OUT] if OUT in given else self._array(landing, result.shape)
            after = self._scatter(target, buffers.get(ALPHA))
            buffers[OUT] = buffer_of(after[0].source)
        if before or after:
            self._strided = self._strided or StridedCopies(self._queue)
        return Exchange(buffers, landing, tuple(before.values()), tuple(after))

    def copy(self, copies: Sequence[Copy]) -> list[tuple[str, cl.Event]]:
        """Put copies on the queue: label and event of each."""
        if self._strided is None:
            return []
        return [(copy.label, self._strided.enqueue(copy.source, copy.target)) for copy in copies]

    def drop_copies(self) -> None:
        """Give back what was kept for frames of another size or with other fields."""
        self._kept.clear()

    @contextmanager
    def in_use(self, exchange: Exchange, result: UserArray) -> Iterator[None]:
        """Around all that is done: then a numpy result is complete, and all numpy arrays are their owners' again."""
        try:
            yield
            if self._works_in_place(result):
                self._show(exchange.landing, result)
            elif isinstance(result, np.ndarray):
                cl.enqueue_copy(self._queue, result, exchange.landing)
        finally:
            if self._works_in_place(result):  # after an error too: passes before it may still be at work
                self._queue.finish()

    def _works_in_place(self, result: UserArray) -> TypeGuard[np.ndarray]:
        return isinstance(result, np.ndarray) and result.flags.aligned and shares_memory(self._queue.device)

    def _gather(self, name: str, value: cl_array.Array) -> Copy:
        """From a field that has strides or an offset."""
        return Copy(f"gather {name}", value, self._scratch(name, value.shape, value.dtype))

    def _scatter(self, target: cl_array.Array, alpha: cl.Buffer | None) -> list[Copy]:
        """To a result that the passes cannot write: its light, and its alpha where it has that."""
        light = self._scratch("light", (*target.shape[:2], 3))
        copies = [Copy("scatter light", light, target[..., :3])]
        if alpha:
            copies.append(Copy("scatter alpha", self._array(alpha, target.shape[:2]), target[..., 3]))
        return copies

    def _scratch(self, name: str, shape: tuple[int, ...], dtype: np.dtype | type = np.float32) -> cl_array.Array:
        """An Array in a buffer that stays with the denoiser."""
        nbytes = math.prod(shape) * np.dtype(dtype).itemsize
        return self._array(self._keep(f"scratch {name}", nbytes), shape, dtype)

    def _array(self, buffer: cl.Buffer, shape: tuple[int, ...], dtype: np.dtype | type = np.float32) -> cl_array.Array:
        """A whole buffer as an Array in C order."""
        return cl_array.Array(self._queue, shape, dtype, data=buffer)

    def _from_host(self, arrays: Mapping[str, np.ndarray], result: UserArray) -> dict[str, cl.Buffer]:
        """Buffers of numpy arrays: their own memory where the device works in it, else copies."""
        wrapped = self._wrapped(arrays) if self._works_in_place(result) else {}
        return wrapped | {name: self._copied(name, value) for name, value in arrays.items() if name not in wrapped}

    def _wrapped(self, arrays: Mapping[str, np.ndarray]) -> dict[str, cl.Buffer]:
        """Buffers that are the arrays' own memory; no two may overlap (OpenCL 1.2, 5.2.1), so others are left out."""
        chosen: dict[str, np.ndarray] = {}
        for name, value in arrays.items():
            if not any(np.may_share_memory(value, other) for other in chosen.values()):
                chosen[name] = value
        return {name: wrap(self._queue, value) for name, value in chosen.items()}

    def _copied(self, name: str, value: np.ndarray) -> cl.Buffer:
        """A buffer that stays with the denoiser; a field's values are in it when this returns."""
        buffer = self._keep(name, value.nbytes)
        if name != OUT:
            cl.enqueue_copy(self._queue, buffer, value, is_blocking=True)
        return buffer

    def _keep(self, name: str, nbytes: int) -> cl.Buffer:
        """The buffer of this name and size: that of the last frame, where it had one."""
        if name not in self._kept or self._kept[name].size != nbytes:
            self._kept[name] = allocate(self._queue, nbytes, nbytes)
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
        return np.require(value, element_type(name), ("C", "ALIGNED"))


def check_given(name: str, value: cl_array.Array, context: cl.Context) -> None:
    """Raise the error of `wrong` unless kernels of this context can read or write all elements of a user's Array."""
    wanted = np.dtype(element_type(name))
    if value.dtype != wanted:
        raise wrong(name, f"dtype {wanted}", f"dtype {value.dtype}")
    if value.context != context:
        raise wrong(name, "an Array in the context of Denoiser(queue=...)", "one of another context")
    if not isinstance(value.base_data, cl.MemoryObjectHolder):
        raise wrong(name, "an Array in a buffer or memory pool", type(value.base_data).__name__)
    if not is_aligned(value):
        steps = f"offset {value.offset}, strides {value.strides}"
        raise wrong(name, f"an offset and strides of whole elements, {wanted.itemsize} bytes each", steps)
    first, end = span(value)
    if first < 0 or end > value.base_data.size:
        place = f"bytes {first} to {end} of one of {value.base_data.size}"
        raise wrong(name, "elements inside their buffer", place)


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
    if isinstance(out, np.ndarray) and not (out.flags.c_contiguous and out.flags.writeable):
        raise wrong(OUT, "a writable C-contiguous array", "a view or read-only array")
    if isinstance(out, cl_array.Array) and not is_apart(out):
        raise wrong(OUT, "memory of its own for every element", f"strides {out.strides}")

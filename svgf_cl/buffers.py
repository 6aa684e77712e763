"""Device memory of a denoiser: planes that it owns, and the way in and out for the user's arrays."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.errors import FrameError, SvgfError
from svgf_cl.passes import Inputs, Pass, persistent_buffers, scratch_slots
from svgf_cl.planes import Layout

UserArray = np.ndarray | cl_array.Array


# What a buffer holds before the first frame: a guide of zeros shows nothing, so there is no history; NaN is no colour.
BLANK = {"antialiased": np.nan, "previous antialiased": np.nan}


class Buffers:
    """The planes that a pass table needs, by name; they begin as `BLANK` says."""

    def __init__(
        self, queue: cl.CommandQueue, layout: Layout, passes: tuple[Pass, ...], inputs: Inputs, *, share: bool
    ) -> None:
        self._queue = queue
        slots = scratch_slots(passes, share=share)
        planes = {name: inputs.planes(name) for name in persistent_buffers(passes)}
        sizes = {slot: max(inputs.planes(name) for name in slots if slots[name] == slot) for slot in slots.values()}
        self.nbytes = sum(layout.nbytes(count) for count in (*planes.values(), *sizes.values()))
        scratch = {slot: self._filled(0.0, layout.nbytes(count)) for slot, count in sizes.items()}
        self._by_name = {
            name: self._filled(BLANK.get(name, 0.0), layout.nbytes(count)) for name, count in planes.items()
        }
        self._by_name |= {name: scratch[slot] for name, slot in slots.items()}

    def __getitem__(self, name: str) -> cl.Buffer:
        return self._by_name[name]

    def survives(self, name: str) -> bool:
        """Whether a buffer still holds at the frame's end what was written to it: no later one shares its memory."""
        owners = [other for other, buffer in self._by_name.items() if buffer is self._by_name[name]]
        return owners[-1] == name

    def begin_frame(self) -> None:
        """Turn what was written in the last frame into history."""
        for previous in [name for name in self._by_name if name.startswith("previous ")]:
            current = previous.removeprefix("previous ")
            self._by_name[previous], self._by_name[current] = self._by_name[current], self._by_name[previous]

    def read(self, name: str) -> np.ndarray:
        """A copy of a whole buffer, flat float32."""
        buffer = self._by_name[name]
        result = np.empty(buffer.size // 4, np.float32)
        cl.enqueue_copy(self._queue, result, buffer)
        return result

    def _filled(self, value: float, nbytes: int) -> cl.Buffer:
        buffer = allocate(self._queue, nbytes)
        try:
            cl.enqueue_fill_buffer(self._queue, buffer, np.float32(value), 0, nbytes)
        except cl.MemoryError as error:  # some drivers look for the room only now
            raise out_of_memory(self._queue, nbytes) from error
        return buffer


class Uploads:
    """Brings a frame's arrays to the device; buffers for numpy arrays are kept from frame to frame."""

    def __init__(self, queue: cl.CommandQueue) -> None:
        self._queue = queue
        self._kept: dict[str, cl.Buffer] = {}

    def buffer(self, name: str, value: UserArray) -> cl.Buffer:
        """The device buffer of field `name`; a numpy array may be changed by its owner as soon as this returns."""
        if isinstance(value, cl_array.Array):
            return self.device_buffer(name, value)
        with np.errstate(over="ignore"):  # beyond float32 is infinite, and treated as such
            host = np.ascontiguousarray(value, np.uint32 if name == "id" else np.float32)
        kept = self.keep(name, host.nbytes)
        cl.enqueue_copy(self._queue, kept, host, is_blocking=True)
        return kept

    def keep(self, name: str, nbytes: int) -> cl.Buffer:
        """A buffer of this size that stays with the denoiser."""
        if name not in self._kept or self._kept[name].size != nbytes:
            self._kept[name] = allocate(self._queue, nbytes)
        return self._kept[name]

    def device_buffer(self, name: str, value: cl_array.Array) -> cl.Buffer:
        """The buffer behind a user's `Array`, used as it is.

        Raises
        ------
        FrameError
            If it is not plain C-contiguous memory of the kernels' type in this queue's context.
        """
        wanted = np.dtype(np.uint32 if name == "id" else np.float32)
        if value.dtype != wanted:
            raise FrameError(name, f"dtype {wanted}", f"dtype {value.dtype}")
        if value.offset or not value.flags.c_contiguous:
            raise FrameError(name, "a C-contiguous Array with offset 0 (use .copy())", "a view")
        if value.context != self._queue.context:
            raise FrameError(name, "an Array in the context of Denoiser(queue=...)", "one of another context")
        if not isinstance(value.base_data, cl.MemoryObjectHolder):
            raise FrameError(name, "an Array in a buffer or memory pool", type(value.base_data).__name__)
        return cast(cl.Buffer, value.base_data)  # one from a pool is used just like it


def allocate(queue: cl.CommandQueue, nbytes: int) -> cl.Buffer:
    """A buffer of uninitialised memory; `SvgfError` where the device has no room."""
    try:
        return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, nbytes)
    except (cl.MemoryError, cl.LogicError) as error:
        raise out_of_memory(queue, nbytes) from error


def out_of_memory(queue: cl.CommandQueue, nbytes: int) -> SvgfError:
    """The error that says what was asked of which device."""
    return SvgfError(f"the device {queue.device.name} has no room for a buffer of {nbytes / 2**20:.0f} MiB")


def check_out(out: Any, shape: tuple[int, int, int]) -> None:
    """Raise `FrameError` unless a result of this shape can be written to `out`."""
    if not isinstance(out, np.ndarray | cl_array.Array):
        raise FrameError("out", "a numpy.ndarray or pyopencl.array.Array", type(out).__name__)
    if tuple(out.shape) != shape or out.dtype != np.float32:
        raise FrameError("out", f"shape {shape}, float32", f"shape {tuple(out.shape)}, {out.dtype}")
    if not out.flags.c_contiguous or (isinstance(out, np.ndarray) and not out.flags.writeable):
        raise FrameError("out", "a writable C-contiguous array", "a view or read-only array")

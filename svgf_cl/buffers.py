"""Device memory of a denoiser: the planes that it owns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyopencl as cl

from svgf_cl.errors import SvgfError
from svgf_cl.memory import Slot
from svgf_cl.passes import PREVIOUS
from svgf_cl.planes import Layout

# What a buffer holds before the first frame: a guide of zeros shows nothing, so there is no history; NaN is no colour.
BLANK = {"antialiased": np.nan, "previous antialiased": np.nan}


class Buffers:
    """The memory of a pass table by the names of its buffers; it begins as `BLANK` says.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    layout : Layout
    slots : sequence of Slot
        As `svgf_cl.memory.memory_slots` gives them.
    """

    def __init__(self, queue: cl.CommandQueue, layout: Layout, slots: Sequence[Slot]) -> None:
        self._queue = queue
        self._slots = {name: slot for slot in slots for name in slot.buffers}
        self._memory = {
            slot.name: self._filled(BLANK.get(slot.name, 0.0), layout.nbytes(slot.planes.depth)) for slot in slots
        }
        self._copies: dict[str, cl.Buffer] = {}

    @property
    def nbytes(self) -> int:
        """Device memory in use, in bytes."""
        return sum(buffer.size for buffer in (*self._memory.values(), *self._copies.values()))

    def __getitem__(self, name: str) -> cl.Buffer:
        return self._memory[self._slots[name].name]

    def begin_frame(self) -> None:
        """Turn what was written in the last frame into history."""
        for previous in [name for name in self._memory if name.startswith(PREVIOUS)]:
            current = previous.removeprefix(PREVIOUS)
            self._memory[previous], self._memory[current] = self._memory[current], self._memory[previous]

    def copy_aside(self, name: str) -> None:
        """Have `read` find what a buffer holds now, though another takes its memory."""
        if name not in self._copies:
            self._copies[name] = allocate(self._queue, self[name].size)
        cl.enqueue_copy(self._queue, self._copies[name], self[name])

    def survives(self, name: str) -> bool:
        """Whether `read` finds what was written to a buffer in this frame."""
        return name in self._copies or self._slots[name].buffers[-1] == name

    def read(self, name: str) -> np.ndarray:
        """A copy of a whole buffer, flat float32."""
        buffer = self._copies.get(name, self[name])
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


def allocate(queue: cl.CommandQueue, nbytes: int) -> cl.Buffer:
    """A buffer of uninitialised memory; `SvgfError` where the device has no room."""
    try:
        return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, nbytes)
    except (cl.MemoryError, cl.LogicError) as error:
        raise out_of_memory(queue, nbytes) from error


def out_of_memory(queue: cl.CommandQueue, nbytes: int) -> SvgfError:
    """The error that says what was asked of which device."""
    return SvgfError(f"the device {queue.device.name} has no room for a buffer of {nbytes / 2**20:.0f} MiB")

"""Device memory of a denoiser: the planes that it owns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyopencl as cl

from svgf_cl.device.layout import Layout
from svgf_cl.device.memory_plan import Slot
from svgf_cl.device.opencl_errors import allocate, check_room, lack_of_room
from svgf_cl.filters.pipeline import PREVIOUS

# What a buffer holds before the first frame: a guide of zeros shows nothing, so there is no history; NaN is no colour.
BLANK = {"antialiased": np.nan, "previous antialiased": np.nan}


class Buffers:
    """The memory of a pass table by the names of its buffers; it begins as `BLANK` says.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    layout : Layout
    slots : sequence of Slot
        As `svgf_cl.device.memory_plan.memory_slots` gives them.
    copies : bool
        Whether there is to be room for `copy_aside`.

    Raises
    ------
    DeviceError
        If the device has no room for all.
    """

    def __init__(self, queue: cl.CommandQueue, layout: Layout, slots: Sequence[Slot], *, copies: bool = False) -> None:
        self._queue = queue
        self._slots = {name: slot for slot in slots for name in slot.buffers}
        sizes = {slot.name: layout.nbytes(slot.planes.depth) for slot in slots}
        kept = {name: sizes[slot.name] for name, slot in self._slots.items() if copies and not is_previous(name)}
        needed = sum(sizes.values()) + sum(kept.values())
        check_room(queue.device, needed)
        self._memory = {name: self._filled(BLANK.get(name, 0.0), size, needed) for name, size in sizes.items()}
        self._copies = {name: allocate(queue, size, needed) for name, size in kept.items()}

    @property
    def nbytes(self) -> int:
        """Device memory in use, in bytes."""
        return sum(buffer.size for buffer in (*self._memory.values(), *self._copies.values()))

    def __getitem__(self, name: str) -> cl.Buffer:
        return self._memory[self._slots[name].name]

    def begin_frame(self) -> None:
        """Turn what was written in the last frame into history."""
        for previous in [name for name in self._memory if is_previous(name)]:
            current = previous.removeprefix(PREVIOUS)
            self._memory[previous], self._memory[current] = self._memory[current], self._memory[previous]

    def copy_aside(self, name: str) -> None:
        """Have `read` find what a buffer holds now, though another takes its memory."""
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

    def _filled(self, value: float, nbytes: int, needed: int) -> cl.Buffer:
        buffer = allocate(self._queue, nbytes, needed)
        with lack_of_room(self._queue.device, nbytes, needed):  # some drivers look for the room only now
            cl.enqueue_fill_buffer(self._queue, buffer, np.float32(value), 0, nbytes)
        return buffer


def is_previous(name: str) -> bool:
    """Whether a buffer holds what another of a pair held in the last frame."""
    return name.startswith(PREVIOUS)

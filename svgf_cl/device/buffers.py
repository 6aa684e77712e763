"""Device memory of a denoiser: the planes that it owns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyopencl as cl

from svgf_cl.device.layout import Layout
from svgf_cl.device.memory_plan import Slot
from svgf_cl.device.opencl_errors import allocate, check_room, lack_of_room
from svgf_cl.filters.pipeline import Buffer, Resource, history_of


class Buffers:
    """The memory of a pipeline by its buffers; all of it holds zeros at first.

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
        self._queue, self._layout = queue, layout
        self._slot_of = {buffer: number for number, slot in enumerate(slots) for buffer in slot.buffers}
        self._last_in_slot = {slot.buffers[-1] for slot in slots}
        sizes = [layout.every(slot.spacing).nbytes(slot.planes.depth) for slot in slots]
        kept = {buffer: sizes[number] for buffer, number in self._slot_of.items() if copies and not buffer.previous}
        needed = sum(sizes) + sum(kept.values())
        check_room(queue.device, needed)
        self._memory = [self._zeros(size, needed) for size in sizes]
        self._copies = {buffer: allocate(queue, size, needed) for buffer, size in kept.items()}

    @property
    def nbytes(self) -> int:
        """Device memory in use, in bytes."""
        return sum(buffer.size for buffer in (*self._memory, *self._copies.values()))

    def __getitem__(self, buffer: Buffer) -> cl.Buffer:
        return self._memory[self._slot_of[buffer]]

    def begin_frame(self) -> None:
        """Turn what was written in the last frame into history."""
        for buffer in [buffer for buffer in self._slot_of if buffer.previous]:
            now, before = self._slot_of[Buffer(buffer.resource)], self._slot_of[buffer]
            self._memory[now], self._memory[before] = self._memory[before], self._memory[now]

    def forget(self, resources: Sequence[Resource]) -> None:
        """Have the frame that has begun know nothing of the past."""
        for resource in resources:
            for quantity in resource.quantities:
                if quantity.unknown is not None:
                    layout = self._layout.every(resource.spacing)
                    begin, size = (layout.nbytes(8 * n) for n in (resource.begin(quantity.name), quantity.nbytes))
                    value = quantity.format.encoded(quantity.unknown)
                    cl.enqueue_fill_buffer(self._queue, self[history_of(resource)], value, begin, size)

    def inherit(self, other: Buffers, resources: Sequence[Resource]) -> None:
        """Have the next frame find the past that it would find in `other`, which has these resources too."""
        for resource in resources:
            source, target = other[Buffer(resource)], self[Buffer(resource)]
            nbytes = self._layout.every(resource.spacing).nbytes(resource.planes.depth)
            cl.enqueue_copy(self._queue, target, source, byte_count=nbytes)

    def copy_aside(self, buffer: Buffer) -> None:
        """Have `read` find what a buffer holds now, though another takes its memory."""
        cl.enqueue_copy(self._queue, self._copies[buffer], self[buffer])

    def survives(self, buffer: Buffer) -> bool:
        """Whether `read` finds what was written to a buffer in this frame."""
        return buffer in self._copies or buffer in self._last_in_slot

    def read(self, buffer: Buffer) -> np.ndarray:
        """A copy of a whole buffer, flat float32."""
        source = self._copies.get(buffer, self[buffer])
        result = np.empty(source.size // 4, np.float32)
        cl.enqueue_copy(self._queue, result, source)
        return result

    def _zeros(self, nbytes: int, needed: int) -> cl.Buffer:
        buffer = allocate(self._queue, nbytes, needed)
        with lack_of_room(self._queue.device, nbytes, needed):  # some drivers look for the room only now
            cl.enqueue_fill_buffer(self._queue, buffer, np.float32(0), 0, nbytes)
        return buffer

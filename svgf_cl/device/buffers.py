"""`Buffers`: the device memory that a denoiser owns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyopencl as cl

from svgf_cl.device.memory import TURNS, Memory
from svgf_cl.device.opencl_errors import allocate, check_room, lack_of_room
from svgf_cl.filters.pipeline import Buffer, Resource


class Buffers:
    """The memory of a pipeline, one `pyopencl.Buffer` for each of its buffers; at first it is all zeros.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    memory : Memory
    copies : bool
        Whether to reserve memory for `copy_aside`.

    Attributes
    ----------
    turn : int
        The index into `Memory.turns` for this frame.

    Raises
    ------
    DeviceError
        If the device does not have enough memory.
    """

    def __init__(self, queue: cl.CommandQueue, memory: Memory, *, copies: bool = False) -> None:
        self._queue, self._planned = queue, memory
        self.turn = TURNS - 1  # the first frame has turn 0
        sizes, slot_of = memory.sizes, memory.slot_of
        kept = {buffer: sizes[slot] for buffer, slot in slot_of.items() if copies and not buffer.previous}
        needed = sum(sizes) + sum(kept.values())
        check_room(queue.device, needed)
        self._pieces = [self._zeros(size, needed) for size in sizes]
        self._copies = {buffer: allocate(queue, size, needed) for buffer, size in kept.items()}

    @property
    def nbytes(self) -> int:
        """Device memory in use, in bytes."""
        return sum(buffer.size for buffer in (*self._pieces, *self._copies.values()))

    def __getitem__(self, buffer: Buffer) -> cl.Buffer:
        return self._pieces[self._planned.turns[self.turn][self._planned.slot_of[buffer]]]

    def begin_frame(self) -> None:
        """Make the values written in the last frame this frame's history."""
        self.turn = (self.turn + 1) % TURNS

    def forget(self, resources: Sequence[Resource]) -> None:
        """Mark the history of these resources as unknown for the current frame."""
        for fill in self._planned.fills(resources):
            cl.enqueue_fill_buffer(self._queue, self[fill.buffer], fill.value, fill.offset, fill.nbytes)

    def inherit(self, other: Buffers, resources: Sequence[Resource]) -> None:
        """Copy the history of these resources from `other`, which has them too, for the next frame."""
        for resource in resources:
            source, target = other[Buffer(resource)], self[Buffer(resource)]
            cl.enqueue_copy(self._queue, target, source, byte_count=self._planned.nbytes(resource))

    def copy_aside(self, buffer: Buffer) -> None:
        """Copy a buffer as it is now, so that `read` can return it after another buffer takes its memory."""
        cl.enqueue_copy(self._queue, self._copies[buffer], self[buffer])

    def survives(self, buffer: Buffer) -> bool:
        """Whether `read` returns the values that this frame wrote to a buffer."""
        return buffer in self._copies or self._planned.survives(buffer)

    def read(self, buffer: Buffer) -> np.ndarray:
        """Return a copy of a whole buffer, flat float32."""
        source = self._copies.get(buffer, self[buffer])
        result = np.empty(source.size // 4, np.float32)
        cl.enqueue_copy(self._queue, result, source)
        return result

    def _zeros(self, nbytes: int, needed: int) -> cl.Buffer:
        buffer = allocate(self._queue, nbytes, needed)
        with lack_of_room(self._queue.device, nbytes, needed):  # some drivers allocate only now
            cl.enqueue_fill_buffer(self._queue, buffer, np.float32(0), 0, nbytes)
        return buffer

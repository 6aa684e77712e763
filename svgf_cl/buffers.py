"""Device memory of a denoiser: the planes that it owns."""

from __future__ import annotations

import numpy as np
import pyopencl as cl

from svgf_cl.errors import SvgfError
from svgf_cl.passes import Inputs, Pass, persistent_buffers, scratch_slots
from svgf_cl.planes import Layout

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


def allocate(queue: cl.CommandQueue, nbytes: int) -> cl.Buffer:
    """A buffer of uninitialised memory; `SvgfError` where the device has no room."""
    try:
        return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, nbytes)
    except (cl.MemoryError, cl.LogicError) as error:
        raise out_of_memory(queue, nbytes) from error


def out_of_memory(queue: cl.CommandQueue, nbytes: int) -> SvgfError:
    """The error that says what was asked of which device."""
    return SvgfError(f"the device {queue.device.name} has no room for a buffer of {nbytes / 2**20:.0f} MiB")

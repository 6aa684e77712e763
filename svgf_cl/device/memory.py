"""`Memory`: the bytes of a memory plan's slots, the buffers that have them in each frame, and the fills at a cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from svgf_cl.device.layout import Layout
from svgf_cl.device.memory_plan import Slot
from svgf_cl.filters.pipeline import Buffer, Resource, history_of

TURNS = 2  # after this many frames the halves of every pair are back in their place


@dataclass(frozen=True)
class Fill:
    """A part of a buffer to fill at a cut, which marks the history as unknown.

    Parameters
    ----------
    buffer : Buffer
    offset, nbytes : int, bytes
    value : () array
        The element to fill it with.
    """

    buffer: Buffer
    offset: int
    nbytes: int
    value: NDArray[np.generic]


@dataclass(frozen=True, eq=False)
class Memory:
    """The memory that a pipeline needs on any device; it is all zeros before the first frame.

    Parameters
    ----------
    layout : Layout
    slots : sequence of Slot
        The result of `svgf_cl.device.memory_plan.memory_slots`.
    """

    layout: Layout
    slots: Sequence[Slot]

    @cached_property
    def sizes(self) -> tuple[int, ...]:
        """Bytes of every piece of memory; there is one piece for each slot."""
        return tuple(self.layout.every(slot.spacing).nbytes(slot.planes.depth) for slot in self.slots)

    @cached_property
    def slot_of(self) -> dict[Buffer, int]:
        """The number of each buffer's slot."""
        return {buffer: number for number, slot in enumerate(self.slots) for buffer in slot.buffers}

    @cached_property
    def turns(self) -> tuple[tuple[int, ...], ...]:
        """The piece that each slot has, in frames 0, 2, 4... and in frames 1, 3, 5...

        The halves of a pair swap: the next frame reads what one frame writes.
        """
        odd = list(range(len(self.slots)))
        for buffer, before in self.slot_of.items():
            now = self.slot_of.get(Buffer(buffer.resource))
            if buffer.previous and now is not None:
                odd[now], odd[before] = odd[before], odd[now]
        return tuple(range(len(self.slots))), tuple(odd)

    def pieces(self, buffer: Buffer) -> tuple[int, ...]:
        """Return the number of the piece that a buffer has in each turn."""
        return tuple(turn[self.slot_of[buffer]] for turn in self.turns)

    def nbytes(self, resource: Resource) -> int:
        """Bytes of a resource; its slot may be larger."""
        return self.layout.every(resource.spacing).nbytes(resource.planes.depth)

    def survives(self, buffer: Buffer) -> bool:
        """Whether a buffer still has its memory at the end of the frame."""
        return self.slots[self.slot_of[buffer]].buffers[-1] == buffer

    def fills(self, resources: Sequence[Resource]) -> list[Fill]:
        """Return the fills that mark the history of these resources as unknown for the current frame."""
        return [
            Fill(
                history_of(resource),
                self.layout.every(resource.spacing).nbytes(8 * resource.begin(quantity.name)),
                self.layout.every(resource.spacing).nbytes(8 * quantity.nbytes),
                quantity.format.encoded(quantity.unknown),
            )
            for resource in resources
            for quantity in resource.quantities
            if quantity.unknown is not None
        ]

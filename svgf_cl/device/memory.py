"""`Memory`: how many bytes the slots of a memory plan take, who has which from frame to frame, and what marks a cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from svgf_cl.device.layout import Layout
from svgf_cl.device.memory_plan import Slot
from svgf_cl.filters.pipeline import Buffer, Resource, history_of

TURNS = 2  # after so many frames the halves of every pair are where they were


@dataclass(frozen=True)
class Fill:
    """A part of a buffer that says, at a cut, that nothing is known of the past.

    Parameters
    ----------
    buffer : Buffer
    offset, nbytes : int, bytes
    value : () array
        The element that it is filled with.
    """

    buffer: Buffer
    offset: int
    nbytes: int
    value: NDArray[np.generic]


@dataclass(frozen=True, eq=False)
class Memory:
    """The device memory of a pipeline, whatever the device; all of it holds zeros before the first frame.

    Parameters
    ----------
    layout : Layout
    slots : sequence of Slot
        As `svgf_cl.device.memory_plan.memory_slots` gives them.
    """

    layout: Layout
    slots: Sequence[Slot]

    @cached_property
    def sizes(self) -> tuple[int, ...]:
        """Bytes of every piece; there are as many as slots."""
        return tuple(self.layout.every(slot.spacing).nbytes(slot.planes.depth) for slot in self.slots)

    @cached_property
    def slot_of(self) -> dict[Buffer, int]:
        """Number of the slot of every buffer."""
        return {buffer: number for number, slot in enumerate(self.slots) for buffer in slot.buffers}

    @cached_property
    def turns(self) -> tuple[tuple[int, ...], ...]:
        """Which piece each slot has, in frames 0, 2, 4... and in frames 1, 3, 5...

        The halves of a pair change places: what one frame writes is what the next one finds.
        """
        odd = list(range(len(self.slots)))
        for buffer, before in self.slot_of.items():
            now = self.slot_of.get(Buffer(buffer.resource))
            if buffer.previous and now is not None:
                odd[now], odd[before] = odd[before], odd[now]
        return tuple(range(len(self.slots))), tuple(odd)

    def pieces(self, buffer: Buffer) -> tuple[int, ...]:
        """Number of the piece that a buffer has in each turn."""
        return tuple(turn[self.slot_of[buffer]] for turn in self.turns)

    def nbytes(self, resource: Resource) -> int:
        """Bytes of a resource, which may be fewer than those of its slot."""
        return self.layout.every(resource.spacing).nbytes(resource.planes.depth)

    def survives(self, buffer: Buffer) -> bool:
        """Whether a buffer still has its memory at the end of the frame."""
        return self.slots[self.slot_of[buffer]].buffers[-1] == buffer

    def fills(self, resources: Sequence[Resource]) -> list[Fill]:
        """What has a frame that has begun know nothing of the past of these resources."""
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

"""Which buffers share memory: one that is needed no more makes room for one that is yet to be written.

A plane's halo stays zero whoever has the memory, as every pass writes the same pixels: the image, rounded up to whole
vectors. That holds among planes of one width only, so a buffer in 32 bits and one in 16 never share.
"""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.filters.formats import Planes
from svgf_cl.filters.pipeline import Access, Buffer, Life, Pipeline


@dataclass
class Slot:
    """Memory for one buffer after another.

    Parameters
    ----------
    buffers : list of Buffer
        Which have it in the course of a frame.
    planes : Planes
        Room for the largest of them.
    last : int
        Number of the pass after which the last of them is needed no more.
    """

    buffers: list[Buffer]
    planes: Planes
    last: int

    @property
    def spacing(self) -> int:
        """Of its buffers' pixels, the same for all."""
        return self.buffers[0].resource.spacing

    def takes(self, buffer: Buffer, first: int) -> bool:
        """Whether a buffer that pass number `first` begins to write may come next."""
        if self.spacing != buffer.resource.spacing:
            return False
        in_place = self.last == first and self.buffers[-1].resource.name == buffer.resource.over
        return (self.last < first or in_place) and not self.planes.over(buffer.resource.planes).is_mixed

    def holds(self, buffer: Buffer) -> bool:
        """Whether there is room for a buffer already, at its pixels and its width."""
        return self.spacing == buffer.resource.spacing and self.planes.over(buffer.resource.planes) == self.planes

    def growth(self, planes: Planes) -> int:
        """Bits of a pixel that making room for these planes takes; a pair's other half grows as well."""
        more = self.planes.over(planes).depth - self.planes.depth
        return 2 * more if self.buffers[0].previous else more


def memory_slots(pipeline: Pipeline) -> list[Slot]:
    """The memory that a pipeline needs; the buffers of a slot have it one after another, in their order."""
    last_use = {
        each.of: number for number, entry in enumerate(pipeline.passes) for each in entry.accesses if is_own(each)
    }
    always = len(pipeline.passes)  # needed in the next frame
    lasting = [Buffer(resource) for resource in pipeline.lasting]
    pairs = [resource for resource in pipeline.lasting if resource.life is Life.PAIR]
    slots = [Slot([buffer], buffer.resource.planes, always) for buffer in lasting]
    before = [Buffer(resource, previous=True) for resource in pairs]
    # What tells where nothing is known tells it in the halo too, where others need zeros: it shares with none.
    slots += [
        Slot([buffer], buffer.resource.planes, always if buffer.resource.tells_unknown else last_use[buffer])
        for buffer in before
    ]
    under = {each.over: slot for each in pairs for slot in slots if slot.buffers == [Buffer(each)] and each.over}
    placed = {*lasting}
    for first, entry in enumerate(pipeline.passes):
        for each in entry.writes:
            if isinstance(each.of, Buffer) and each.of not in placed:
                slot = under.get(each.of.resource.name)
                if slot and slot.holds(each.of):  # it is of no use to the pair before
                    slot.buffers.insert(0, each.of)
                else:
                    place(each.of, first, last_use[each.of], slots)
                placed.add(each.of)
    of = {buffer: slot for slot in slots for buffer in slot.buffers}
    for resource in pairs:  # the halves change places every frame
        halves = of[Buffer(resource)], of[Buffer(resource, previous=True)]
        halves[0].planes = halves[1].planes = halves[0].planes.over(halves[1].planes)
    return slots


def is_own(access: Access) -> bool:
    """Whether it is to a buffer of the denoiser's, not to an array of the user's."""
    return isinstance(access.of, Buffer)


def place(buffer: Buffer, first: int, last: int, slots: list[Slot]) -> None:
    """Give a buffer the slot that grows least for it; of several the one used last, which a cache may still hold."""
    planes = buffer.resource.planes
    free = [slot for slot in slots if slot.takes(buffer, first)]
    best = min(free, key=lambda slot: (slot.growth(planes), -slot.last), default=None)
    if best is None or best.growth(planes) >= planes.depth:
        slots.append(Slot([buffer], planes, last))
        return
    best.buffers.append(buffer)
    best.planes, best.last = best.planes.over(planes), last

"""Decides which buffers share memory: a buffer that is no longer needed gives its memory to a later one.

A plane's halo stays zero when buffers share memory, because every pass writes the same pixels: the image, rounded up to
whole vectors. That is true only among planes of one width, so a 32-bit buffer and a 16-bit one never share.
"""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.filters.formats import Planes
from svgf_cl.filters.pipeline import Access, Buffer, Life, Pipeline


@dataclass
class Slot:
    """Memory that several buffers use, one after another.

    Parameters
    ----------
    buffers : list of Buffer
        The buffers that use it during a frame, in order.
    planes : Planes
        Room for the largest of them.
    last : int
        Number of the last pass that needs the last of them.
    """

    buffers: list[Buffer]
    planes: Planes
    last: int

    @property
    def spacing(self) -> int:
        """The spacing of the buffers' pixels, the same for all of them."""
        return self.buffers[0].resource.spacing

    def takes(self, buffer: Buffer, first: int) -> bool:
        """Whether a buffer that is first written by pass number `first` may use this memory next."""
        if self.spacing != buffer.resource.spacing:
            return False
        in_place = self.last == first and self.buffers[-1].resource.name == buffer.resource.over
        return (self.last < first or in_place) and not self.planes.over(buffer.resource.planes).is_mixed

    def holds(self, buffer: Buffer) -> bool:
        """Whether a buffer fits without growth: the same spacing, and planes of the same width."""
        return self.spacing == buffer.resource.spacing and self.planes.over(buffer.resource.planes) == self.planes

    def growth(self, planes: Planes) -> int:
        """Return by how many bits a pixel the slot must grow for these planes; a pair's other half grows as well."""
        more = self.planes.over(planes).depth - self.planes.depth
        return 2 * more if self.buffers[0].previous else more


def memory_slots(pipeline: Pipeline) -> list[Slot]:
    """Return the memory that a pipeline needs; the buffers of a slot use it one after another, in their order."""
    last_use = {
        each.of: number for number, entry in enumerate(pipeline.passes) for each in entry.accesses if is_own(each)
    }
    always = len(pipeline.passes)  # needed in the next frame
    lasting = [Buffer(resource) for resource in pipeline.lasting]
    pairs = [resource for resource in pipeline.lasting if resource.life is Life.PAIR]
    slots = [Slot([buffer], buffer.resource.planes, always) for buffer in lasting]
    before = [Buffer(resource, previous=True) for resource in pairs]
    # A buffer that marks unknown pixels marks the halo too, where other buffers need zeros: so it shares with none.
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
                if slot and slot.holds(each.of):  # the pair does not need this memory before that
                    slot.buffers.insert(0, each.of)
                else:
                    place(each.of, first, last_use[each.of], slots)
                placed.add(each.of)
    of = {buffer: slot for slot in slots for buffer in slot.buffers}
    for resource in pairs:  # the halves swap every frame
        halves = of[Buffer(resource)], of[Buffer(resource, previous=True)]
        halves[0].planes = halves[1].planes = halves[0].planes.over(halves[1].planes)
    return slots


def is_own(access: Access) -> bool:
    """Whether a pass accesses a buffer of the denoiser, not an array of the user."""
    return isinstance(access.of, Buffer)


def place(buffer: Buffer, first: int, last: int, slots: list[Slot]) -> None:
    """Give a buffer the slot that grows least; if several do, the one used last, which may still be in a cache."""
    planes = buffer.resource.planes
    free = [slot for slot in slots if slot.takes(buffer, first)]
    best = min(free, key=lambda slot: (slot.growth(planes), -slot.last), default=None)
    if best is None or best.growth(planes) >= planes.depth:
        slots.append(Slot([buffer], planes, last))
        return
    best.buffers.append(buffer)
    best.planes, best.last = best.planes.over(planes), last

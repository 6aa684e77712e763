"""Which buffers share memory: one that is needed no more makes room for one that is yet to be written.

A plane's halo stays zero whoever has the memory, as every pass writes the same pixels: the image, rounded up to whole
vectors. That holds among planes of one width only, so a buffer in 32 bits and one in 16 never share.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from svgf_cl.filters.formats import Planes
from svgf_cl.filters.pipeline import HISTORY, IN_PLACE, OUT, PREVIOUS, Pass, history_pairs


@dataclass
class Slot:
    """Memory for one buffer after another.

    Parameters
    ----------
    buffers : list of str
        Who has it in the course of a frame.
    planes : Planes
        Room for the largest of them.
    last : int
        Number of the pass after which the last of them is needed no more.
    """

    buffers: list[str]
    planes: Planes
    last: int

    @property
    def name(self) -> str:
        """The first buffer's."""
        return self.buffers[0]

    def takes(self, buffer: str, planes: Planes, first: int) -> bool:
        """Whether a buffer that pass number `first` begins to write may come next."""
        in_place = self.last == first and self.buffers[-1] == IN_PLACE.get(buffer)
        return (self.last < first or in_place) and not self.planes.over(planes).is_mixed

    def growth(self, planes: Planes) -> int:
        """Bits of a pixel that making room for these planes takes; a pair's other half grows as well."""
        more = self.planes.over(planes).depth - self.planes.depth
        return 2 * more if self.name.startswith(PREVIOUS) else more


def memory_slots(passes: tuple[Pass, ...], planes: Mapping[str, Planes]) -> list[Slot]:
    """The memory that a pass table needs.

    Parameters
    ----------
    passes : tuple of Pass
    planes : mapping of str to Planes
        Of every buffer that passes write.
    """
    last_use = {name: index for index, step in enumerate(passes) for name in (*step.reads, *step.writes)}
    pairs = history_pairs(passes)
    always = len(passes)  # needed in the next frame
    slots = [Slot([name], planes[name], always) for name in (*HISTORY, *pairs)]
    slots += [Slot([PREVIOUS + name], planes[name], last_use[PREVIOUS + name]) for name in pairs]
    placed = {OUT, *HISTORY, *pairs}
    for first, step in enumerate(passes):
        for name in step.writes:
            if name not in placed:
                place(name, planes[name], first, last_use[name], slots)
                placed.add(name)
    of = {slot.name: slot for slot in slots}
    for name in pairs:  # the halves change places every frame
        of[name].planes = of[PREVIOUS + name].planes
    return slots


def place(name: str, planes: Planes, first: int, last: int, slots: list[Slot]) -> None:
    """Give a buffer the slot that grows least for it; of several the one used last, which a cache may still hold."""
    free = [slot for slot in slots if slot.takes(name, planes, first)]
    best = min(free, key=lambda slot: (slot.growth(planes), -slot.last), default=None)
    if best is None or best.growth(planes) >= planes.depth:
        slots.append(Slot([name], planes, last))
        return
    best.buffers.append(name)
    best.planes, best.last = best.planes.over(planes), last

"""Computes how close a pass comes to the device's limits (Williams et al. 2009, *Roofline*)."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.cost import Cost

# The limits that can bound a pass.
BINDS = ("memory", "loads", "arithmetic")


@dataclass(frozen=True)
class Bound:
    """The least seconds a pass needs to move its bytes, to load its neighbours, and to compute."""

    memory: float
    loads: float
    arithmetic: float

    @classmethod
    def of(cls, cost: Cost, before: Cost, ceilings: Ceilings) -> Bound:
        """Return the bound of a pass that runs right after another and reads its output.

        The working set is what the device touches between writing a byte and reading it again: the rest of the previous
        pass and the beginning of this one, on average half of each. For a copy it is the whole working set.
        """
        working_set = 0.5 * (before.bytes + cost.bytes)
        return cls(
            memory=cost.bytes / ceilings.bandwidth_at(working_set),
            loads=cost.loads.aligned / ceilings.aligned_loads + cost.loads.offset / ceilings.offset_loads,
            arithmetic=cost.flops / ceilings.flops,
        )

    @property
    def seconds(self) -> float:
        """The bound: the longest of the three."""
        return max(self.memory, self.loads, self.arithmetic)

    @property
    def binds(self) -> str:
        """The limit that is the longest, one of `BINDS`."""
        return max(BINDS, key=lambda term: float(getattr(self, term)))

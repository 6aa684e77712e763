"""How near a pass comes to the device's limits (Williams et al. 2009, *Roofline*)."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.cost import Cost

# What can hold a pass up.
BINDS = ("memory", "loads", "arithmetic")


@dataclass(frozen=True)
class Bound:
    """The least seconds a pass could take: the longest of moving its bytes, loading its neighbours and computing."""

    memory: float
    loads: float
    arithmetic: float

    @classmethod
    def of(cls, cost: Cost, before: Cost, ceilings: Ceilings) -> Bound:
        """The bound of a pass that comes after another, and reads what that one wrote.

        Since then the device has touched, half of either on average, the rest of the pass before and the beginning of
        this one; a copy touches its whole working set between two looks at a byte.
        """
        working_set = 0.5 * (before.bytes + cost.bytes)
        return cls(
            memory=cost.bytes / ceilings.bandwidth_at(working_set),
            loads=cost.loads.aligned / ceilings.aligned_loads + cost.loads.offset / ceilings.offset_loads,
            arithmetic=cost.flops / ceilings.flops,
        )

    @property
    def seconds(self) -> float:
        """The longest of them."""
        return max(self.memory, self.loads, self.arithmetic)

    @property
    def binds(self) -> str:
        """Which of them it is, out of `BINDS`."""
        return max(BINDS, key=lambda term: float(getattr(self, term)))

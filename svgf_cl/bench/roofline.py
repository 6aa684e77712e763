"""How near a pass comes to the device's limits (Williams et al. 2009, *Roofline*)."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.cost import Cost

# What can hold a pass up.
BINDS = ("memory", "arithmetic")


@dataclass(frozen=True)
class Bound:
    """The least seconds a pass could take: the longer of moving its bytes and computing its operations."""

    memory: float
    arithmetic: float

    @classmethod
    def of(cls, cost: Cost, ceilings: Ceilings) -> Bound:
        """The bound of a pass whose working set is the bytes it moves, for it touches each once."""
        return cls(cost.bytes / ceilings.bandwidth_at(cost.bytes), cost.flops / ceilings.flops)

    @property
    def seconds(self) -> float:
        """The longer of both."""
        return max(self.memory, self.arithmetic)

    @property
    def binds(self) -> str:
        """Which of both it is, out of `BINDS`."""
        return BINDS[self.memory < self.arithmetic]

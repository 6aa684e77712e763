"""Float64 oracle of accumulation over time alone (`svgf_cl.filters.accumulation`), in NumPy."""

from __future__ import annotations

from collections.abc import Generator
from typing import ClassVar

from svgf_cl.filters.accumulation import Accumulation
from svgf_cl.oracle.temporal import Guides, Made, Stages, TemporalOracle


class Oracle(TemporalOracle[Accumulation]):
    """Accumulation over a sequence."""

    history: ClassVar[str] = "accumulated"

    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Yield nothing, because there is no spatial part."""
        yield from ()
        return "accumulated"

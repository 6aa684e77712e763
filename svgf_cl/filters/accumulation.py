"""Accumulation: a mean of light over time alone. Equations: docs/algorithm.md, section 2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from svgf_cl.filters.pipeline import Life, Pipeline, Resource
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.settings import documented


@documented
@dataclass(frozen=True, kw_only=True)
class Accumulation(TemporalFilter):
    """Parameters of temporal accumulation alone, without any filter over space. Equations: docs/algorithm.md.

    The other filters begin with this accumulation. In a comparison it shows what their spatial part adds.
    """

    name: ClassVar[str] = "accumulation"

    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame."""
        accumulated = Resource("accumulated", "illumination", (self.color(inputs, "accumulated"),), Life.PAIR)
        passes = (
            self.demodulate_pass(inputs),
            self.temporal_pass(inputs, accumulated, accumulated, alpha_moments=self.alpha_color),
            *self.last_passes(inputs, accumulated),
        )
        # no weights are used, but the shared headers need the macro
        return Pipeline(passes, inputs.defines | self.macros | {"FAST": 0})

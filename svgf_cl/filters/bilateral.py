"""What cross-bilateral filters share: one mean over a window. Equations: docs/algorithm.md, section 8."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.filters.pipeline import Life, Pass, Quantity, Resource
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.spatial import SpatialFilter


@dataclass(frozen=True, kw_only=True)
class BilateralFilter(SpatialFilter):
    """A filter of accumulated light by means over a window, whose noise is known from the moments of luminance."""

    def accumulated(self, inputs: Inputs) -> Resource:
        """Accumulated noisy light, which is the next frame's history too, and the variance of its luminance."""
        spread = Quantity("variance", 1, len(inputs.signals), self.variance_format, "variance")
        return Resource("accumulated", "illumination", (self.color(inputs, "accumulated"), spread), Life.PAIR)

    def filtered(self, inputs: Inputs) -> Resource:
        """Filtered light."""
        return Resource("filtered", "illumination", (self.color(inputs, "filtered"),))

    def first_passes(self, inputs: Inputs) -> tuple[Pass, ...]:
        """Demodulation, accumulation, and the variance."""
        accumulated = self.accumulated(inputs)
        return (
            self.demodulate_pass(inputs),
            self.temporal_pass(inputs, accumulated, accumulated, alpha_moments=self.alpha_color),
            self.variance_pass(inputs, accumulated),
        )

"""Passes and buffers that the bilateral filters SBF and LBF share. Equations: docs/algorithm.md, section 8."""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.filters.pipeline import Access, Life, Pass, Resource, access
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.spatial import SpatialFilter
from svgf_cl.filters.taps import Taps


@dataclass(frozen=True, kw_only=True)
class BilateralFilter(SpatialFilter):
    """A filter that averages accumulated light over a window; the moments of luminance say how noisy it is."""

    def accumulated(self, inputs: Inputs) -> Resource:
        """Accumulated noisy light, which is also the next frame's history, and the variance of its luminance."""
        return self.illumination(inputs, "accumulated", Life.PAIR, variance="variance")

    def filtered(self, inputs: Inputs) -> Resource:
        """Filtered light."""
        return Resource("filtered", "illumination", (self.color(inputs, "filtered"),))

    def surface(self, inputs: Inputs, taps: Taps) -> Access:
        """The planes of the guide that a kernel reads at these pixels to compare surfaces."""
        guide = self.guide(inputs)
        return access(guide, taps={name: taps for name in guide.names if name != "id"})

    def first_passes(self, inputs: Inputs) -> tuple[Pass, ...]:
        """The passes before the window: demodulation, accumulation, and the variance."""
        accumulated = self.accumulated(inputs)
        return (
            self.demodulate_pass(inputs),
            self.temporal_pass(inputs, accumulated, accumulated, alpha_moments=self.alpha_color),
            self.variance_pass(inputs, accumulated),
        )

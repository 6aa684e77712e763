"""Filters that average light over space: weights between surfaces, and the variance of light.

Equations: docs/algorithm.md, sections 3 and 4.
"""

from __future__ import annotations

from dataclasses import dataclass

from svgf_cl.filters.pipeline import Life, Number, Pass, Quantity, Resource, access
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import HERE, grid
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.settings import choice, number


@dataclass(frozen=True, kw_only=True)
class SpatialFilter(TemporalFilter):
    """A temporal filter that has a spatial part, with weights between pixels."""

    sigma_depth: float = number(
        1.0,
        (1e-3, 1e3),
        unit="slopes of the surface",
        reason="Tolerated depth difference, in units of the surface's own slope. 1 as in SVGF's paper (section 4.4).",
    )
    sigma_normal: float = number(
        128.0,
        (16, 1024),
        unit="1 / (1 - cosine)",
        reason="How strictly normals are compared: the weight falls to 1/e at a cosine of 1 - 1/sigma_normal. 128 (7 "
        "degrees): for such angles the same as SVGF's cosine to the power of 128.",
    )
    depth_slope_floor: float = number(
        1e-3,
        (1e-6, 1.0),
        unit="depth per depth and pixel",
        reason="Smallest slope that still counts as one surface. 1e-3 tolerates rounding and the slight relief of a "
        "wall that faces the camera, and is far below the step to anything behind it.",
    )
    precision: str = choice(
        "precise",
        "fast",
        reason="Exponentials of the weights between pixels: precise to 4e-6, or linear between the powers of two, "
        "which makes them up to 6 % larger. Fast takes a sixth less time and looks the same, to 0.07 dB, but "
        "single pixels differ from the exact filter by up to a tenth of the picture's mean. The default is "
        "precise, so that a picture is the same to 1e-6 on every device.",
    )

    @property
    def macros(self) -> dict[str, int]:
        """The macros that these settings set."""
        return super().macros | {"FAST": int(self.precision == "fast")}

    @property
    def surface_scalars(self) -> dict[str, Number]:
        """The settings by which surfaces are compared, as arguments of kernels."""
        names = ("sigma_depth", "sigma_normal", "albedo_threshold", "depth_slope_floor")
        return {name: getattr(self, name) for name in names}

    def illumination(
        self, inputs: Inputs, name: str, life: Life = Life.SCRATCH, *, variance: str = "", over: str = ""
    ) -> Resource:
        """Light and the variance of its luminance."""
        spread = Quantity("variance", 1, len(inputs.signals), self.variance_format, variance or f"{name}_variance")
        return Resource(name, "illumination", (self.color(inputs, name), spread), life, over)

    def variance_pass(self, inputs: Inputs, accumulated: Resource) -> Pass:
        """The variance from the moments or, where history is short, also from the neighbours (section 3)."""
        guide = self.guide(inputs)  # read only where history is short, which does not count in a steady state
        return Pass(
            "variance",
            "variance",
            scalars=self.surface_scalars,
            reads=(access(guide, taps={}), access(self.moments(inputs), taps={"length": HERE, "variance": HERE})),
            writes=(access(accumulated, "illumination", {"variance": HERE}),),
            rarely=(grid(3),),  # where history is short
            operations=2 + len(inputs.signals),  # choices by the length of the history, and by hit or miss
        )

"""EAW: edge-avoiding a-trous wavelets (Dammertz et al. 2010), over accumulated light. Equations: docs/algorithm.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from svgf_cl.filters.operations import EXP, LightOperations
from svgf_cl.filters.pipeline import Life, Pipeline, Resource
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.wavelet import WaveletFilter
from svgf_cl.settings import documented, number


@documented
@dataclass(frozen=True, kw_only=True)
class Eaw(WaveletFilter):
    """Parameters of edge-avoiding a-trous wavelets (Dammertz et al. 2010). Equations: docs/algorithm.md.

    The levels filter accumulated noisy light. They use one tolerance for edges in the light for the whole picture,
    while SVGF (`Settings`) estimates this tolerance for each pixel. EAW is for comparison, and for scenes with even
    light.
    """

    name: ClassVar[str] = "eaw"

    sigma_color: float = number(
        4.0,
        (1e-6, 1e6),
        unit="radiance",
        reason="Tolerated difference of light (divided by albedo) at the first level, the same for every pixel; each "
        "further level tolerates half as much. No value suits every scene: 0.5 is best in an evenly lit box "
        "(PSNR 30.6 dB), and 32 under caustics (30.6 dB). 4 is 1.1 and 3.3 dB worse there, and keeps the "
        "box's shadows about as sharp as SVGF; adapt it to the light of your scene. Figures: docs/results.md.",
    )

    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame; accumulated noisy light is the levels' input and the next frame's history."""
        accumulated = Resource("accumulated", "illumination", (self.color(inputs, "accumulated"),), Life.PAIR)
        names = [f"level_{level}" for level in range(1, self.iterations + 1)]
        steps = [accumulated, *(Resource(name, "illumination", (self.color(inputs, name),)) for name in names)]
        passes = (
            self.demodulate_pass(inputs),
            self.temporal_pass(inputs, accumulated, accumulated, alpha_moments=self.alpha_color),
            *self.levels(
                inputs,
                steps,
                {"sigma_color": self.sigma_color},
                LightOperations(
                    weight=3 + 4 + 5 + 2 + EXP[self.precision],  # differences; green; squares; the exponent; w_c
                    sums=2 * 3 + 1,  # w c; w
                    once=3 + 1 + 3,  # scale of w_c; the quotients
                ),
            ),
            *self.last_passes(inputs, steps[-1]),
        )
        return Pipeline(passes, inputs.defines | self.macros | {"GUIDED_BY_VARIANCE": 0, "GUIDED_BY_PAST": 0})

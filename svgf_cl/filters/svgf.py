"""SVGF: spatiotemporal variance-guided filtering (Schied et al. 2017). Equations: docs/algorithm.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from svgf_cl.filters.operations import DISTANCE, EXP, SMOOTH_VARIANCE, LightOperations
from svgf_cl.filters.pipeline import Life, Pipeline
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.wavelet import WaveletFilter
from svgf_cl.settings import documented, number


@documented
@dataclass(frozen=True, kw_only=True)
class Settings(WaveletFilter):
    """Parameters of SVGF (Schied et al. 2017). Equations: docs/algorithm.md."""

    name: ClassVar[str] = "svgf"

    sigma_luminance: float = number(
        4.0,
        (1e-3, 1e3),
        unit="standard deviations",
        reason="Tolerated luminance difference, in units of its estimated noise. 4 as in the paper (section 4.4).",
    )
    alpha_moments: float = number(
        0.2,
        (0.0, 1.0),
        unit="share of a frame",
        reason="Smallest share of the new frame in the moments of luminance. 0.2 as in the paper (section 4.1).",
    )

    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame (figure 1 of the paper); the first level's output is the next frame's history."""
        accumulated = self.illumination(inputs, "accumulated", variance="variance", over="demodulated")
        history = self.illumination(inputs, "level_1", Life.HISTORY)
        others = [self.illumination(inputs, f"level_{level}") for level in range(2, self.iterations + 1)]
        steps = [accumulated, history, *others]
        passes = (
            self.demodulate_pass(inputs),
            self.temporal_pass(inputs, history, accumulated, alpha_moments=self.alpha_moments),
            self.variance_pass(inputs, accumulated),
            *self.levels(
                inputs,
                steps,
                {"sigma_luminance": self.sigma_luminance},
                LightOperations(
                    weight=DISTANCE + 1 + EXP[self.precision],  # w_l; w
                    sums=2 * 3 + 1 + 2 + 1,  # w c; w^2 Var; w
                    once=SMOOTH_VARIANCE + 1 + 3 + 2,  # and the quotients
                ),
            ),
            *self.last_passes(inputs, steps[-1]),
        )
        return Pipeline(passes, inputs.defines | self.macros | {"GUIDED_BY_VARIANCE": 1, "GUIDED_BY_PAST": 0})

"""SBF: chooses the scale of a bilateral filter by Stein's unbiased risk estimate (Li et al. 2012).

It filters accumulated light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from svgf_cl.filters import operations
from svgf_cl.filters.bilateral import BilateralFilter
from svgf_cl.filters.operations import EXP
from svgf_cl.filters.pipeline import Pass, Pipeline, Quantity, Resource, access
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.taps import HERE, grid
from svgf_cl.settings import documented, number

SIGMAS = (1.0, 2.0, 4.0, 8.0)  # the standard deviations of the scales, in pixels
WINDOW = 16  # pixels to either side: two standard deviations of the largest scale
SMOOTHED = grid(3)  # the pixels over which the risk is smoothed


@documented
@dataclass(frozen=True, kw_only=True)
class Sbf(BilateralFilter):
    """Parameters of the SURE-based filter (Li et al. 2012). Equations: docs/algorithm.md, section 8.

    Light is filtered at four scales, and each pixel takes the scale with the least estimated error. SBF is for
    comparison: it takes six times as long as SVGF.
    """

    name: ClassVar[str] = "sbf"

    gamma_depth: float = number(
        4.0,
        (1e-2, 1e3),
        unit="deviations",
        reason="Tolerated difference of depth, in units of its standard deviation within a pixel.",
    )
    gamma_normal: float = number(
        2.0,
        (1e-2, 1e3),
        unit="deviations",
        reason="Tolerated difference of normals, in units of their standard deviation within a pixel.",
    )

    def pipeline(self, inputs: Inputs) -> Pipeline:
        """The passes of a frame: accumulation, then the window at all scales, then the choice of a scale."""
        candidates = tuple(self.candidate(inputs, scale) for scale in range(1, len(SIGMAS) + 1))
        passes = (
            *self.first_passes(inputs),
            self.bilateral_pass(inputs, candidates),
            self.select_pass(inputs, candidates),
            *self.last_passes(inputs, self.filtered(inputs)),
        )
        macros = {"LEARNED": 0, "WINDOW": WINDOW}
        return Pipeline(passes, inputs.defines | self.macros | macros)

    def candidate(self, inputs: Inputs, scale: int) -> Resource:
        """Light filtered at one scale, and the estimate of its error."""
        risk = Quantity("risk", 1, len(inputs.signals), stage=f"risk_{scale}")
        return Resource(f"candidate_{scale}", "candidate", (risk, self.color(inputs, f"scale_{scale}")))

    def bilateral_pass(self, inputs: Inputs, candidates: tuple[Resource, ...]) -> Pass:
        """The mean over the window at all scales."""
        names = ("gamma_depth", "gamma_normal", "albedo_threshold", "depth_slope_floor", "alpha_color")
        taps = grid(WINDOW)
        return Pass(
            "bilateral",
            "bilateral",
            scalars={name: getattr(self, name) for name in names},
            arrays={"gaussian": gaussian()},
            reads=(
                self.surface(inputs, taps),
                access(self.accumulated(inputs), "source", {"color": taps, "variance": HERE}),
                access(self.moments(inputs), taps={"length": HERE}),
            ),
            writes=tuple(map(access, candidates)),
            operations=operations.scales(
                inputs, [(2 * int(2 * sigma) + 1) ** 2 - 1 for sigma in SIGMAS], EXP[self.precision]
            ),
        )

    def select_pass(self, inputs: Inputs, candidates: tuple[Resource, ...]) -> Pass:
        """The choice of a scale."""
        return Pass(
            "select",
            "select_scale",
            scalars=self.surface_scalars,
            reads=(
                self.surface(inputs, SMOOTHED),
                *(access(each, taps={"risk": SMOOTHED, "color": HERE}) for each in candidates),
            ),
            writes=(access(self.filtered(inputs), "target"),),
            operations=operations.choice(inputs, len(SMOOTHED.offsets) - 1, len(candidates)),
        )


def gaussian() -> np.ndarray:
    """The spatial weights of each scale along an axis, from the middle to the window's edge, (scales, WINDOW + 1)."""
    away = np.arange(WINDOW + 1)
    weights: np.ndarray = np.exp(-0.5 * np.square(away / np.array(SIGMAS)[:, None])).astype(np.float32)
    return weights

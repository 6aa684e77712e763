"""Filters with a-trous levels (edge-avoiding wavelets).

Equations: docs/algorithm.md, section 4; Dammertz et al. 2010.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from svgf_cl.filters import operations
from svgf_cl.filters.operations import LightOperations
from svgf_cl.filters.pipeline import Number, Pass, Resource, access
from svgf_cl.filters.signals import Inputs
from svgf_cl.filters.spatial import SpatialFilter
from svgf_cl.filters.taps import grid
from svgf_cl.settings import choice, number


@dataclass(frozen=True, kw_only=True)
class WaveletFilter(SpatialFilter):
    """A filter whose spatial part is a sequence of a-trous levels; level i has taps 2^(i-1) pixels apart."""

    iterations: int = number(
        5,
        (1, 5),
        unit="levels",
        reason="Number of a-trous levels; each doubles the filter's reach. 5 as in the paper: taps up to 62 pixels "
        "away, enough for 1 spp.",
    )
    taps: str = choice(
        "3x3",
        "5x5",
        reason="Taps of an a-trous level: the linear spline, or the papers' cubic B-spline, which has three times as "
        "many neighbours. 3x3: over five levels it takes 0.6 of the time and blurs less. It is 0.8 to 1.3 dB "
        "better in an evenly lit box, and as good in Sponza, where it leaves 7 % more flicker (SVGF).",
    )

    @property
    def radius(self) -> int:
        """The number of taps of a level on either side of the centre."""
        return {"3x3": 1, "5x5": 2}[self.taps]

    @property
    def macros(self) -> dict[str, int]:
        """The macros that these settings set."""
        return super().macros | {"RADIUS": self.radius}

    def levels(
        self,
        inputs: Inputs,
        steps: Sequence[Resource],
        scalars: Mapping[str, Number],
        light: LightOperations,
        guidance: Sequence[Resource] = (),
    ) -> Iterator[Pass]:
        """The passes of the levels.

        `steps` are the input of the first level and the outputs of all levels. `scalars` are arguments in addition to
        those that all wavelet filters have. `guidance` are the buffers by which the levels compare light, in addition
        to the light itself: the first for level 1, the next one for level 2, and so on.
        """
        near = grid(1)
        guide = self.guide(inputs)
        for level, (source, target) in enumerate(pairwise(steps), start=1):
            step = 2 ** (level - 1)
            taps = grid(self.radius, step)
            # The variance is smoothed over the nearest neighbours, and the slope of depth is computed from them.
            read = {name: taps | near if name == "variance" else taps for name in target.names}
            surface = {name: taps | near if name == "depth" else taps for name in guide.names if name != "id"}
            yield Pass(
                "atrous",
                "atrous",
                scalars={"step": step, **self.surface_scalars, **scalars},
                reads=(
                    access(guide, taps=surface),
                    access(source, "source", read),
                    *(
                        access(each, "guidance", dict.fromkeys(each.names, taps))
                        for each in guidance[level - 1 : level]
                    ),
                ),
                writes=(access(target, "target"),),
                operations=operations.wavelet(inputs, (2 * self.radius + 1) ** 2 - 1, light),
                level=level,
                row_step=step,
            )

"""Ghosts: how much of what was seen before is left where something has come into view.

A pixel's surface is uncovered where nothing of the frame before shows it at the place that motion points to. What was
seen there, o, is a ghost if it shines through:

``ghost = sum((p - t)(o - t)) / sum((o - t)^2)``

p being the picture and t the truth, display-referred, over all pixels uncovered in one of the last `GHOST_FRAMES`
frames, this one included. 0: nothing is left; 1: the old picture is still there. Where the camera or the thing moves, o
moves along with the surface that was uncovered, as a filter's history does. Pixels beside an edge do not count: they
may be mixtures of what is on both sides. The truth's own noise is kept out by its halves, as in
`svgf_cl.compare.halves`: no two factors of a product are of one half.

Frames count in which o differs from t by `FAINT` or more, root mean square: below it a slope would be that of noise.

A blur across the edge of what has just moved on looks the same and counts. So does geometry thinner than a pixel, where
rays are jittered: read the figure beside that of the noisy frames, which have no past.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.kept import Plane
from svgf_cl.compare.reprojection import Reprojection
from svgf_cl.compare.share import Share
from svgf_cl.frame import Shape
from svgf_cl.io.display import Linear

GHOST_FRAMES = 4
FAINT = 0.1  # of what a screen shows


@dataclass(frozen=True, eq=False)
class Uncovered:
    """Which pixels of a frame were uncovered lately, and what was seen there before.

    Parameters
    ----------
    age : (H, W), frames
        Since they were; 0 if in this frame, inf if never.
    old : two of (H, W, 3)
        Halves of the truth before, display-referred.
    """

    age: Plane
    old: Pair

    @classmethod
    def none(cls, shape: Shape) -> Uncovered:
        """Of a first frame."""
        black = np.zeros((*shape, 3))
        return cls(np.full(shape, np.inf), (black, black))

    def followed(self, past: Reprojection, before: Pair) -> Uncovered:
        """The same of the next frame; `before` are the halves of this one."""
        new, there = past.uncovered, past.nearest
        age = np.where(new, 0.0, np.where(past.seen.any(axis=0), self.age[there] + 1, np.inf))
        first, second = (
            np.where(new[..., None], half[there], old[there]) for half, old in zip(before, self.old, strict=True)
        )
        return Uncovered(age, (first, second))

    @property
    def lately(self) -> Mask:
        """Where a ghost may be, (H, W)."""
        mask: Mask = self.age < GHOST_FRAMES
        return mask

    def left(self, shown: Linear, halves: Pair, inside: Mask) -> Share:
        """How much of it is left in a display-referred picture, (H, W, 3), where it is `inside` of surfaces, (H, W).

        Nothing of nothing where what was seen before hardly differs from the truth.
        """
        where = self.lately & inside
        share, values = Share(), 2 * 3 * np.count_nonzero(where)
        for one, other in ((0, 1), (1, 0)):
            difference = (self.old[other] - halves[other])[where]
            part = (shown - halves[one])[where] * difference
            whole = (self.old[one] - halves[one])[where] * difference
            share += Share(float(part.sum()), float(whole.sum()))
        return share if share.whole > FAINT**2 * values else Share()

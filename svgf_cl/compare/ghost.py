"""Ghosts: how much of the old picture remains where a surface has come into view.

A surface that a pixel shows is uncovered if the previous frame does not show it at the place that motion points to. The
old picture there, o, is a ghost if it still shows:

``ghost = sum((p - t)(o - t)) / sum((o - t)^2)``

Here p is the picture and t the truth, both display-referred. The sums are over all pixels that were uncovered in one of
the last `GHOST_FRAMES` frames, including this one. 0 means that nothing remains, 1 that the old picture is still there.
If the camera or the object moves, o moves along with the uncovered surface, as a filter's history does. Pixels next to
an edge do not count, because they may mix both sides of it. The truth's own noise does not count, because the two
factors of each product come from different halves of the truth (`svgf_cl.compare.halves`).

A frame counts only if o differs from t by `FAINT` or more, root mean square; below that, noise would decide the slope.

Blur across the edge of an object that has just moved looks the same, and counts. So does geometry thinner than a pixel,
if rays are jittered. So compare the value with that of the noisy frames, which have no history.
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
FAINT = 0.1  # display-referred, of 0..1


@dataclass(frozen=True, eq=False)
class Uncovered:
    """Which pixels of a frame were uncovered recently, and the old picture there.

    Parameters
    ----------
    age : (H, W), frames
        Frames since the pixel was uncovered; 0 if in this frame, inf if never.
    old : two of (H, W, 3)
        Halves of the truth of the old picture, display-referred.
    """

    age: Plane
    old: Pair

    @classmethod
    def none(cls, shape: Shape) -> Uncovered:
        """Return the state of a first frame: no pixel was uncovered."""
        black = np.zeros((*shape, 3))
        return cls(np.full(shape, np.inf), (black, black))

    def followed(self, past: Reprojection, before: Pair) -> Uncovered:
        """Return the state of the next frame; `before` are the halves of this frame's truth."""
        new, there = past.uncovered, past.nearest
        age = np.where(new, 0.0, np.where(past.seen.any(axis=0), self.age[there] + 1, np.inf))
        first, second = (
            np.where(new[..., None], half[there], old[there]) for half, old in zip(before, self.old, strict=True)
        )
        return Uncovered(age, (first, second))

    @property
    def lately(self) -> Mask:
        """The pixels that may have a ghost, (H, W)."""
        mask: Mask = self.age < GHOST_FRAMES
        return mask

    def left(self, shown: Linear, halves: Pair, inside: Mask) -> Share:
        """Return how much of the old picture remains in a display-referred picture, (H, W, 3).

        Only pixels `inside` surfaces, (H, W), count. The share is empty if the old picture hardly differs from the
        truth.
        """
        where = self.lately & inside
        share, values = Share(), 2 * 3 * np.count_nonzero(where)
        for one, other in ((0, 1), (1, 0)):
            difference = (self.old[other] - halves[other])[where]
            part = (shown - halves[one])[where] * difference
            whole = (self.old[one] - halves[one])[where] * difference
            share += Share(float(part.sum()), float(whole.sum()))
        return share if share.whole > FAINT**2 * values else Share()

"""Lag: how many frames a picture takes to follow a change of light.

Between frame n-1 and n, a lamp is switched: the truth goes from b to a. How far a picture p of a later frame has
followed is the slope of ``p - b`` on ``a - b``:

``response = sum(w (p - b)(a - b)) / sum(w (a - b)^2)``, ``w = 1 / (a + b + mean(a + b))^2``

The weight lets bright pixels count little more than others; the mean in it keeps the darkest from counting for all.

0: nothing is followed yet; 1: all. The truth's own noise is kept out by its halves, as in `svgf_cl.compare.halves`: no
two factors of a product are of one half. `lag` is the number of frames from n on until the response is `FOLLOWED`;
0 where frame n itself has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.share import Share
from svgf_cl.io.display import Linear

FOLLOWED = 0.9
STEP = 1.5  # factor by which a picture becomes lighter or darker at once, if a lamp was switched


def steps(levels: Sequence[float]) -> list[int]:
    """Where a lamp was switched: indices of `levels`, mean light of each frame, that differ by `STEP` from before."""
    pairs = enumerate(pairwise(levels), 1)
    return [number for number, (before, after) in pairs if max(before, after) > STEP * min(before, after)]


def response(picture: Linear, before: Pair, after: Pair, where: Mask) -> Share:
    """How far a linear picture (H, W, 3) has gone from `before` to `after`, halves of the truth, as above."""
    if not where.any():
        return Share()
    part = whole = 0.0
    light = (before[0] + before[1] + after[0] + after[1])[where] / 2
    weight = 1 / (light + light.mean()) ** 2
    for one, other in ((0, 1), (1, 0)):
        change, start = (after[one] - before[one])[where], before[other][where]
        part += float((weight * (picture[where] - start) * change).sum())
        whole += float((weight * (after[other][where] - start) * change).sum())
    return Share(part, whole)


def lag(responses: Sequence[float]) -> int | None:
    """Frames until a response, one for each frame from the change on, is `FOLLOWED`; None where it never is."""
    return next((frames for frames, reached in enumerate(responses) if reached >= FOLLOWED), None)

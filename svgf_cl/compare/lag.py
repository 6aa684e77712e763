"""Lag: how many frames a picture takes to follow a change of light.

A lamp is switched between frames n-1 and n: the truth goes from b to a. The response says how far a picture p of a
later frame has followed. It is the slope of ``p - b`` on ``a - b``:

``response = sum(w (p - b)(a - b)) / sum(w (a - b)^2)``, ``w = 1 / (a + b + mean(a + b))^2``

Because of the weight, bright pixels count little more than others; because of the mean in it, the darkest pixels do not
dominate.

0 means that the picture has not followed at all, 1 that it has followed completely. The truth's own noise does not
count, because the two factors of each product come from different halves of the truth (`svgf_cl.compare.halves`). `lag`
is the number of frames from n on until the response is `FOLLOWED`; 0 if frame n itself reaches it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.share import Share
from svgf_cl.io.display import Linear

FOLLOWED = 0.9
STEP = 1.5  # a lamp was switched if a picture becomes lighter or darker by this factor in one frame


def steps(levels: Sequence[float]) -> list[int]:
    """Return where a lamp was switched: indices of `levels`, the mean light of each frame, after a `STEP`."""
    pairs = enumerate(pairwise(levels), 1)
    return [number for number, (before, after) in pairs if max(before, after) > STEP * min(before, after)]


def response(picture: Linear, before: Pair, after: Pair, where: Mask) -> Share:
    """Return how far a linear picture (H, W, 3) has gone from `before` to `after`, which are halves of the truth."""
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
    """Return the number of frames until the response is `FOLLOWED`; None if it never is.

    `responses` has one for each frame from the change on.
    """
    return next((frames for frames, reached in enumerate(responses) if reached >= FOLLOWED), None)

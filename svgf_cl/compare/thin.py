"""Thin geometry: bars, leaves and gaps of a few pixels, which a picture shows late, in part, or not at all.

A pixel is thin where, along its row or its column, within `REACH` pixels on both sides there is another id, or on both
sides something farther, or on both sides something nearer (`svgf_cl.compare.edges`). So things, and gaps
between them, are thin up to a width of 2 pixels, and the middle of 3. A slope is not, being farther on one side alone.

``unsettled`` is the share of thin pixels, over all frames, whose display-referred luminance differs from the truth's by
more than `SETTLED`: 0..1, best 0. Each pixel of each frame counts once, so that the camera may move. The truth is the
mean of both halves, and its noise counts: it matters where its standard deviation comes near `SETTLED`.
"""

from __future__ import annotations

import numpy as np

from svgf_cl.compare.edges import other
from svgf_cl.compare.halves import Mask
from svgf_cl.compare.share import Share
from svgf_cl.frame import Frame
from svgf_cl.io.display import Linear
from svgf_cl.oracle.taps import Offset, luminance

REACH = 2  # pixels
SETTLED = 0.1


def unsettled(shown: Linear, truth: Linear, where: Mask) -> Share:
    """How many of the pixels `where` (H, W) are wrong in a display-referred picture; both (H, W, 3)."""
    settled = np.abs(luminance(np.asarray(shown - truth, np.float64))) <= SETTLED  # not where it is NaN
    return Share(float(np.sum(where & ~settled)), float(np.sum(where)))


def thin(frame: Frame) -> Mask:
    """Where geometry is thin, (H, W)."""
    across, along = ((beside(frame, (-dx, -dy)) & beside(frame, (dx, dy))).any(axis=0) for dx, dy in ((1, 0), (0, 1)))
    mask: Mask = np.logical_or(across, along)
    return mask


def beside(frame: Frame, side: Offset) -> Mask:
    """Whether there is another id, something farther, something nearer within `REACH` on this side, (3, H, W)."""
    steps = [other(frame, (reach * side[0], reach * side[1])) for reach in range(1, REACH + 1)]
    mask: Mask = np.any(steps, axis=0)
    return mask

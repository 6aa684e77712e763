"""Thin geometry: bars, leaves and gaps of a few pixels, which a picture may show late, in part, or not at all.

A pixel is thin if within `REACH` pixels on both sides, along its row or its column, there is another id, or on both
sides a farther surface, or on both sides a nearer one (`svgf_cl.compare.edges`). So objects, and gaps between them, are
thin up to a width of 2 pixels; of a width of 3, only the middle is thin. A slope is not thin, as it is farther on one
side only.

``unsettled`` is the share of thin pixels, over all frames, whose display-referred luminance differs from the truth's by
more than `SETTLED`: 0..1, best 0. Each pixel of each frame counts once, so the camera may move. The truth is the mean
of both halves. Its noise counts, and matters if its standard deviation comes near `SETTLED`.
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
    """Return how many of the pixels `where` (H, W) are wrong; picture and truth are display-referred, (H, W, 3)."""
    settled = np.abs(luminance(np.asarray(shown - truth, np.float64))) <= SETTLED  # False for NaN
    return Share(float(np.sum(where & ~settled)), float(np.sum(where)))


def thin(frame: Frame) -> Mask:
    """Return where geometry is thin, (H, W)."""
    across, along = ((beside(frame, (-dx, -dy)) & beside(frame, (dx, dy))).any(axis=0) for dx, dy in ((1, 0), (0, 1)))
    mask: Mask = np.logical_or(across, along)
    return mask


def beside(frame: Frame, side: Offset) -> Mask:
    """Return whether another id, a farther, or a nearer surface is within `REACH` pixels on a side, (3, H, W)."""
    steps = [other(frame, (reach * side[0], reach * side[1])) for reach in range(1, REACH + 1)]
    mask: Mask = np.any(steps, axis=0)
    return mask

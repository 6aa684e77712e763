"""Edges of geometry: where the id changes between pixels, or the depth by more than `EDGE` of itself."""

from __future__ import annotations

import numpy as np

from svgf_cl.compare.halves import Mask
from svgf_cl.frame import Frame
from svgf_cl.oracle.taps import Offset, shifted, square

EDGE = 0.1


def interior(frame: Frame) -> Mask:
    """Where no edge is between a pixel and any of the eight around it, (H, W)."""
    mask: Mask = ~np.any([other(frame, offset) for offset in square(1)], axis=(0, 1))
    return mask


def other(frame: Frame, offset: Offset) -> Mask:
    """Whether a pixel so far away has another id, is farther, is nearer, (3, H, W); all false beyond the border."""
    y, x, inside = shifted(offset, frame.shape)
    near = np.divide(1, frame.depth, out=np.zeros(frame.shape), where=frame.depth > 0)  # 0 in the sky
    another = np.zeros(frame.shape, np.bool_) if frame.id is None else frame.id[y, x] != frame.id
    mask: Mask = inside & np.stack((another, near[y, x] < (1 - EDGE) * near, near < (1 - EDGE) * near[y, x]))
    return mask

"""Finds edges of geometry: where the id changes between pixels, or the depth changes by more than a share `EDGE`."""

from __future__ import annotations

import numpy as np

from svgf_cl.compare.halves import Mask
from svgf_cl.frame import Frame
from svgf_cl.oracle.taps import Offset, shifted, square

EDGE = 0.1


def interior(frame: Frame) -> Mask:
    """Return where there is no edge between a pixel and any of its eight neighbours, (H, W)."""
    mask: Mask = ~np.any([other(frame, offset) for offset in square(1)], axis=(0, 1))
    return mask


def other(frame: Frame, offset: Offset) -> Mask:
    """Return whether the pixel at an offset has another id, is farther, is nearer, (3, H, W).

    All three are false beyond the border.
    """
    y, x, inside = shifted(offset, frame.shape)
    near = np.divide(1, frame.depth, out=np.zeros(frame.shape), where=frame.depth > 0)  # 0 in the sky
    another = np.zeros(frame.shape, np.bool_) if frame.id is None else frame.id[y, x] != frame.id
    mask: Mask = inside & np.stack((another, near[y, x] < (1 - EDGE) * near, near < (1 - EDGE) * near[y, x]))
    return mask

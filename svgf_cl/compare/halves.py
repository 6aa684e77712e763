"""Errors without the truth's own noise, computed from two independent halves of the truth.

A path-traced truth is noisy itself. With 256 samples per pixel it often has only 40 dB against the picture that it
converges to, so it cannot judge a picture that is just as good. Two halves h1 and h2 of it, with independent samples,
can: their errors are independent and 0 on average, so the mean of ``(a - h1)(a - h2)`` over many pixels tends to that
of ``(a - t)**2``, where t is the picture to which the halves converge. A perfect picture may have slightly less than 0.

==============  ================  ====================================================================================
measure         computed on       definition
==============  ================  ====================================================================================
squared error   display-referred  ``mean((a - h1)(a - h2))``; 0..1, best 0; its `metrics.decibels` are the PSNR
squared change  display-referred  ``mean((d - d1)(d - d2))``, where d, d1 and d2 are the differences of two consecutive
                                  frames: how much the error changes, squared; its root is the temporal error, 0..1
brightness      linear HDR        ``sum(a) / sum((h1 + h2) / 2)``, a `Share`: best 1; the bias is this value less 1
==============  ================  ====================================================================================

The display curve is not linear. So for display-referred measures, t is the mean of displayed halves, which differs from
the displayed truth by half the curve's second derivative times the half's variance. This is not noise, and small if a
half has a hundred samples per pixel. The product of independent estimates is a well-known unbiased estimate of a
square; the "dual-buffer" estimates of Rousselle et al., Robust Denoising using Feature and Color Information, 2013,
use it for variance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.compare.share import Share
from svgf_cl.io.display import Linear

Mask = NDArray[np.bool_]
Pair = tuple[Linear, Linear]


def squared_error(picture: Linear, halves: Pair, where: Mask | None = None) -> Share:
    """Return the squared error of a picture: its sum over pixels and channels, and their number.

    Parameters
    ----------
    picture : (H, W, 3)
    halves : two of (H, W, 3)
        Independent estimates of the right picture.
    where : (H, W) bool, optional
        The pixels that count, all by default.
    """
    first, second = (picture - half for half in halves)
    product = first * second if where is None else (first * second)[where]
    return Share(float(np.sum(product, dtype=np.float64)), product.size)


def squared_change(
    earlier: Linear, later: Linear, earlier_halves: Pair, later_halves: Pair, where: Mask | None = None
) -> Share:
    """Return the squared change of the error from one frame to the next; see `squared_error` for the rest."""
    first, second = (after - before for before, after in zip(earlier_halves, later_halves, strict=True))
    return squared_error(later - earlier, (first, second), where)


def brightness(picture: Linear, halves: Pair, where: Mask) -> Share:
    """Return the light of a linear picture as a share of the truth's, over the pixels `where`.

    The shares of several frames can be added; noise falls with the number of pixels. Leave lamps out: they are much
    brighter than the light that is filtered.
    """
    truth = 0.5 * (halves[0] + halves[1])
    return Share(float(np.sum(picture[where], dtype=np.float64)), float(np.sum(truth[where], dtype=np.float64)))

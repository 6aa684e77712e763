"""Errors without the truth's own noise, which is known from two independent halves of the truth.

A path-traced truth is noisy itself: of 256 samples per pixel it is often no closer than 40 dB to what it converges to,
so a picture that is as good cannot be judged by it. Two halves h1 and h2 of it, of independent samples, can: their
errors are independent and 0 on average, so that the mean of ``(a - h1)(a - h2)`` over many pixels tends to that of
``(a - t)**2``, t being what the halves converge to. It may come out a little below 0 where a picture is perfect.

==============  ================  ====================================================================================
measure         computed on       definition
==============  ================  ====================================================================================
squared error   display-referred  ``mean((a - h1)(a - h2))``; 0..1, 0 where right; its `metrics.decibels` are the PSNR
squared change  display-referred  ``mean((d - d1)(d - d2))``, d, d1 and d2 being the differences of two consecutive
                                  frames: how much the error changes, squared; its root is the temporal error, 0..1
brightness      linear HDR        ``sum(a) / sum((h1 + h2) / 2)``, a `Share`: 1 is right; less 1 it is the bias
==============  ================  ====================================================================================

The curve of what is shown bends, so there t is the mean of what is shown of a half, which is off by half the curve's
second derivative times the half's variance: not noise, and small where a half has a hundred samples per pixel. The
product of independent estimates is an old way to an unbiased square: "dual-buffer" estimates as in Rousselle et al.,
Robust Denoising using Feature and Color Information, 2013, use it for variance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.compare.share import Share
from svgf_cl.io.display import Linear

Mask = NDArray[np.bool_]
Pair = tuple[Linear, Linear]


def squared_error(picture: Linear, halves: Pair, where: Mask | None = None) -> Share:
    """Squared error of a picture, summed over pixels and channels, of their number: its value is the mean.

    Parameters
    ----------
    picture : (H, W, 3)
    halves : two of (H, W, 3)
        Independent estimates of what it should be.
    where : (H, W) bool, optional
        The pixels that count, all by default.
    """
    first, second = (picture - half for half in halves)
    product = first * second if where is None else (first * second)[where]
    return Share(float(np.sum(product, dtype=np.float64)), product.size)


def squared_change(
    earlier: Linear, later: Linear, earlier_halves: Pair, later_halves: Pair, where: Mask | None = None
) -> Share:
    """Squared change of the error from a frame to the next; parameters and result as of `squared_error`."""
    first, second = (after - before for before, after in zip(earlier_halves, later_halves, strict=True))
    return squared_error(later - earlier, (first, second), where)


def brightness(picture: Linear, halves: Pair, where: Mask) -> Share:
    """How much light of the truth a linear picture has, over the pixels `where`.

    The sum is over pixels and, added up, over frames: noise falls with their number. Lamps, which outshine all that is
    filtered, are best left out.
    """
    truth = 0.5 * (halves[0] + halves[1])
    return Share(float(np.sum(picture[where], dtype=np.float64)), float(np.sum(truth[where], dtype=np.float64)))

"""Measures how much of the truth's contrast a picture keeps, where the truth has contrast.

All measures are shares: 1 if all contrast is kept, 0 if the picture is flat, more than 1 if contrast is exaggerated.

=========  =====================  =====================================================================================
measure    computed on            definition
=========  =====================  =====================================================================================
sharpness  display-referred       ``sum(g . g1) / sum(g2 . g1)``, where g, g1 and g2 are Sobel's gradients of the
                                  luminance of picture and halves: how sharp edges are
contrast   luminance of light     ``sum(cov(a / m, h1 / m1)) / sum(cov(h2 / m2, h1 / m1))`` over windows of 5x5 pixels,
           without albedo,        where m, m1 and m2 are the means in the window: lit minus shadow, relative to the
           linear                 light there, divided by the same of the truth, where light varies over a surface
detail     display-referred       ``sum(l l1) / sum(l2 l1)``, where l, l1 and l2 are Laplacians of the luminance of
                                  picture and halves: how much of the finest contrast is left
=========  =====================  =====================================================================================

Sums are over the `SHARE` of the pixels or windows with the most contrast in h1; for detail, over all given pixels. The
halves h1 and h2 of the truth are independent, as in `svgf_cl.compare.halves`. h1 selects the pixels. Its noise is the
same in both sums, and not correlated with the noise of h2 and of the picture. So the noise of truth and picture does
not count as contrast: statistics calls h1 an instrumental variable. Then the halves are swapped, and both results are
added.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.share import Share
from svgf_cl.frame import LUMINANCE
from svgf_cl.io.display import Linear

SHARE = 0.05
RADIUS = 2  # pixels, of a window
FAINT = 0.1  # standard deviation of light in a window over its mean

Plane = NDArray[np.float64]
Product = Callable[[NDArray[np.floating], NDArray[np.floating]], Plane]


def sharpness(shown: Linear, halves: Pair, where: Mask) -> Share:
    """Return how sharp the strongest edges among the pixels `where` (H, W) are, in display-referred pictures."""
    return slope(gradients_along, shown, halves, where)


def contrast(light: Plane, halves: tuple[Plane, Plane], where: Mask) -> Share:
    """Return how much contrast light (H, W) keeps in the windows around the pixels `where` (H, W).

    Each of these windows must show one surface, so that only the light has edges in it. The share is empty if the
    truth's contrast is not above `FAINT`, where noise would decide the slope.
    """
    return slope(relative_covariance, light, halves, where, FAINT**2)


def detail(shown: Linear, halves: Pair, where: Mask) -> Share:
    """Return how much of the finest contrast display-referred pictures (H, W, 3) keep, in the pixels `where` (H, W)."""
    return sum((ratio(laplacians, shown, pair, where) for pair in (halves, halves[::-1])), Share())


def slope(product: Product, picture: Linear, halves: Pair, where: Mask, least: float = 0.0) -> Share:
    """Return the slope of picture on truth, by a `product` (H, W) of two images.

    It is computed where the product of the truth with itself is largest. The share is empty if the truth's product
    there is not above `least` on average.
    """
    total = Share()
    for chooser, other in (halves, halves[::-1]):
        strongest = largest(product(chooser, chooser), where)
        found = ratio(product, picture, (chooser, other), strongest)
        if found.whole > least * np.count_nonzero(strongest):
            total += found
    return total


def ratio(product: Product, picture: Linear, halves: Pair, where: Mask) -> Share:
    """Return the product of picture and first half, and the product of both halves, summed over the pixels `where`."""
    chooser, other = halves
    part, whole = (float(product(image, chooser)[where].sum()) for image in (picture, other))
    return Share(part, whole)


def largest(strength: Plane, where: Mask) -> Mask:
    """Return the `SHARE` of the pixels `where` that has the largest strength, and only those above 0."""
    if not where.any():
        return where
    chosen: Mask = where & (strength > 0) & (strength >= np.quantile(strength[where], 1 - SHARE))
    return chosen


def gradients_along(shown: Linear, chooser: Linear) -> Plane:
    """Return the inner product of two pictures' gradients, (H, W)."""
    product: Plane = (gradient(shown) * gradient(chooser)).sum(axis=-1)
    return product


def gradient(shown: Linear) -> NDArray[np.float64]:
    """Return Sobel's gradient of luminance, (H, W, 2); 0 at the picture's border."""
    luminance = np.asarray(shown, np.float64) @ np.array(LUMINANCE)
    smooth_down = luminance[:-2] + 2 * luminance[1:-1] + luminance[2:]
    smooth_along = luminance[:, :-2] + 2 * luminance[:, 1:-1] + luminance[:, 2:]
    along, down = smooth_down[:, 2:] - smooth_down[:, :-2], smooth_along[2:] - smooth_along[:-2]
    return np.pad(np.stack((along, down), axis=-1) / 8, ((1, 1), (1, 1), (0, 0)))


def laplacians(shown: Linear, chooser: Linear) -> Plane:
    """Return the product of two pictures' Laplacians, (H, W)."""
    return laplacian(shown) * laplacian(chooser)


def laplacian(shown: Linear) -> Plane:
    """Return the four neighbours' luminance less four times the pixel's own, (H, W); 0 at the picture's border."""
    luminance = np.asarray(shown, np.float64) @ np.array(LUMINANCE)
    along = luminance[1:-1, :-2] + luminance[1:-1, 2:]
    down = luminance[:-2, 1:-1] + luminance[2:, 1:-1]
    return np.pad(along + down - 4 * luminance[1:-1, 1:-1], 1)


def relative_covariance(light: NDArray[np.floating], other: NDArray[np.floating]) -> Plane:
    """Return the covariance of two planes in each window, relative to both means there, (H, W); 0 if a mean is 0."""
    means = window_mean(light) * window_mean(other)
    with np.errstate(invalid="ignore"):  # a picture may have infinite pixels, which give NaN
        return np.divide(window_mean(light * other) - means, means, out=np.zeros_like(means), where=means > 0)


def window_mean(plane: NDArray[np.floating]) -> Plane:
    """Return the mean over the window around each pixel, (H, W); 0 where the window reaches beyond the picture."""
    mean = np.zeros(plane.shape)
    if min(plane.shape) > 2 * RADIUS:
        ones = np.ones(2 * RADIUS + 1)
        down = sliding_window_view(np.asarray(plane, np.float64), ones.size, axis=0) @ ones
        inner = slice(RADIUS, -RADIUS)
        mean[inner, inner] = sliding_window_view(down, ones.size, axis=1) @ ones / ones.size**2
    return mean

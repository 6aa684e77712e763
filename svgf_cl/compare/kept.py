"""How much of the truth's contrast a picture keeps: the slope of the one on the other, where the truth has contrast.

All measures are shares: 1 where all is kept, 0 where the picture is flat; more than 1 where contrast is exaggerated.

=========  =====================  =====================================================================================
measure    computed on            definition
=========  =====================  =====================================================================================
sharpness  display-referred       ``sum(g . g1) / sum(g2 . g1)``, g, g1 and g2 being Sobel's gradients of the luminance
                                  of picture and halves: how sharp edges are
contrast   luminance of light     ``sum(cov(a / m, h1 / m1)) / sum(cov(h2 / m2, h1 / m1))`` over windows of 5x5 pixels,
           without albedo,        m, m1 and m2 being each one's mean in the window: lit minus shadow, relative to the
           linear                 light there, over that of the truth; wherever light varies over a surface
detail     display-referred       ``sum(l l1) / sum(l2 l1)``, l, l1 and l2 being Laplacians of the luminance of
                                  picture and halves: how much of the finest contrast is left
=========  =====================  =====================================================================================

Sums are over the `SHARE` of the pixels or windows where h1 has most; those of detail over all that are asked for. The
halves h1 and h2 of the truth are independent, as in `svgf_cl.compare.halves`. h1 chooses; its noise is in both sums
alike, and that of h2 and of the picture has no direction in common with it. So noise of neither truth nor picture
counts as contrast: h1 is what statistics calls an instrumental variable. Then the halves change places, and all is
added up.
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
RADIUS = 2  # of a window, in pixels
FAINT = 0.1  # standard deviation of light in a window over its mean

Plane = NDArray[np.float64]
Product = Callable[[NDArray[np.floating], NDArray[np.floating]], Plane]


def sharpness(shown: Linear, halves: Pair, where: Mask) -> Share:
    """How sharp the strongest edges among the pixels `where` (H, W) are, of display-referred pictures (H, W, 3)."""
    return slope(gradients_along, shown, halves, where)


def contrast(light: Plane, halves: tuple[Plane, Plane], where: Mask) -> Share:
    """How much contrast light (H, W) keeps in the windows around the pixels `where` (H, W).

    `where` has to be such that each window shows one surface: other edges than those of light are not what is meant.
    Nothing of nothing where the truth has no contrast beyond `FAINT`, and a slope would be that of noise.
    """
    return slope(relative_covariance, light, halves, where, FAINT**2)


def detail(shown: Linear, halves: Pair, where: Mask) -> Share:
    """How much of the finest contrast display-referred pictures (H, W, 3) keep, among the pixels `where` (H, W)."""
    return sum((ratio(laplacians, shown, pair, where) for pair in (halves, halves[::-1])), Share())


def slope(product: Product, picture: Linear, halves: Pair, where: Mask, least: float = 0.0) -> Share:
    """Slope of picture on truth, by a product (H, W) of two images, where its square is largest in the truth.

    If the truth's own product is not above `least` there, on average, it is that of nothing.
    """
    total = Share()
    for chooser, other in (halves, halves[::-1]):
        strongest = largest(product(chooser, chooser), where)
        found = ratio(product, picture, (chooser, other), strongest)
        if found.whole > least * np.count_nonzero(strongest):
            total += found
    return total


def ratio(product: Product, picture: Linear, halves: Pair, where: Mask) -> Share:
    """Product of picture and first half over that of second and first half, over the pixels `where`."""
    chooser, other = halves
    part, whole = (float(product(image, chooser)[where].sum()) for image in (picture, other))
    return Share(part, whole)


def largest(strength: Plane, where: Mask) -> Mask:
    """Among the pixels `where`, the `SHARE` where strength is largest, and above 0."""
    if not where.any():
        return where
    chosen: Mask = where & (strength > 0) & (strength >= np.quantile(strength[where], 1 - SHARE))
    return chosen


def gradients_along(shown: Linear, chooser: Linear) -> Plane:
    """Inner product of two pictures' gradients, (H, W)."""
    product: Plane = (gradient(shown) * gradient(chooser)).sum(axis=-1)
    return product


def gradient(shown: Linear) -> NDArray[np.float64]:
    """Sobel's gradient of luminance, (H, W, 2); 0 at the picture's border."""
    luminance = np.asarray(shown, np.float64) @ np.array(LUMINANCE)
    smooth_down = luminance[:-2] + 2 * luminance[1:-1] + luminance[2:]
    smooth_along = luminance[:, :-2] + 2 * luminance[:, 1:-1] + luminance[:, 2:]
    along, down = smooth_down[:, 2:] - smooth_down[:, :-2], smooth_along[2:] - smooth_along[:-2]
    return np.pad(np.stack((along, down), axis=-1) / 8, ((1, 1), (1, 1), (0, 0)))


def laplacians(shown: Linear, chooser: Linear) -> Plane:
    """Product of two pictures' Laplacians, (H, W)."""
    return laplacian(shown) * laplacian(chooser)


def laplacian(shown: Linear) -> Plane:
    """Sum of the four neighbours' luminance less four times the pixel's own, (H, W); 0 at the picture's border."""
    luminance = np.asarray(shown, np.float64) @ np.array(LUMINANCE)
    along = luminance[1:-1, :-2] + luminance[1:-1, 2:]
    down = luminance[:-2, 1:-1] + luminance[2:, 1:-1]
    return np.pad(along + down - 4 * luminance[1:-1, 1:-1], 1)


def relative_covariance(light: NDArray[np.floating], other: NDArray[np.floating]) -> Plane:
    """Covariance of two planes within each window, each relative to its mean there, (H, W); 0 where a mean is."""
    means = window_mean(light) * window_mean(other)
    with np.errstate(invalid="ignore"):  # pixels of a picture may be infinite, which leaves no number
        return np.divide(window_mean(light * other) - means, means, out=np.zeros_like(means), where=means > 0)


def window_mean(plane: NDArray[np.floating]) -> Plane:
    """Mean over the window around each pixel, (H, W); 0 where the window reaches beyond the picture."""
    mean = np.zeros(plane.shape)
    if min(plane.shape) > 2 * RADIUS:
        ones = np.ones(2 * RADIUS + 1)
        down = sliding_window_view(np.asarray(plane, np.float64), ones.size, axis=0) @ ones
        inner = slice(RADIUS, -RADIUS)
        mean[inner, inner] = sliding_window_view(down, ones.size, axis=1) @ ones / ones.size**2
    return mean

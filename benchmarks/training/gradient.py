"""The bilateral filter of LBF at single pixels, and the derivatives of its result by its parameters; compiled."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from svgf_cl.filters.lbf import OUTPUTS, WINDOW

Single = NDArray[np.float32]


class Surroundings(NamedTuple):
    """The input of the filter, for a stack of F frames; section 8 of docs/algorithm.md.

    Parameters
    ----------
    light : (F, H, W, 3)
    luminance, sharpness : (F, H, W)
        The luminance of light, and 1 / the tolerated difference of luminance.
    depth, depth_sharpness : (F, H, W)
        0 at a miss; 1 / psi_z.
    normal : (F, H, W, 3)
    normal_sharpness : (F, H, W)
        1 / psi_n^2.
    albedo : (F, H, W, 3) int32
        Codes.
    """

    light: Single
    luminance: Single
    sharpness: Single
    depth: Single
    depth_sharpness: Single
    normal: Single
    normal_sharpness: Single
    albedo: NDArray[np.int32]


@numba.njit(parallel=True, fastmath=True, error_model="numpy", cache=True)
def filtered(
    around: Surroundings, pixels: NDArray[np.int64], parameters: Single, octaves: int
) -> tuple[Single, Single]:
    """Filtered light (P, 3) at pixels (P, 3): frame, row, column; and its derivatives (P, OUTPUTS, 3).

    Parameters
    ----------
    around : Surroundings
    pixels : (P, 3)
    parameters : (P, OUTPUTS)
    octaves : int
        Largest difference of albedo codes.

    Notes
    -----
    With ``w = 2^-sum p D``, ``dF/dp_k = -ln 2 (sum w D_k c - F sum w D_k) / sum w``.
    """
    count = len(pixels)
    _, height, width = around.depth.shape
    light, slopes = np.empty((count, 3), np.float32), np.empty((count, OUTPUTS, 3), np.float32)
    for index in numba.prange(count):
        f, y, x = pixels[index]
        p = parameters[index]
        color, total = np.zeros(3), 0.0
        with_distance, of_distance = np.zeros((OUTPUTS, 3)), np.zeros(OUTPUTS)
        distance = np.zeros(OUTPUTS)
        for dy in range(-WINDOW, WINDOW + 1):
            for dx in range(-WINDOW, WINDOW + 1):
                row, column = y + dy, x + dx
                if row < 0 or column < 0 or row >= height or column >= width:
                    continue
                if around.depth[f, row, column] <= 0.0:
                    continue
                apart, cosine = 0, 0.0
                for k in range(3):
                    apart = max(apart, abs(around.albedo[f, row, column, k] - around.albedo[f, y, x, k]))
                    cosine += around.normal[f, row, column, k] * around.normal[f, y, x, k]
                if apart > octaves:
                    continue
                by_depth = (around.depth[f, y, x] - around.depth[f, row, column]) * around.depth_sharpness[f, y, x]
                by_light = (around.luminance[f, y, x] - around.luminance[f, row, column]) * around.sharpness[f, y, x]
                distance[0] = dx * dx + dy * dy
                distance[1] = by_depth * by_depth
                distance[2] = max(2.0 - 2.0 * cosine, 0.0) * around.normal_sharpness[f, y, x]
                distance[3] = by_light * by_light
                if dx == 0 and dy == 0:
                    distance[:] = 0.0
                exponent = 0.0
                for k in range(OUTPUTS):
                    exponent += p[k] * distance[k]
                if exponent > 60.0:
                    continue
                w = 2.0**-exponent
                total += w
                for c in range(3):
                    color[c] += w * around.light[f, row, column, c]
                for k in range(OUTPUTS):
                    of_distance[k] += w * distance[k]
                    for c in range(3):
                        with_distance[k, c] += w * distance[k] * around.light[f, row, column, c]
        for c in range(3):
            light[index, c] = color[c] / total
            for k in range(OUTPUTS):
                slopes[index, k, c] = -np.log(2.0) * (with_distance[k, c] - light[index, c] * of_distance[k]) / total
    return light, slopes

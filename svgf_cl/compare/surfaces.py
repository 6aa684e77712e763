"""Finds where frames show one surface, a moving texture, changing light, or no lamp.

Frames may lack fields. Without ids or albedo, no pixel counts as one surface. Without ids, no pixel counts as unmoved.
Without emission, there are no lamps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.compare.halves import Mask
from svgf_cl.compare.kept import RADIUS, Plane, laplacian, window_mean
from svgf_cl.frame import Frame
from svgf_cl.io.display import Linear
from svgf_cl.oracle.albedo import divisor
from svgf_cl.oracle.taps import luminance, shifted, square

SAME_NORMAL = 0.9  # least cosine between the normals of one surface
SAME_ALBEDO = 0.02
STILL = 0.1  # pixels of motion; with more, even a resting shadow's edge changes the light of its pixels
CHANGED = 0.1  # share of the light in a window


def one_surface(frame: Frame, radius: int = RADIUS, *, one_colour: bool = True) -> Mask:
    """Return where all pixels within `radius` show the same object with the same normal and colour, (H, W).

    With `one_colour` false, the colours may differ.
    """
    if frame.id is None or frame.albedo is None:
        return np.zeros(frame.shape, np.bool_)
    hit: Mask = frame.depth < np.inf
    same: Mask = hit.copy()
    for offset in square(radius):
        y, x, inside = shifted(offset, frame.shape)
        same &= inside & hit[y, x] & (frame.id[y, x] == frame.id)
        same &= (frame.normal[y, x] * frame.normal).sum(axis=-1) > SAME_NORMAL
        if one_colour:
            same &= np.abs(frame.albedo[y, x] - frame.albedo).max(axis=-1) < SAME_ALBEDO
    return same


def reflecting(frame: Frame) -> Mask:
    """Return where neither a pixel nor one of its eight neighbours shows a lamp or the sky, (H, W)."""
    dark: Mask = frame.depth < np.inf
    if frame.emission is not None:
        dark = dark & (frame.emission == 0).all(axis=-1)
    result: Mask = dark.copy()
    for offset in square(1):
        y, x, _ = shifted(offset, frame.shape)
        result &= dark[y, x]
    return result


def moving_texture(frame: Frame, radius: int = RADIUS) -> Mask:
    """Return where a pixel lies on a moving texture, (H, W).

    All pixels within `radius` show one moving surface, and the Laplacian of its albedo is above `SAME_ALBEDO`.
    """
    if frame.albedo is None:
        return np.zeros(frame.shape, np.bool_)
    textured = np.abs(laplacian(frame.albedo)) > SAME_ALBEDO
    return one_surface(frame, radius, one_colour=False) & textured & (speed(frame) > STILL)


def without_albedo(picture: Linear, frame: Frame) -> Plane:
    """Return the luminance of a picture's light without albedo, which is divided out as filters do it, (H, W)."""
    light = np.asarray(picture, np.float64)
    return luminance(light if frame.albedo is None else light / divisor(np.asarray(frame.albedo, np.float64)))


def still(earlier: Frame, later: Frame) -> NDArray[np.float64]:
    """Return 1 where a pixel shows the same surface in both frames, else 0, (H, W)."""
    if earlier.id is None or later.id is None:
        return np.zeros(later.shape)
    same: Mask = (earlier.id == later.id) & (speed(later) < STILL)
    return same.astype(np.float64)


def speed(frame: Frame) -> Plane:
    """Return how far surfaces have moved since the previous frame, in pixels, (H, W)."""
    pixels: Plane = np.hypot(frame.motion[..., 0], frame.motion[..., 1])
    return pixels


def relit(earlier: tuple[Plane, Plane], later: tuple[Plane, Plane], unmoved: NDArray[np.float64]) -> Mask:
    """Return around which pixels only the light changes, by a share `CHANGED` on average, (H, W).

    Parameters
    ----------
    earlier, later : two of (H, W)
        Light of two consecutive frames in each half of the truth, so that noise does not count as change.
    unmoved : (H, W)
        The result of `still`.
    """
    first, second = (after - before for before, after in zip(earlier, later, strict=True))
    mean = window_mean(0.5 * (later[0] + later[1]))
    changed: Mask = window_mean(first * second) > (CHANGED * mean) ** 2
    return changed & (window_mean(unmoved) > 1 - 1e-9)

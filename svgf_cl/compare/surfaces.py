"""Where frames show one surface, a texture that moves, light that changes, and no lamp.

Frames may lack fields. Without ids or albedo nothing is known to be one surface, and without ids nothing to be what it
was. Without emission there are no lamps.
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

SAME_NORMAL = 0.9  # cosine from which two pixels show one surface
SAME_ALBEDO = 0.02
STILL = 0.1  # pixels of motion; with more, a shadow's edge that rests changes light at its pixels, too
CHANGED = 0.1  # of the light in a window


def one_surface(frame: Frame, radius: int = RADIUS, *, one_colour: bool = True) -> Mask:
    """Where a pixel and all within `radius` show the same object, turned the same way, of the same colour, (H, W).

    With `one_colour` false, of any colours.
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
    """Where neither a pixel nor one of the eight around it shows a lamp or the sky, (H, W)."""
    dark: Mask = frame.depth < np.inf
    if frame.emission is not None:
        dark = dark & (frame.emission == 0).all(axis=-1)
    result: Mask = dark.copy()
    for offset in square(1):
        y, x, _ = shifted(offset, frame.shape)
        result &= dark[y, x]
    return result


def moving_texture(frame: Frame, radius: int = RADIUS) -> Mask:
    """Where a pixel and all within `radius` show one surface that moves, and albedo bends by `SAME_ALBEDO`, (H, W)."""
    if frame.albedo is None:
        return np.zeros(frame.shape, np.bool_)
    textured = np.abs(laplacian(frame.albedo)) > SAME_ALBEDO
    return one_surface(frame, radius, one_colour=False) & textured & (speed(frame) > STILL)


def without_albedo(picture: Linear, frame: Frame) -> Plane:
    """Luminance of a picture's light, demodulated as the filters do it, (H, W)."""
    light = np.asarray(picture, np.float64)
    return luminance(light if frame.albedo is None else light / divisor(np.asarray(frame.albedo, np.float64)))


def still(earlier: Frame, later: Frame) -> NDArray[np.float64]:
    """1 where the later frame shows what the earlier one does at that pixel, else 0, (H, W)."""
    if earlier.id is None or later.id is None:
        return np.zeros(later.shape)
    same: Mask = (earlier.id == later.id) & (speed(later) < STILL)
    return same.astype(np.float64)


def speed(frame: Frame) -> Plane:
    """How far surfaces have moved since the frame before, in pixels, (H, W)."""
    pixels: Plane = np.hypot(frame.motion[..., 0], frame.motion[..., 1])
    return pixels


def relit(earlier: tuple[Plane, Plane], later: tuple[Plane, Plane], unmoved: NDArray[np.float64]) -> Mask:
    """Around which pixels nothing moves but light, by `CHANGED` of itself on average, (H, W).

    Parameters
    ----------
    earlier, later : two of (H, W)
        Light of two consecutive frames, as known from each half of the truth: its noise is no change.
    unmoved : (H, W)
        As `still` has it.
    """
    first, second = (after - before for before, after in zip(earlier, later, strict=True))
    mean = window_mean(0.5 * (later[0] + later[1]))
    changed: Mask = window_mean(first * second) > (CHANGED * mean) ** 2
    return changed & (window_mean(unmoved) > 1 - 1e-9)

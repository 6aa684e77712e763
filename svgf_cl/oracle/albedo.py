"""Float64 oracle of what is made of albedo: what light is divided by, and which albedos are alike."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.oracle.taps import Array, Mask

ALBEDO_FLOOR, CHANNEL_FLOOR = 0.02, 0.04  # absolute; of the greatest channel
DARK = np.float32(0.004)  # albedos far below it look alike
OCTAVE = 64  # codes


def divisor(albedo: Array) -> Array:
    """Section 1: albedo', (..., 3), of an albedo of 0..1."""
    greatest = albedo.max(axis=-1, keepdims=True)
    divided_by: Array = np.maximum(albedo, np.maximum(CHANNEL_FLOOR * greatest, ALBEDO_FLOOR))
    return divided_by


def alike(albedo: Array, other: Array, octaves: float) -> Mask:
    """Section 1: whether albedos (..., 3) are at most so many octaves apart in every channel, as codes have it."""
    off = np.abs(albedo_codes(albedo) - albedo_codes(other)).max(axis=-1)
    same: Mask = off <= int(octaves * OCTAVE)
    return same


def albedo_codes(albedo: Array) -> NDArray[np.int32]:
    """Section 1: octaves from `DARK` to albedo + `DARK`, in whole 64ths, by the bits of a float: (..., 3)."""
    above = albedo.astype(np.float32) + DARK
    codes: NDArray[np.int32] = (above.view(np.int32) - DARK.view(np.int32)) >> 17
    return codes

"""Float64 oracle of albedo: the number by which light is divided, and whether two albedos are alike."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from svgf_cl.oracle.taps import Array, Mask

Codes = NDArray[np.int32]

ALBEDO_FLOOR, CHANNEL_FLOOR = 0.02, 0.04  # absolute; as a share of the greatest channel
DARK = np.float32(0.004)  # albedos far below this are all alike
OCTAVE = 64  # codes per octave


def divisor(albedo: Array) -> Array:
    """Section 1: albedo', (..., 3), from an albedo of 0..1."""
    greatest = albedo.max(axis=-1, keepdims=True)
    divided_by: Array = np.maximum(albedo, np.maximum(CHANNEL_FLOOR * greatest, ALBEDO_FLOOR))
    return divided_by


def alike(codes: Codes, others: Codes, octaves: float) -> Mask:
    """Section 1: whether the codes of two albedos (..., 3) differ by at most `octaves` in every channel."""
    same: Mask = np.abs(codes - others).max(axis=-1) <= int(octaves * OCTAVE)
    return same


def albedo_codes(albedo: Array) -> Codes:
    """Section 1: 64ths of an octave from `DARK` to albedo + `DARK`, read from the bits of a float: (..., 3)."""
    above = albedo.astype(np.float32) + DARK
    codes: Codes = (above.view(np.int32) - DARK.view(np.int32)) >> 17
    return codes

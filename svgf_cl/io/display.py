"""Turns linear light into pictures for a screen: exposure, the sRGB curve, and files with 8 bits."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from svgf_cl.frame import LUMINANCE
from svgf_cl.io.atomic import written_whole

Linear = npt.NDArray[np.floating]
Bytes = npt.NDArray[np.uint8]

MAX_STOPS = 64  # of exposure: beyond that, every picture is black or white
MIDDLE_GREY = 0.18
BLOCK = 8  # pixels
QUALITY = 90  # of a WebP file: its errors are invisible; PNG ignores it


def display(linear: Linear, exposure: float = 0.0) -> npt.NDArray[np.float64]:
    """Make a picture display-referred: expose it, clip it to 0..1, encode it with the sRGB transfer curve.

    Parameters
    ----------
    linear : (H, W, 3) float
        Linear scene-referred radiance with Rec. 709 primaries.
    exposure : float, stops
        The radiance is multiplied by ``2**exposure`` first.

    Returns
    -------
    (H, W, 3) float64
        0..1; NaN stays NaN.
    """
    clipped = np.clip(np.asarray(linear, np.float64) * 2.0**exposure, 0.0, 1.0)
    # IEC 61966-2-1.
    shown: npt.NDArray[np.float64] = np.where(
        clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055
    )
    return shown


def automatic_exposure(linear: Linear) -> float:
    """Return the stops that bring the log-average luminance of a picture (H, W, 3) to middle grey.

    The luminance is first averaged over blocks, so that noise changes the result little. Black blocks, where nothing is
    lit, do not count. For an all-black picture the result is 0.

    Source: Reinhard et al., Photographic Tone Reproduction for Digital Images, SIGGRAPH 2002, equations 1 and 2.
    """
    luminance = np.asarray(linear, np.float64) @ LUMINANCE
    for axis, length in enumerate(luminance.shape):
        starts = range(0, length, BLOCK)
        sizes = np.diff([*starts, length])
        luminance = np.add.reduceat(luminance, starts, axis) / np.expand_dims(sizes, 1 - axis)
    lit = luminance[luminance > 0.0]
    return float(np.log2(MIDDLE_GREY) - np.log2(lit).mean()) if lit.size else 0.0


def to_bytes(linear: Linear, exposure: float = 0.0) -> Bytes:
    """Return `display` in 8 bits; NaN becomes black."""
    return np.rint(np.nan_to_num(display(linear, exposure)) * 255).astype(np.uint8)


def write_image(path: Path, picture: Bytes) -> None:
    """Write a (H, W, 3) 8-bit picture completely or not at all, in the format of the suffix, such as .png or .webp."""
    # Encoded in memory: on a full disk OpenImageIO reports no error when writing PNG, and hangs when writing WebP.
    encoded = io.BytesIO()
    with written_whole(path) as aside:
        Image.fromarray(picture).save(encoded, format=path.suffix[1:], quality=QUALITY)
        aside.write_bytes(encoded.getbuffer())

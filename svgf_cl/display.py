"""From light to what a screen shows: exposure, the sRGB curve, 8-bit pictures as PNG files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813  # its documentation calls it so

from svgf_cl.errors import SequenceError
from svgf_cl.files import written_whole

Linear = npt.NDArray[np.floating]
Bytes = npt.NDArray[np.uint8]


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


def to_bytes(linear: Linear, exposure: float = 0.0) -> Bytes:
    """Return `display` in 8 bits; NaN becomes black."""
    return np.rint(np.nan_to_num(display(linear, exposure)) * 255).astype(np.uint8)


def write_png(path: Path, picture: Bytes) -> None:
    """Write a (H, W, 3) 8-bit picture as PNG, whole or not at all."""
    height, width, channels = picture.shape
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, "uint8"))
    with written_whole(path) as aside:
        if not (image.set_pixels(image.roi, picture) and image.write(str(aside), fileformat="png")):
            raise SequenceError(f"{path}: cannot be written ({image.geterror()})")

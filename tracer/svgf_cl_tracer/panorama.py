"""Reads environments from image files."""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path

import numpy as np
import numpy.typing as npt

from svgf_cl.errors import FileError
from svgf_cl.io.exr import is_exr, read_image
from svgf_cl.io.layers import picture_channels
from svgf_cl.io.window import placed

from .errors import SceneError
from .primaries import to_rec709
from .radiance import read_radiance
from .sky import Environment
from .vectors import Float32, Float64

# The most pixels: 8192 x 4096, 400 MB in memory.
MAX_PIXELS = 2**25


def load_environment(path: str | PathLike[str], to_world: Float64 | None = None) -> Environment:
    """Read an equirectangular image of all directions, .hdr or .exr.

    The picture is found by the names of channels, as in `picture_channels`. It is placed in the display window, and
    missing pixels are black. Primaries are converted to those of Rec. 709. Invalid radiance is repaired with a warning.

    Parameters
    ----------
    path : path
    to_world : (3, 3) float, optional
        Rotation from the image's frame, which `Environment` describes, into the world; by default none.

    Raises
    ------
    SceneError
        If the file is missing, damaged, of another format or too large, or if it has no picture or no finite value.
    """
    path = Path(path)
    try:
        image = read_image(path) if is_exr(path) else read_radiance(path)
        windows, planes = image.windows, image.planes
        if windows.display.area > MAX_PIXELS:
            raise SceneError(f"expected at most {MAX_PIXELS} pixels, got {windows.display}")
        names = picture_channels(planes)
    except FileError as error:
        raise SceneError(str(error)) from error
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from error
    found = np.stack([np.asarray(planes[name], np.float32) for name in names], axis=-1)
    picture = placed(found, windows.data, windows.display, 0.0)
    try:
        finite, repairs = without_infinities(picture)
        radiance, clipped = without_negatives(to_rec709(finite, image.chromaticities))
        environment = Environment(radiance, np.eye(3) if to_world is None else to_world)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
    if repairs + clipped and not radiance.any():
        raise SceneError(f"{path}: expected radiance, got none: {'; '.join(repairs + clipped)}")
    if repairs + clipped:
        warnings.warn(f"{path}: mended in this sky: {'; '.join(repairs + clipped)}", stacklevel=2)
    return environment


def without_infinities(picture: Float32) -> tuple[Float32, list[str]]:
    """Replace NaN by 0 and infinity by the greatest finite value of a (h, w, 3) picture; say in how many pixels."""
    finite = np.isfinite(picture)
    if not finite.any():
        raise SceneError("sky: expected finite radiance, got none in the whole image")
    nan, infinite = np.isnan(picture), np.isposinf(picture)
    greatest = float(picture[finite].max())
    repairs = said(nan, "NaN, now 0") + said(infinite, f"infinite, now {greatest:g} as the brightest finite one")
    return np.where(nan, 0.0, np.where(infinite, greatest, picture)).astype(np.float32), repairs


def without_negatives(picture: Float32) -> tuple[Float32, list[str]]:
    """Replace negative values of a (h, w, 3) picture by 0; say in how many pixels."""
    return np.maximum(picture, np.float32(0.0)), said(picture < 0.0, "negative, now 0")


def said(values: npt.NDArray[np.bool_], what: str) -> list[str]:
    """A text that says how many pixels have such values, (h, w, 3), if any do."""
    count = int(values.any(axis=-1).sum())
    return [f"{count} {'pixel' if count == 1 else 'pixels'} {what}"] if count else []

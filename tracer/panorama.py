"""Environments from image files."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813  # its documentation calls it so

from .errors import SceneError
from .sky import Environment
from .vectors import Float64

FORMATS = ("hdr", "openexr")  # linear ones

# 8192 x 4096: 400 MB in memory. A file says its size before it is read.
MAX_PIXELS = 2**25


def load_environment(path: str | PathLike[str], to_world: Float64 | None = None) -> Environment:
    """Read an equirectangular image of all directions, .hdr or .exr.

    Parameters
    ----------
    path : path
    to_world : (3, 3) float, optional
        Rotation from the image's frame, which `Environment` describes, into the world's; none where absent.

    Raises
    ------
    SceneError
        The file is missing, damaged, of another format or too large, or holds what is no radiance.
    """
    path = Path(path)
    if not path.is_file():
        raise SceneError(f"{path}: no such file")
    source = oiio.ImageInput.open(str(path))
    if source is None or source.format_name() not in FORMATS:
        got = f"the format {source.format_name()}" if source else oiio.geterror()
        raise SceneError(f"{path}: expected a linear image, .hdr or .exr, got {got}")
    size = source.spec()
    if size.nchannels < 3 or size.width * size.height > MAX_PIXELS:
        raise SceneError(
            f"{path}: expected three channels and at most {MAX_PIXELS} pixels, "
            f"got {size.nchannels} and {size.width} x {size.height}"
        )
    pixels = source.read_image(0, 0, 0, 3, "float")
    if pixels is None:
        raise SceneError(f"{path}: expected a whole image, got a damaged one ({source.geterror()})")
    try:
        return Environment(pixels, np.eye(3) if to_world is None else to_world)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error

"""Reads Radiance HDR files, and checks their sizes first."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813  # its documentation calls it so

from svgf_cl.errors import FileError, one_line
from svgf_cl.io.atomic import require
from svgf_cl.io.exr import MAX_RATIO, TRUSTED
from svgf_cl.io.image import Image, new_image
from svgf_cl.io.layers import RGB


def read_radiance(path: Path) -> Image:
    """Read the picture of a Radiance HDR file.

    Raises
    ------
    FileError
        If the file is missing, of another format or damaged, or claims more pixels than it can contain.
    """
    require(path)
    if not path.is_file():
        raise FileError(f"{path}: expected a Radiance HDR file or an OpenEXR file, found something that is not a file")
    source = oiio.ImageInput.open(str(path))
    if source is None or source.format_name() != "hdr":
        got = f"the format {source.format_name()}" if source else one_line(oiio.geterror())
        raise FileError(f"{path}: expected a Radiance HDR file or an OpenEXR file, got {got}")
    claimed, held = source.spec().image_bytes(), path.stat().st_size
    if claimed > max(TRUSTED, MAX_RATIO * held):
        raise FileError(f"{path}: expected a complete image, got {claimed} bytes of pixels in a file of {held}")
    pixels = source.read_image("float")
    if pixels is None:
        raise FileError(f"{path}: expected a complete image, got a damaged one ({one_line(source.geterror())})")
    return new_image(dict(zip(RGB, np.moveaxis(pixels, -1, 0), strict=True)), {})

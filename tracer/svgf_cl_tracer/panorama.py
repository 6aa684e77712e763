"""Environments from image files."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from svgf_cl.errors import FileError
from svgf_cl.io.exr import read_pixels

from .errors import SceneError
from .sky import Environment
from .vectors import Float64

FORMATS = ("hdr", "openexr")  # linear ones

# 8192 x 4096: 400 MB in memory.
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
    try:
        names, pixels = read_pixels(path, FORMATS)
        height, width = pixels.shape[:2]
        if len(names) < 3 or width * height > MAX_PIXELS:
            raise SceneError(
                f"expected three channels and at most {MAX_PIXELS} pixels, got {len(names)} and {width} x {height}"
            )
        return Environment(np.ascontiguousarray(pixels[..., :3]), np.eye(3) if to_world is None else to_world)
    except FileError as error:
        raise SceneError(str(error)) from error
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error

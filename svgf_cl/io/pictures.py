"""Pictures as OpenEXR files: plain ones, and denoised ones that keep what else the file of their frame holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from svgf_cl.errors import FileError
from svgf_cl.io.exr import read_image, write_image
from svgf_cl.io.frames import MADE_FROM
from svgf_cl.io.image import Image, new_image
from svgf_cl.io.layers import RGB, picture_channels
from svgf_cl.io.window import placed

Picture = npt.NDArray[np.float32]


def picture_file(picture: Picture) -> Image:
    """Make the file of a (H, W, 3) linear picture, which has ``R G B`` alone."""
    return new_image(channels(picture), {})


def denoised_file(
    planes: Mapping[str, Picture], source: Image, *, beside: str | None = None, plain: bool = False
) -> Image:
    """Make the file of what was denoised of a frame.

    Parameters
    ----------
    planes : mapping of str to (H, W) float32
        Channels that were made.
    source : Image
        The file of the frame, of the same data window: what it says, and its other channels, go along.
    beside : str, optional
        The channel to whose part of the file those go that it does not have yet; by default to the first part.
    plain : bool
        No channels of the source.
    """
    kept = source.without(MADE_FROM)
    return kept.with_planes_alone(planes) if plain else kept.with_planes(planes, beside)


def channels(picture: Picture, names: Sequence[str] = RGB) -> dict[str, Picture]:
    """Take a (H, W, 3) picture apart into its channels."""
    return dict(zip(names, np.moveaxis(picture, -1, 0), strict=True))


def write_picture(path: Path, picture: npt.ArrayLike) -> None:
    """Write a (H, W, 3) linear picture as a plain ``R G B`` EXR file, whole or not at all."""
    write_image(path, picture_file(np.asarray(picture, np.float32)))


def is_picture(path: Path, picture: Picture) -> bool:
    """Whether the file at `path` holds this (H, W, 3) picture and nothing else, bit by bit."""
    return holds(path, picture_file(picture))


def holds(path: Path, image: Image) -> bool:
    """Whether the file at `path` holds this image, bit by bit."""
    try:
        return read_image(path).same_as(image)
    except FileError:
        return False


def read_picture(path: Path) -> Picture:
    """Read the picture of an EXR file, whatever else it holds, as (H, W, 3) float32 on its display window.

    Which channels these are says `picture_channels`. Pixels of the display window that the file lacks are black.

    Raises
    ------
    FileError
        As of `read_image`, and where there is no picture or more than one.
    """
    image = read_image(path)
    planes = image.planes
    try:
        names = picture_channels(planes)
    except ValueError as error:
        raise FileError(f"{path}: {error}") from error
    picture = np.stack([np.asarray(planes[name], np.float32) for name in names], axis=-1)
    return placed(picture, image.windows.data, image.windows.display, 0.0)

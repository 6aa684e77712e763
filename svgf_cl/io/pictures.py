"""Reads and writes pictures as OpenEXR files: plain ones, and denoised ones that keep their source's other content."""

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
    """Return the file of a (H, W, 3) linear picture, which has only ``R G B``."""
    return new_image(channels(picture), {})


def denoised_file(
    planes: Mapping[str, Picture], source: Image, *, beside: str | None = None, plain: bool = False
) -> Image:
    """Return the file of a denoised frame.

    Parameters
    ----------
    planes : mapping of str to (H, W) float32
        The denoised channels.
    source : Image
        The file of the frame, with the same data window. Its attributes and its other channels are kept.
    beside : str, optional
        New channels go to the part that has this channel; by default to the first part.
    plain : bool
        Leave out the channels of the source.
    """
    kept = source.without(MADE_FROM)
    return kept.with_planes_alone(planes) if plain else kept.with_planes(planes, beside)


def channels(picture: Picture, names: Sequence[str] = RGB) -> dict[str, Picture]:
    """Return the channels of a (H, W, 3) picture, by name."""
    return dict(zip(names, np.moveaxis(picture, -1, 0), strict=True))


def write_picture(path: Path, picture: npt.ArrayLike) -> None:
    """Write a (H, W, 3) linear picture as a plain ``R G B`` EXR file, completely or not at all."""
    write_image(path, picture_file(np.asarray(picture, np.float32)))


def is_picture(path: Path, picture: Picture) -> bool:
    """Whether the file at `path` contains exactly this (H, W, 3) picture, bit by bit."""
    return holds(path, picture_file(picture))


def holds(path: Path, image: Image) -> bool:
    """Whether the file at `path` contains exactly this image, bit by bit."""
    try:
        return read_image(path).same_as(image)
    except FileError:
        return False


def read_picture(path: Path) -> Picture:
    """Read the picture of an EXR file as (H, W, 3) float32 on its display window.

    `picture_channels` finds its channels. Pixels of the display window that the file lacks are black.

    Raises
    ------
    FileError
        As in `read_image`, and if there is no picture or more than one.
    """
    image = read_image(path)
    planes = image.planes
    try:
        names = picture_channels(planes)
    except ValueError as error:
        raise FileError(f"{path}: {error}") from error
    picture = np.stack([np.asarray(planes[name], np.float32) for name in names], axis=-1)
    return placed(picture, image.windows.data, image.windows.display, 0.0)

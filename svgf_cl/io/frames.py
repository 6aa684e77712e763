"""Reads and writes frames as OpenEXR files: one file for each frame, one float32 channel for each component.

Compression is lossless (zip). docs/conventions.md lists the channels of each field. A plain picture (denoised, or a
reference) has only ``R G B``. Frames are called ``frame.0000.exr``, and references ``reference.0000.exr``; the number
is the frame's position in its sequence.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from svgf_cl.errors import FileError
from svgf_cl.frame import Frame
from svgf_cl.io.exr import read_attribute, read_image, write_channels
from svgf_cl.io.image import Plane
from svgf_cl.io.readers.own import CHANNEL_NAMES, MAX_ID, OWN
from svgf_cl.io.reading import ReadAs, Reading

ALPHA_NAME = "A"  # color's fourth channel; it is written but not read, as denoised files keep all channels anyway
MADE_FROM = "svgf_cl:made_from"  # the attribute that says what a frame was made from


def frame_path(folder: Path, number: int, stem: str = "frame") -> Path:
    """Return the path of frame `number` in `folder`, such as ``frame.0007.exr``."""
    return folder / f"{stem}.{number:04d}.exr"


def write_frame(path: Path, frame: Frame, made_from: str = "") -> None:
    """Write a frame of numpy arrays as one EXR file, completely or not at all.

    Parameters
    ----------
    path : Path
    frame : Frame
    made_from : str
        A text that changes with everything that the frame depends on; `kept_frame` compares it.

    Raises
    ------
    FrameError
        If the frame is not consistent.
    FileError
        If an id is greater than 2**24, or the file cannot be written.
    """
    write_channels(path, channels_of(path, frame), {MADE_FROM: made_from} if made_from else {})


def kept_frame(path: Path, made_from: str) -> Frame | None:
    """Read the frame that an earlier run wrote with the same `made_from`; None if there is no such complete file."""
    try:
        return read_frame(path) if read_attribute(path, MADE_FROM) == made_from else None
    except FileError:
        return None


def channels_of(path: Path, frame: Frame) -> dict[str, Plane]:
    """Return the channels of a frame of numpy arrays for the file `path`; errors as in `write_frame`."""
    frame.check(frame.shape)
    planes: dict[str, Plane] = {}
    for field, value in frame.present().items():
        if field == "id" and value.max(initial=0) > MAX_ID:
            raise FileError(f"{path}: expected ids up to {MAX_ID} (whole numbers in float32), got {value.max()}")
        components = np.asarray(value, np.float32).reshape(*frame.shape, -1)
        names = (*CHANNEL_NAMES[field], *([ALPHA_NAME] if field == "color" else []))
        planes |= zip(names, np.moveaxis(components, -1, 0), strict=False)
    return planes


def read_frame(path: Path) -> Frame:
    """Read a frame, with all its pixels, from a file of `write_frame` or of a renderer with the same channel names.

    Raises
    ------
    FileError
        If the file is missing or not an EXR file, or a field is missing, incomplete or invalid.
    """
    image = read_image(path)
    return Reading(path, image, ReadAs(OWN.name)).frame(path, image.planes)

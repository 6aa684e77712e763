"""Frames and pictures as OpenEXR files: one file a frame, float32, lossless (zip), one named channel a component.

The channels of each field are in docs/conventions.md. A plain picture (denoised, reference) has ``R G B`` alone. Frames
are called ``frame.0000.exr``, references ``reference.0000.exr``; the number is the frame's place in its sequence.
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

ALPHA_NAME = "A"  # of color's fourth channel; written with a frame, not read into one, as files keep what is not read
MADE_FROM = "svgf_cl:made_from"  # the attribute that tells what a frame was made from


def frame_path(folder: Path, number: int, stem: str = "frame") -> Path:
    """Name the file of frame `number` in `folder`: ``frame.0007.exr``."""
    return folder / f"{stem}.{number:04d}.exr"


def write_frame(path: Path, frame: Frame, made_from: str = "") -> None:
    """Write a frame of numpy arrays as one EXR file, whole or not at all.

    Parameters
    ----------
    path : Path
    frame : Frame
    made_from : str
        What stands for all that the frame depends on, for `kept_frame` to know it by.

    Raises
    ------
    FrameError
        Where the frame is not consistent in itself.
    FileError
        Where an id is greater than 2**24, or the file cannot be written.
    """
    write_channels(path, channels_of(path, frame), {MADE_FROM: made_from} if made_from else {})


def kept_frame(path: Path, made_from: str) -> Frame | None:
    """Read the frame that an earlier run made from the same and wrote whole; None where there is no such file."""
    try:
        return read_frame(path) if read_attribute(path, MADE_FROM) == made_from else None
    except FileError:
        return None


def channels_of(path: Path, frame: Frame) -> dict[str, Plane]:
    """Take a frame of numpy arrays apart into the channels of file `path`; errors as of `write_frame`."""
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
    """Read a frame that `write_frame`, or a renderer with the same channel names, wrote: all its pixels.

    Raises
    ------
    FileError
        Where the file is missing or not an EXR file, or where a field is absent, incomplete or of a wrong value.
    """
    image = read_image(path)
    return Reading(path, image, ReadAs(OWN.name)).frame(path, image.planes)

"""Frames and pictures as OpenEXR files: one file a frame, float32, lossless (zip), one named channel a component.

The channels of each field are in docs/conventions.md. A plain picture (denoised, reference) has ``R G B`` alone. Frames
are called ``frame.0000.exr``, references ``reference.0000.exr``; the number is the frame's place in its sequence.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from svgf_cl.errors import FileError, FrameError
from svgf_cl.frame import REQUIRED, Frame
from svgf_cl.io.exr import read_attribute, read_channels, write_channels
from svgf_cl.io.image import Plane
from svgf_cl.io.look_alikes import advice

# Channels of each field, in the order of its components; `OPTIONAL` may be missing.
CHANNEL_NAMES: dict[str, tuple[str, ...]] = {
    "color": ("R", "G", "B"),
    **{
        name: tuple(f"{name}.{c}" for c in "RGB")
        for name in ("albedo", "emission", "direct", "indirect", "diffuse", "specular")
    },
    **{name: tuple(f"{name}.{c}" for c in "XYZ") for name in ("normal", "motion")},
    "depth": ("depth.Z",),
    "id": ("id",),
    "roughness": ("roughness",),
    "hit_distance": ("hit_distance.diffuse", "hit_distance.specular"),
}
OPTIONAL = "motion.Z"
MAX_ID = 2**24  # of ids in a channel of floats
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
        planes |= zip(CHANNEL_NAMES[field], np.moveaxis(components, -1, 0), strict=False)
    return planes


def read_frame(path: Path) -> Frame:
    """Read a frame that `write_frame`, or a renderer with the same channel names, wrote: all its pixels.

    Raises
    ------
    FileError
        Where the file is missing or not an EXR file, or where a field is absent, incomplete or of a wrong value.
    """
    return frame_of(path, read_channels(path))


def frame_of(path: Path, planes: Mapping[str, Plane]) -> Frame:
    """Put a frame together from the channels of file `path`; errors as of `read_frame`."""
    values = {field: value for field in CHANNEL_NAMES if (value := field_of(path, planes, field)) is not None}
    missing = [field for field in REQUIRED if field not in values]
    if missing:
        light = [] if values.keys() & {"color", "direct", "indirect"} else ["color"]
        raise absent(path, [*light, *missing], planes)
    frame = Frame(**values)
    try:
        frame.check_presence()
    except FrameError as error:
        raise FileError(f"{path}: {error}; channels found: {' '.join(planes)}{hint(['color'], planes)}") from error
    return frame


def field_of(path: Path, planes: Mapping[str, Plane], field: str) -> npt.NDArray[np.generic] | None:
    """Put `field` together from its channels; None where none is there, an error where only some are."""
    names = CHANNEL_NAMES[field]
    found = [planes[name] for name in names if name in planes]
    if not found:
        return None
    if not planes.keys() >= set(needed(field)):
        raise absent(path, [field], planes)
    if field == "id":
        return whole_numbers(path, found[0])
    values = [np.asarray(plane, np.float32) for plane in found]
    return values[0] if len(names) == 1 else np.stack(values, axis=-1)


def whole_numbers(path: Path, plane: Plane) -> npt.NDArray[np.uint32]:
    """Return ids as integers; `FileError` unless they are, or are whole numbers that float32 holds exactly."""
    if plane.dtype == np.uint32:
        return plane.astype(np.uint32, copy=False)
    numbers = plane.astype(np.float32, copy=False)  # 16 bits cannot be compared with MAX_ID
    fits = (numbers >= 0) & (numbers <= MAX_ID) & (numbers == np.floor(numbers))
    if not fits.all():
        raise FileError(
            f"{path}: expected whole numbers in 0..{MAX_ID} in channel id, got {numbers[~fits][0]}; "
            "an id up to 4294967295 takes a channel of unsigned integers"
        )
    return numbers.astype(np.uint32)


def needed(field: str) -> tuple[str, ...]:
    """The channels without which a field is not there."""
    return tuple(name for name in CHANNEL_NAMES[field] if name != OPTIONAL)


def absent(path: Path, fields: Sequence[str], planes: Mapping[str, Plane]) -> FileError:
    """Make the error for fields whose channels are not all there; it lists those that are, and what they may be."""
    names = [name for field in fields for name in needed(field)]
    return FileError(f"{path}: expected channels {' '.join(names)}, found {' '.join(planes)}{hint(fields, planes)}")


def hint(fields: Sequence[str], planes: Mapping[str, Plane]) -> str:
    """What to add to an error for fields that are not there."""
    text = advice(planes, {field: needed(field) for field in fields})
    return text and f"; {text}"

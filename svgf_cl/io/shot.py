"""The frames of a shot, on the one window that all their pixels lie in."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from svgf_cl.errors import FileError
from svgf_cl.frame import Frame
from svgf_cl.io.exr import MAX_DISPLAY, read_image, read_windows
from svgf_cl.io.frames import frame_of
from svgf_cl.io.image import Image
from svgf_cl.io.window import Window, placed, union

# What the fields of a pixel hold that shows nothing; all others are 0.
NOTHING = {"depth": np.inf, "albedo": 1.0, "roughness": 1.0}


def read_shot(paths: Sequence[Path], window: Window) -> Iterator[tuple[Image, Frame]]:
    """Read one file of a shot after the other: all of it, and its frame on a window that the shot shares.

    Where the frame has no pixel, as data windows may move and change in size, it shows nothing.

    Raises
    ------
    FileError
        As `read_frame`, and where a frame differs in fields from the first or a field has no usable value.
    """
    fields = None
    for path in paths:
        image = read_image(path)
        frame = frame_of(path, image.planes)
        fields = fields or fields_of(frame)
        changes = [f"without {name}" for name in sorted(fields - fields_of(frame))]
        changes += [f"with {name}" for name in sorted(fields_of(frame) - fields)]
        if changes:
            raise FileError(f"{path}: expected the fields of {paths[0]}, got a frame {', '.join(changes)}")
        check_usable(path, frame)
        yield image, moved(frame, image.windows.data, window)


def shared_window(paths: Sequence[Path]) -> Window:
    """The window of all pixels of these files; `FileError` where they cannot lie on one picture."""
    windows = {path: read_windows(path) for path in paths}
    first = windows[paths[0]]
    for path, own in windows.items():
        if (own.display, own.pixel_aspect) != (first.display, first.pixel_aspect):
            raise FileError(
                f"{path}: expected the display window {first.display} and pixel aspect ratio {first.pixel_aspect:g} of"
                f" {paths[0]}, got {own.display} and {own.pixel_aspect:g}; denoise one shot at a time"
            )
    window = union(own.data for own in windows.values())
    if window.area > max(MAX_DISPLAY, *(own.data.area for own in windows.values())):
        far = max(windows, key=lambda path: union((first.data, windows[path].data)).area)
        raise FileError(
            f"{far}: expected a data window near {first.data}, that of {paths[0]}, got {windows[far].data}: too many"
            " pixels between them"
        )
    return window


def moved(frame: Frame, have: Window, want: Window) -> Frame:
    """The frame on another window; where it had no pixel it shows nothing."""
    fields = {name: placed(value, have, want, NOTHING.get(name, 0.0)) for name, value in frame.present().items()}
    return Frame(**fields)


def fields_of(frame: Frame) -> set[str]:
    """Name the fields that are there, and motion.Z, which is optional too."""
    return {*frame.present(), *(["motion.Z"] if frame.motion.shape[-1] == 3 else [])}


def check_usable(path: Path, frame: Frame) -> None:
    """Raise `FileError` where a whole field is NaN or infinite (depth may be infinite: an empty sky)."""
    for field, value in frame.present().items():
        usable = ~np.isnan(value) if field == "depth" else np.isfinite(value)
        if not usable.any():
            raise FileError(f"{path}: expected finite values in {field}, got none in the whole frame")

"""`Shot`: the frames of a shot, from files of any renderer, all on one window that contains all their pixels."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from svgf_cl.camera import Camera, motion_from_cameras
from svgf_cl.errors import FileError
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.cameras import cameras_beside
from svgf_cl.io.exr import MAX_DISPLAY, read_image, read_windows
from svgf_cl.io.image import Image, Plane
from svgf_cl.io.reading import LightPass, ReadAs, Reading, stacked
from svgf_cl.io.separate import SeparateFiles
from svgf_cl.io.sequence import after_gaps, find_frames, number_of
from svgf_cl.io.shot_cameras import ShotCameras
from svgf_cl.io.window import Window, placed, union

Picture = npt.NDArray[np.float32]

# The values of a pixel outside a frame's data window; all other fields are 0 there.
NOTHING = {"depth": np.inf, "albedo": 1.0, "roughness": 1.0}


@dataclass(frozen=True, eq=False)
class Light:
    """A part of the picture that its file has as a pass.

    Parameters
    ----------
    channels : tuple of str
        Its red, green and blue channel.
    radiance : (H, W, 3) float32
        The values of the pass.
    factor : (H, W, 3) float32, optional
        The pass times this factor is a part of the picture; None stands for 1.
    factor_channels : tuple of str
        The channels of the factor.
    filtered : bool
        Whether it is noisy.
    reflects : bool
        Whether it is a reflection, as in a mirror, which contains the albedo of the reflected surface.
    """

    channels: tuple[str, ...]
    radiance: Picture
    factor: Picture | None = None
    factor_channels: tuple[str, ...] = ()
    filtered: bool = True
    reflects: bool = False


@dataclass(frozen=True, eq=False)
class ShotFrame:
    """One frame of a shot.

    Parameters
    ----------
    path : Path
    image : Image
        The content of its file.
    frame : Frame
        The frame on the window of the shot.
    lights : tuple of Light
        The parts whose sum is the picture, on the same window; empty if the file does not have them.
    """

    path: Path
    image: Image
    frame: Frame
    lights: tuple[Light, ...]


class Shot(Sequence[Frame]):
    """The frames of a shot, each read when it is asked for.

    Parameters
    ----------
    paths : sequence of Path
        One file for each frame, in order.
    how : ReadAs
        The user's options.
    separate : SeparateFiles
        Further files of each frame.

    Attributes
    ----------
    separate : SeparateFiles
        Further files of each frame.
    reading : Reading
        Turns files into frames.
    window : Window
        The smallest window with all pixels of the shot; outside its own data window a frame is empty.
    cuts : set of int
        Indices of the frames that follow a gap, so that their previous frame is missing.

    Raises
    ------
    FileError
        If the files do not fit on one picture, the first cannot be read with `how`, or a frame lacks a separate file.
    """

    def __init__(self, paths: Sequence[Path], how: ReadAs | None = None, separate: SeparateFiles | None = None) -> None:
        self.paths = tuple(paths)
        self.window = shared_window(self.paths)
        gaps = after_gaps(self.paths)
        self.cuts = {index for index, path in enumerate(self.paths) if path in gaps}
        self.separate = separate or SeparateFiles({})
        self.separate.require([number_of(path) for path in self.paths])
        first = read_image(self.paths[0])
        self.reading = Reading(self.paths[0], first, how or ReadAs(), self.separate.channels(number_of(self.paths[0])))
        given = self.reading.how.cameras
        self._cameras = ShotCameras(
            self.paths, self.camera_file or ({} if isinstance(given, Path) else given), first.windows.display
        )
        self._fields: set[str] | None = None

    @cached_property
    def camera_file(self) -> Path | None:
        """The file of cameras, if depth or motion is computed from them."""
        given = self.reading.how.cameras
        if not self._needs_cameras:
            return None
        return given if isinstance(given, Path) else None if given else cameras_beside(self.paths[0])

    @property
    def shape(self) -> Shape:
        """(height, width) of all frames."""
        return self.window.height, self.window.width

    def __len__(self) -> int:
        return len(self.paths)

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> list[Frame]: ...
    def __getitem__(self, index: int | slice) -> Frame | list[Frame]:
        if isinstance(index, slice):
            return [self.read(each).frame for each in range(*index.indices(len(self)))]
        return self.read(range(len(self))[index]).frame

    def read(self, index: int) -> ShotFrame:
        """Read a frame, and the content of its file.

        Raises
        ------
        FileError
            If its file is missing or damaged, lacks a field, has other fields than the first frame that was read, or
            has a field without any usable value.
        """
        path = self.paths[index]
        image = read_image(path)
        planes = {**image.planes, **self.separate.planes(number_of(path), image.windows.data)}
        frame = self.reading.frame(path, planes, *self._cameras_at(index, image.windows.data))
        self._check_fields(path, frame)
        check_usable(path, frame)
        own = image.windows.data
        lights = tuple(self._light(path, planes, light, own) for light in self.reading.lights)
        return ShotFrame(path, image, moved(frame, own, self.window), lights)

    def beginning(self) -> tuple[ShotFrame, ShotFrame]:
        """Return the first two frames, which represent the shot; the first one twice if there is no second."""
        first = self.read(0)
        try:
            return first, self.read(1) if len(self) > 1 else first
        except FileError:  # it is reported when the second frame is read in its turn
            return first, first

    def motion_to_next(self, source: ShotFrame) -> Picture | None:
        """Return the motion of a frame to the next one, (H, W, 2 or 3), from its file or the cameras, or None."""
        path, image = source.path, source.image
        if (motion := self.reading.motion_to_next(path, image.planes)) is not None:
            return placed(motion, image.windows.data, self.window, 0.0)
        if "motion" in self.reading.sources:
            return None
        camera, following = (self._cameras.at(number_of(path) + step, self.window) for step in (0, 1))
        if camera is None or following is None:
            return None
        return motion_from_cameras(camera, following, depth=source.frame.depth)

    def _cameras_at(self, index: int, window: Window) -> tuple[Camera | None, Camera | None]:
        """Return the cameras of a frame and of the previous one, if fields are computed from them."""
        if not self._needs_cameras:
            return None, None
        number = number_of(self.paths[index])
        return self._cameras.at(number, window), self._cameras.at(number - 1, window)

    @property
    def _needs_cameras(self) -> bool:
        """Whether files lack depth or motion, which cameras can give."""
        return not {"depth", "motion"} <= self.reading.sources.keys()

    def _light(self, path: Path, planes: Mapping[str, Plane], light: LightPass, own: Window) -> Light:
        """Return a light of a file, on the window of the shot."""
        radiance = placed(self.reading.radiance(path, planes, light), own, self.window, 0.0)
        factor = placed(stacked(path, planes, light.factor), own, self.window, 0.0) if light.factor else None
        return Light(light.channels, radiance, factor, light.factor, light.filtered, light.kind.reflects)

    def _check_fields(self, path: Path, frame: Frame) -> None:
        """Raise `FileError` if a frame has other fields than the first one that was read."""
        have = fields_of(frame)
        self._fields = self._fields or have
        changes = [f"without {name}" for name in sorted(self._fields - have)]
        changes += [f"with {name}" for name in sorted(have - self._fields)]
        if changes:
            raise FileError(f"{path}: expected the fields of {self.paths[0]}, got a frame {', '.join(changes)}")


def open_sequence(
    frames: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    *,
    allow_gaps: bool = False,
    separate: Mapping[str, str | os.PathLike[str]] | None = None,
    **how: Any,
) -> Shot:
    """Open the frames of a shot that a renderer wrote: EXR files of Blender, Mitsuba, pbrt, Arnold, V-Ray, or our own.

    Parameters
    ----------
    frames : path, or iterable of paths
        Files, their folder, or a pattern of their names: ``"shot/####.exr"``, ``"shot/%04d.exr"``, ``"shot/*.exr"``.
    allow_gaps : bool
        Whether frames may be missing; `Shot.cuts` has the frames after a gap.
    separate : mapping of str to path, optional
        Patterns of files for fields that the files of `frames` lack, such as ``{"depth": "depth.####.exr"}``.
    **how
        The parameters of `ReadAs`: ``format``, ``view_layer``, ``passes``, ``motion_scale``, ``cameras``,
        ``still_camera``.

    Returns
    -------
    Shot
        A sequence of `Frame`, each read when it is asked for.

    Raises
    ------
    FileError
        If files are missing, damaged or belong to several shots, or the first lacks a field.
    SvgfError
        If one of `how` is wrong.

    Examples
    --------
    >>> frames = open_sequence("shot/####.exr")
    >>> with Denoiser(frames.shape) as den:
    ...     pictures = [den.denoise(frame) for frame in frames]
    """
    given = [frames] if isinstance(frames, str | os.PathLike) else frames
    files = find_frames([Path(each) for each in given], allow_gaps=allow_gaps)
    others = SeparateFiles.of({field: Path(pattern) for field, pattern in (separate or {}).items()})
    return Shot(files, ReadAs(**how), others)


def shared_window(paths: Sequence[Path]) -> Window:
    """Return the window of all pixels of these files; raise `FileError` if they do not fit on one picture."""
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
            f"{far}: expected a data window near {first.data}, that of {paths[0]}, got {windows[far].data}; a window"
            " around both has too many pixels"
        )
    return window


def moved(frame: Frame, have: Window, want: Window) -> Frame:
    """Return the frame on another window; pixels that it did not have are empty."""
    fields = {name: placed(value, have, want, NOTHING.get(name, 0.0)) for name, value in frame.present().items()}
    return Frame(**fields)


def fields_of(frame: Frame) -> set[str]:
    """Return the names of the fields that are there, and "motion.Z" if motion has three components."""
    return {*frame.present(), *(["motion.Z"] if frame.motion.shape[-1] == 3 else [])}


def check_usable(path: Path, frame: Frame) -> None:
    """Raise `FileError` if a whole field is NaN or infinite (depth may be infinite: an empty sky)."""
    for field, value in frame.present().items():
        usable = ~np.isnan(value) if field == "depth" else np.isfinite(value)
        if not usable.any():
            raise FileError(f"{path}: expected finite values in {field}, got none in the whole frame")

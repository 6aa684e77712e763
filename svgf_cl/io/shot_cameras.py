"""`ShotCameras`: the camera of each frame of a shot, from a file, from the user, or from the frames' headers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path

from svgf_cl.camera import Camera
from svgf_cl.errors import ArgumentError, FileError
from svgf_cl.io.cameras import camera_of_header, read_cameras
from svgf_cl.io.exr import read_attributes
from svgf_cl.io.sequence import number_of
from svgf_cl.io.window import Window


class ShotCameras:
    """The cameras of a shot: those that are given, else those in the headers of its files.

    Parameters
    ----------
    paths : sequence of Path
        One file for each frame.
    given : Path, or mapping of int to Camera
        A file of cameras, or the cameras by the numbers of their frames.
    display : Window
        The display window of the files.
    """

    def __init__(self, paths: Sequence[Path], given: Path | Mapping[int, Camera], display: Window) -> None:
        self._display, self._source = display, given
        self._paths = {number_of(path): path for path in paths}
        self._found: dict[int, Camera | None] = {}

    def at(self, number: int, window: Window) -> Camera | None:
        """Return the camera of the frame with this number; its pixels count from the corner of `window`.

        Raises
        ------
        FileError
            If the file of cameras or the frame's header cannot be read, or has an invalid camera.
        """
        if number not in self._found:
            self._found[number] = self._given.get(number) or self._in_header(number)
        camera = self._found[number]
        return camera and camera.cropped(window.x - self._display.x, window.y - self._display.y)

    @cached_property
    def _given(self) -> Mapping[int, Camera]:
        return read_cameras(self._source, self._shape) if isinstance(self._source, Path) else self._source

    @property
    def _shape(self) -> tuple[int, int]:
        return self._display.height, self._display.width

    def _in_header(self, number: int) -> Camera | None:
        """Return the camera in the header of a frame's file, if there is one."""
        if number not in self._paths:
            return None
        path = self._paths[number]
        try:
            return camera_of_header(read_attributes(path), self._shape)
        except ArgumentError as error:
            raise FileError(f"{path}: {error}; give the camera in cameras.json or with --cameras FILE") from error

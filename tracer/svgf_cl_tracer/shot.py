"""A shot: a scene seen along a camera path, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .camera import Camera, CameraPath, CarriedCamera, vector
from .errors import SceneError
from .fingerprint import fingerprint, tracer_version
from .scene import Scene
from .vec3 import Vec3

Shape = tuple[int, int]

# The share of a detail's size by which the origin stays behind the camera. Single precision, with a relative error of
# 2^-24, then misplaces objects by a ten-thousandth of that size.
STEP = 1000.0


@dataclass(frozen=True, eq=False)
class Shot:
    """A sequence of frames: what they show, and when.

    The camera covers its whole path, for any number of frames. The time of objects, lamps and carried cameras is in
    seconds.

    Parameters
    ----------
    scene : Scene
    shape : (height, width)
        Size of a frame in pixels, >= 1 each.
    frames : int
        Length of the sequence, >= 1.
    camera_path : CameraPath or CarriedCamera, optional
        By default the path of the scene.
    fps : float
        Frames per second, > 0.

    Raises
    ------
    SceneError
        If a number is out of its range.
    """

    scene: Scene
    shape: Shape
    frames: int = 1
    camera_path: CameraPath | CarriedCamera | None = None
    fps: float = 24.0

    def __post_init__(self) -> None:
        if min(self.shape) < 1:
            raise SceneError(f"shape: expected a height and a width of at least 1, got {self.shape}")
        if self.frames < 1:
            raise SceneError(f"frames: expected at least 1, got {self.frames}")
        if not 0.0 < self.fps < float("inf"):
            raise SceneError(f"fps: expected a number above 0, got {self.fps}")

    @cached_property
    def identity(self) -> str:
        """Hash of everything on which its frames depend: scene, camera, size, length, and the version of the tracer."""
        scene = self.scene
        seen = (scene.instances, scene.lights, scene.sky, self.camera_path or scene.camera_path)
        return fingerprint([seen, self.shape, self.frames, self.fps, tracer_version()])

    def camera(self, number: float) -> Camera:
        """The camera of frame `number`, from 0; the camera of frame 3.5 is halfway to that of frame 4."""
        path = self.camera_path or self.scene.camera_path
        if isinstance(path, CarriedCamera):
            return path.at_time(self.time(number))
        return path.at_frame(number, self.frames)

    def origin(self, number: int) -> Vec3:
        """The origin of positions in frame `number`: the scene's point nearest to the camera, or a point near that.

        It follows the camera in large steps, because the scene's trees are built anew for each new origin.
        """
        first, here = (self.scene.nearest(self.camera(at).position, self.time(at)) for at in (0, number))
        if (first == here).all():
            return vector(first)
        step = STEP * self.scene.detail
        return vector(first + step * np.round((here - first) / step) if step > 0.0 else here)

    def time(self, number: float) -> float:
        """The time of frame `number` in seconds."""
        return number / self.fps

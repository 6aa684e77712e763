"""A shot: a scene seen along a camera path, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from .camera import Camera, CameraPath
from .errors import SceneError
from .fingerprint import fingerprint, tracer_version
from .scene import Scene

Shape = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Shot:
    """What the frames of a sequence show.

    The camera covers the whole of its path, however many frames there are; objects and lamps keep the time of a clock.

    Parameters
    ----------
    scene : Scene
    shape : (height, width)
        Size of a frame in pixels, >= 1 each.
    frames : int
        Length of the sequence, >= 1.
    camera_path : CameraPath, optional
        The scene's own where absent.
    fps : float
        Frames per second, > 0.

    Raises
    ------
    SceneError
        A number is out of its range.
    """

    scene: Scene
    shape: Shape
    frames: int = 1
    camera_path: CameraPath | None = None
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
        """Fingerprint of all that its frames depend on: scene, camera, size, length, and the tracer's own version."""
        scene = self.scene
        seen = (scene.instances, scene.lights, scene.sky, self.camera_path or scene.camera_path)
        return fingerprint([seen, self.shape, self.frames, self.fps, tracer_version()])

    def camera(self, number: float) -> Camera:
        """The camera of frame `number`, from 0; the one of frame 3.5 is halfway to the next."""
        path = self.camera_path or self.scene.camera_path
        return path.at_frame(number, self.frames)

    def time(self, number: float) -> float:
        """The time of frame `number` in seconds."""
        return number / self.fps

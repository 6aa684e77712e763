"""The camera, its path through the scene, its rays, and its projection."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from .compiled import compiled
from .errors import SceneError
from .motion import Motion
from .sampling import on_circle
from .vec3 import Vec3, add, dot, normalise, scale, subtract
from .vectors import Float64

Vector = Vec3

# The image position of a point that was behind the previous camera: far outside any image.
OUTSIDE = 1e6


@dataclass(frozen=True)
class Camera:
    """A pinhole camera, one with a thin lens, or an orthographic one.

    Parameters
    ----------
    position, look_at : (x, y, z)
        The eye, and the point in the middle of the image, in scene units.
    up : (x, y, z)
        The direction that is up in the image; it may have any length, but must not be parallel to the view.
    fov_y : float
        Vertical field of view in degrees, 0 < fov_y < 180.
    aperture : float
        Diameter of the lens in scene units, >= 0; at 0 everything is sharp. The plane through `look_at` is in focus.
    shutter : float
        The share of the time between two frames during which the shutter is open, 0..1; at 0 moving objects are sharp.
    view_height : float
        The height of the part of the scene that an orthographic camera shows, in scene units, >= 0. Its rays are
        parallel. At 0 the camera is in perspective and uses `fov_y`.

    Raises
    ------
    SceneError
        If the view direction, `up` or `fov_y` span no image, or an orthographic camera has a lens.
    """

    position: Vector
    look_at: Vector
    up: Vector = (0.0, 1.0, 0.0)
    fov_y: float = 45.0
    aperture: float = 0.0
    shutter: float = 0.0
    view_height: float = 0.0

    def __post_init__(self) -> None:
        numbers = (*self.position, *self.look_at, *self.up, self.fov_y)
        if not all(map(math.isfinite, numbers)) or not 0.0 < self.fov_y < 180.0:
            raise SceneError(f"camera: expected finite numbers and a field of view in (0, 180) degrees, got {self}")
        view = np.subtract(self.look_at, self.position)
        if np.linalg.norm(np.cross(view, self.up)) <= 1e-9 * np.linalg.norm(view) * np.linalg.norm(self.up):
            raise SceneError(f"camera: expected a point to look at that is not along the up direction, got {self}")
        if not (0.0 <= self.aperture < math.inf and 0.0 <= self.shutter <= 1.0):
            raise SceneError(f"camera: expected an aperture >= 0 and a shutter in 0..1, got {self}")
        if not 0.0 <= self.view_height < math.inf or self.view_height * self.aperture > 0.0:
            raise SceneError(f"camera: expected a view_height >= 0, and beside one above 0 no aperture, got {self}")

    @classmethod
    def parse(cls, text: str) -> Camera:
        """Read a camera from ``px,py,pz/lx,ly,lz[/fov[/ux,uy,uz]]``: position, point looked at, degrees, up.

        Raises
        ------
        SceneError
            If `text` has another form.
        """
        try:
            parts = [tuple(float(number) for number in part.split(",")) for part in text.split("/")]
        except ValueError:
            parts = []
        if [len(part) for part in parts] not in ([3, 3], [3, 3, 1], [3, 3, 1, 3]):
            raise SceneError(f"camera: expected 'px,py,pz/lx,ly,lz/fov' with optional '/ux,uy,uz', got {text!r}")
        position, look_at, *rest = parts
        fov_y = rest[0][0] if rest else cls.fov_y
        up = rest[1] if len(rest) == 2 else cls.up
        return cls(vector(position), vector(look_at), vector(up), fov_y)

    def relative_to(self, origin: Vector) -> Camera:
        """The same camera with positions relative to `origin`."""
        position, look_at = np.subtract(self.position, origin), np.subtract(self.look_at, origin)
        return replace(self, position=vector(position), look_at=vector(look_at))

    def basis(self) -> Float64:
        """Rows right, up, forward: an orthonormal (3, 3) matrix from world directions to camera directions."""
        forward = np.subtract(self.look_at, self.position)
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, self.up)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, forward), forward])

    def lens(self, shape: tuple[int, int], clearance: float = 0.0) -> Lens:
        """The data for compiled loops, for an image of (height, width); no surface is nearer than `clearance`."""
        height, width = shape
        right, up, forward = (vector(axis) for axis in self.basis())
        focus = math.dist(self.position, self.look_at)
        scale = height / (self.view_height or 2.0 * math.tan(math.radians(self.fov_y) / 2.0))
        middle = (width - 1) / 2.0, (height - 1) / 2.0
        start = max(clearance - self.aperture, 0.0)
        eye, radius, parallel = vector(self.position), self.aperture / 2.0, self.view_height > 0.0
        return Lens(eye, right, up, forward, scale, *middle, radius, focus, start, parallel)


class Lens(NamedTuple):
    """A camera and its image: axes, pixels per unit at distance 1, the image's middle, the lens' radius and focus.

    Rays begin at the distance `start`, because the error in single precision is smaller for shorter rays. The rays of
    an orthographic camera are `parallel`, and begin in its plane.
    """

    position: Vec3
    right: Vec3
    up: Vec3
    forward: Vec3
    scale: float
    middle_x: float
    middle_y: float
    radius: float
    focus: float
    start: float
    parallel: bool


@compiled
def ray_through(lens: Lens, x: float, y: float, u: float, v: float) -> tuple[Vec3, Vec3]:
    """Origin and unit direction of the ray through the image position (x, y); pixel centres are at whole numbers.

    `u` and `v`, uniform in [0, 1), choose the point on the lens.
    """
    across, above = (x - lens.middle_x) / lens.scale, (lens.middle_y - y) / lens.scale
    aside = add(scale(lens.right, across), scale(lens.up, above))
    if lens.parallel:
        return add(lens.position, aside), lens.forward
    way = add(aside, lens.forward)
    if lens.radius == 0.0:
        direction = normalise(way)
        return add(lens.position, scale(direction, lens.start)), direction
    radius, (cosine, sine) = lens.radius * math.sqrt(u), on_circle(v)
    offset = add(scale(lens.right, radius * cosine), scale(lens.up, radius * sine))
    direction = normalise(subtract(scale(way, lens.focus), offset))
    return add(lens.position, add(offset, scale(direction, lens.start))), direction


@compiled
def project(lens: Lens, offset: Vec3) -> Vec3:
    """Image position and depth (x, y, depth) of a point relative to the eye, or of a direction.

    The position of points at or behind the eye's plane is `OUTSIDE`.
    """
    depth = dot(offset, lens.forward)
    if depth <= 0.0:
        return OUTSIDE, OUTSIDE, depth
    pixels = lens.scale if lens.parallel else lens.scale / depth
    x = dot(offset, lens.right) * pixels + lens.middle_x
    y = lens.middle_y - dot(offset, lens.up) * pixels
    return x, y, depth


@dataclass(frozen=True)
class CameraPath:
    """A camera that moves through keyframes at equal times, along a Catmull-Rom spline.

    The spline passes through every keyframe with continuous velocity; with two keyframes it is a straight line.

    Parameters
    ----------
    keyframes : tuple of Camera
        At least one.
    """

    keyframes: tuple[Camera, ...]

    def __post_init__(self) -> None:
        if not self.keyframes:
            raise SceneError("camera path: expected at least one camera, got none")
        if len({camera.view_height > 0.0 for camera in self.keyframes}) == 2:
            raise SceneError("camera path: expected cameras in perspective or orthographic ones, got both")

    @classmethod
    def static(cls, camera: Camera) -> CameraPath:
        """A camera that stands still."""
        return cls((camera,))

    @classmethod
    def through(cls, cameras: Sequence[Camera]) -> CameraPath:
        """A path through `cameras`, in their order."""
        return cls(tuple(cameras))

    def at(self, t: float) -> Camera:
        """The camera at time `t`, from 0 (first keyframe) to 1 (last)."""
        if len(self.keyframes) == 1:
            return self.keyframes[0]
        keys = np.array(
            [(*k.position, *k.look_at, *k.up, k.fov_y, k.aperture, k.shutter, k.view_height) for k in self.keyframes]
        )
        segment, s = divmod(min(max(t, 0.0), 1.0) * (len(keys) - 1), 1.0)
        if segment == len(keys) - 1:
            segment, s = segment - 1, 1.0
        # Each end gets one more keyframe, in line with the last two, so that the spline reaches the ends.
        padded = np.concatenate([[2 * keys[0] - keys[1]], keys, [2 * keys[-1] - keys[-2]]])
        values = _catmull_rom(padded[int(segment) : int(segment) + 4], s)
        # The spline may overshoot its keyframes slightly.
        fov_y, aperture, shutter, view_height = values[9:].tolist()
        lens = fov_y, max(aperture, 0.0), min(max(shutter, 0.0), 1.0), max(view_height, 0.0)
        return Camera(vector(values[0:3]), vector(values[3:6]), vector(values[6:9]), *lens)

    def at_frame(self, number: float, frames: int) -> Camera:
        """The camera of frame `number`, from 0, in a sequence of `frames` frames that covers the whole path."""
        return self.at(number / max(frames - 1, 1))


@dataclass(frozen=True, eq=False)
class CarriedCamera:
    """A camera that a node carries through the world; its time is in seconds, for any length of the sequence.

    Parameters
    ----------
    camera : Camera
        In the space of the node that carries it.
    motion : Motion
        From that space into the world. Its scale moves the camera, and has no other effect on it.
    """

    camera: Camera
    motion: Motion

    def at_time(self, time: float) -> Camera:
        """The camera in the world at `time` in seconds."""
        matrix, turn = self.motion.matrix(time), self.motion.turn(time)
        position = matrix[:3, :3] @ self.camera.position + matrix[:3, 3]
        look_at = position + turn @ np.subtract(self.camera.look_at, self.camera.position)
        return replace(
            self.camera, position=vector(position), look_at=vector(look_at), up=vector(turn @ self.camera.up)
        )


def _catmull_rom(points: Float64, s: float) -> Float64:
    """The spline between the middle two of four `points` (4, K), at `s` in 0..1."""
    weights = 0.5 * np.array(
        [
            -s + 2 * s**2 - s**3,
            2 - 5 * s**2 + 3 * s**3,
            s + 4 * s**2 - 3 * s**3,
            -(s**2) + s**3,
        ]
    )
    spline: Float64 = weights @ points
    return spline


def vector(values: Iterable[float]) -> Vector:
    """Three numbers as a tuple of floats."""
    x, y, z = values
    return float(x), float(y), float(z)

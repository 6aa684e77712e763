"""`Camera`, and the motion of static geometry between the cameras of two frames.

Everything is computed in double precision, because a camera may be far from the origin, and a motion is a small
difference of two positions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from svgf_cl.errors import ArgumentError, shown
from svgf_cl.matrices import Array, inverse, projection_of, rigid

FovAxis = Literal["x", "y", "smaller", "larger"]
Axes = Literal["opencv", "opengl", "mitsuba", "renderman"]

# The directions of x, y and z in a camera's own space: 1 for right, down and forward, -1 for the opposite.
AXES: dict[str, tuple[int, int, int]] = {
    "opencv": (1, 1, 1),
    "opengl": (1, -1, -1),  # Blender, glTF and USD too
    "mitsuba": (-1, -1, 1),
    "renderman": (1, -1, 1),  # pbrt and OpenEXR's header too
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Camera:
    """A pinhole or an orthographic camera, which maps points of the world to pixels.

    Its view axes are x to the right, y down, and z forward, which is the depth of docs/conventions.md. The point
    (x, y, z) in view space is seen at ``(focal[0] * x / z + center[0], focal[1] * y / z + center[1])``; an orthographic
    camera does not divide by z. Pixel centres are at whole coordinates, with (0, 0) in the upper left pixel. Pixels
    count in the whole image, which is the display window of an OpenEXR file, wherever its data window is.

    Parameters
    ----------
    world_to_view : (4, 4) array
        A rotation and a translation, with or without a reflection, from columns (x, y, z, 1) of world space to view
        space.
    focal : (float, float)
        Focal length in pixels, along x and y, > 0. For an orthographic camera: pixels per scene unit.
    center : (float, float)
        The point where the optical axis meets the image, in pixels from the centre of the upper left pixel.
    orthographic : bool
        Whether all rays are parallel.

    Raises
    ------
    ArgumentError
        If `world_to_view` scales, shears or has numbers that are not finite, or `focal` or `center` is out of range.
    """

    world_to_view: Array
    focal: tuple[float, float]
    center: tuple[float, float]
    orthographic: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "world_to_view", rigid("Camera(world_to_view)", self.world_to_view))
        for name, expected, lowest in (("focal", "> 0", 0.0), ("center", "that are finite", -math.inf)):
            pair = np.asarray(getattr(self, name), np.float64)
            if pair.shape != (2,) or not np.all((pair > lowest) & (pair < math.inf)):
                raise ArgumentError(f"Camera({name})", f"two numbers {expected}", shown(getattr(self, name)))
            object.__setattr__(self, name, (float(pair[0]), float(pair[1])))

    @classmethod
    def from_fov(
        cls,
        camera_to_world: npt.ArrayLike,
        fov_degrees: float,
        shape: tuple[int, int],
        fov_axis: FovAxis = "x",
        axes: Axes = "opengl",
    ) -> Camera:
        """Make a perspective camera with square pixels from its position in the world and its field of view.

        Parameters
        ----------
        camera_to_world : (4, 4) array
            The matrix from columns (x, y, z, 1) of the camera's space to world space, without scale.
        fov_degrees : float
            The angle between the image's opposite edges, 0 < `fov_degrees` < 180.
        shape : (int, int)
            (height, width) of the image in pixels.
        fov_axis : {"x", "y", "smaller", "larger"}
            The side of the image along which the field of view is measured.
        axes : {"opengl", "mitsuba", "renderman", "opencv"}
            The directions of the camera's x, y and z in the image: right, up, backward (OpenGL, Blender, glTF, USD);
            left, up, forward (Mitsuba); right, up, forward (RenderMan, pbrt); right, down, forward (OpenCV).

        Raises
        ------
        ArgumentError
            If an argument is out of range.
        """
        height, width = _checked_shape("Camera.from_fov(shape)", shape)
        sides = {"x": width, "y": height, "smaller": min(shape), "larger": max(shape)}
        if fov_axis not in tuple(sides):
            raise ArgumentError("Camera.from_fov(fov_axis)", f"one of {', '.join(sides)}", shown(fov_axis))
        if not 0.0 < fov_degrees < 180.0:
            raise ArgumentError("Camera.from_fov(fov_degrees)", "an angle in (0, 180) degrees", shown(fov_degrees))
        world_to_camera = inverse(rigid("Camera.from_fov(camera_to_world)", camera_to_world))
        focal = sides[fov_axis] / (2.0 * math.tan(math.radians(fov_degrees) / 2.0))
        return cls(
            world_to_view=view_axes("Camera.from_fov(axes)", axes) @ world_to_camera,
            focal=(focal, focal),
            center=((width - 1) / 2.0, (height - 1) / 2.0),
        )

    @classmethod
    def from_matrices(
        cls, world_to_camera: npt.ArrayLike, world_to_ndc: npt.ArrayLike, shape: tuple[int, int]
    ) -> Camera:
        """Make a camera from the attributes ``worldToCamera`` and ``worldToNDC`` of an OpenEXR file.

        The matrices are as in the file: a row (x, y, z, 1) of world space times a matrix gives a point in the camera's
        space, or in normalised device coordinates (NDC) before the division by w. By OpenEXR's definition the camera's
        x points to the right, y up and z forward, and NDC go from (0, 0) in the upper left corner of the display window
        to (1, 1). Renderers use other conventions, too, which this method recognises by the numbers:

        - NDC go from -1 to 1 if the optical axis is nearer to their (0, 0) than to (0.5, 0.5) (Arnold, RenderMan,
          Mantra). Their x and y may point in either direction.
        - NDC from 0 to 1 that have the same unit along both sides of an image that is not square span the smaller side
          (pbrt).
        - Matrices may be transposed (pbrt).
        - A camera looks along -z if w is positive there and its matrix does not mirror (OpenGL's). If it does mirror,
          the camera looks along z, and w is negative in front of it (Mantra).

        Parameters
        ----------
        world_to_camera, world_to_ndc : (4, 4) array
        shape : (int, int)
            (height, width) of the display window in pixels.

        Raises
        ------
        ArgumentError
            If the matrices do not belong to one perspective or orthographic camera, or its optical axis is too far
            from the middle of the image to find the range of NDC.

        Notes
        -----
        Headers have single precision: the position of a camera at 5e5 is exact to some hundredths of a unit.

        References
        ----------
        https://openexr.com/en/latest/StandardAttributes.html#position-and-orientation
        """
        _checked_shape("Camera.from_matrices(shape)", shape)
        return cls(**projection_of(world_to_camera, world_to_ndc, shape)._asdict())

    def cropped(self, x: int, y: int) -> Camera:
        """Return the camera for a part of its image, whose upper left pixel is (`x`, `y`) of the whole image."""
        return replace(self, center=(self.center[0] - x, self.center[1] - y))

    def to_view(self, points: npt.ArrayLike) -> Array:
        """Transform points (..., 3) from world space to view space."""
        view: Array = np.asarray(points, np.float64) @ self.world_to_view[:3, :3].T + self.world_to_view[:3, 3]
        return view

    def to_world(self, view: npt.ArrayLike) -> Array:
        """Transform points (..., 3) from view space to world space."""
        view_to_world = inverse(self.world_to_view)
        points: Array = np.asarray(view, np.float64) @ view_to_world[:3, :3].T + view_to_world[:3, 3]
        return points

    def project(self, points: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the pixels (..., 2) (x, y) and the depth (...) of points (..., 3) of the world.

        Pixels are NaN where the depth is not above 0, because the point is behind the camera.
        """
        view = self.to_view(points)
        return self._pixels(view), view[..., 2]

    def unproject(self, depth: npt.ArrayLike) -> Array:
        """Return the points (H, W, 3) of the world with a depth (H, W) at pixel centres; NaN where it is not finite."""
        depth = np.asarray(depth, np.float64)
        depth = np.where(np.isfinite(depth), depth, math.nan)[..., None]
        rays = self.rays((depth.shape[0], depth.shape[1]))
        return self.to_world(np.concatenate([rays[..., :2] * (1.0 if self.orthographic else depth), depth], axis=-1))

    def depth_at(self, points: npt.ArrayLike) -> Array:
        """Return the depth (...) of points (..., 3) of the world."""
        return self.to_view(points)[..., 2]

    def depth_of(self, distance: npt.ArrayLike) -> Array:
        """Return the depths (H, W) for distances (H, W) along the rays through pixel centres."""
        distance = np.asarray(distance, np.float64)
        if self.orthographic:
            return distance
        rays = self.rays((distance.shape[0], distance.shape[1]))
        depth: Array = distance / np.linalg.norm(rays, axis=-1)
        return depth

    def rays(self, shape: tuple[int, int]) -> Array:
        """Return the points (H, W, 3) of view space with depth 1 at the pixel centres of a (height, width) image."""
        y, x = np.indices(shape, np.float64)
        (focal_x, focal_y), (center_x, center_y) = self.focal, self.center
        return np.stack([(x - center_x) / focal_x, (y - center_y) / focal_y, np.ones(shape)], axis=-1)

    def _pixels(self, view: Array) -> Array:
        """Return the pixels (..., 2) of points (..., 3) of view space; NaN behind the camera."""
        depth = np.where(view[..., 2:] > 0.0, view[..., 2:], math.nan)
        pixels: Array = view[..., :2] * self.focal / (np.sign(depth) if self.orthographic else depth) + self.center
        return pixels


def motion_from_cameras(
    camera: Camera, previous: Camera, *, depth: npt.ArrayLike | None = None, position: npt.ArrayLike | None = None
) -> npt.NDArray[np.float32]:
    """Compute the motion of static geometry from the cameras of this frame and the previous one.

    For the motion to the next frame, give the camera of the next frame as `previous`.

    Parameters
    ----------
    camera, previous : Camera
        The cameras of this frame and of the previous one, without sub-pixel jitter.
    depth : (H, W) array, optional
        Depth along the camera's axis, at pixel centres. Where it is not finite or not above 0, nothing was hit.
    position : (H, W, 3) array, optional
        World-space positions, anywhere in their pixels: the jitter of a frame is not in its motion. Where one is not
        finite, nothing was hit. If `depth` is also given, it only says where nothing was hit.

    Returns
    -------
    (H, W, 3) float32
        Previous minus current position in pixels, x and y, and previous minus current depth. Where nothing was hit, it
        is the motion of a point infinitely far away: the motion by the rotation only, and 0 in the third component; all
        0 for an orthographic camera. It is NaN, which means no history, where the point was behind the previous camera.

    Raises
    ------
    ArgumentError
        If neither `depth` nor `position` is given, or one has another shape.

    Examples
    --------
    >>> camera = Camera.from_fov(camera_to_world, 40.0, depth.shape, "y", "opengl")
    >>> previous = Camera.from_fov(previous_camera_to_world, 40.0, depth.shape, "y", "opengl")
    >>> motion = motion_from_cameras(camera, previous, depth=depth)
    >>> frame = Frame(color=color, normal=normal, depth=depth, motion=motion)
    """
    if position is not None:
        points = _image("position", position, (3,))
        points = np.where(np.isfinite(points), points, math.nan)
    elif depth is not None:
        points = camera.unproject(_image("depth", depth, ()))
    else:
        raise ArgumentError("motion_from_cameras(depth)", "an array, unless position is one", "nothing")
    missed = np.isnan(points.sum(axis=-1))
    if depth is not None:
        plane = _image("depth", depth, (), points.shape[:2])
        missed |= ~(np.isfinite(plane) & (plane > 0.0))
    now, depth_now = camera.project(points)
    then, depth_then = previous.project(points)
    motion = np.concatenate([then - now, (depth_then - depth_now)[..., None]], axis=-1)
    motion[np.isnan(motion.sum(axis=-1))] = math.nan
    if missed.any():
        motion[missed] = _motion_at_infinity(camera, previous, camera.rays(missed.shape)[missed])
    return motion.astype(np.float32)


def _motion_at_infinity(camera: Camera, previous: Camera, rays: Array) -> Array:
    """Return the motion (N, 3) of points infinitely far away along `rays` (N, 3) of the camera's view space."""
    if camera.orthographic or previous.orthographic:  # all rays are parallel: the background has no position
        return np.zeros_like(rays)
    rotation = previous.world_to_view[:3, :3] @ np.linalg.inv(camera.world_to_view[:3, :3])
    motion = previous._pixels(rays @ rotation.T) - camera._pixels(rays)
    return np.concatenate([motion, 0.0 * motion[:, :1]], axis=-1)  # NaN stays NaN


def view_axes(argument: str, axes: str) -> Array:
    """Return the (4, 4) matrix to view space from a camera's space whose `axes` have this name."""
    if axes not in tuple(AXES):
        raise ArgumentError(argument, f"one of {', '.join(AXES)}", shown(axes))
    return np.diag((*AXES[axes], 1.0))


def _image(name: str, value: npt.ArrayLike, rest: tuple[int, ...], shape: tuple[int, ...] | None = None) -> Array:
    """Return an argument of `motion_from_cameras` as an array of shape (H, W, *rest), or (*shape, *rest) if given."""
    array = np.asarray(value, np.float64)
    fits = array.ndim == 2 + len(rest) and array.shape[2:] == rest and shape in (None, array.shape[:2])
    if not fits:
        expected = ", ".join(map(str, (*(shape or ("H", "W")), *rest)))
        raise ArgumentError(f"motion_from_cameras({name})", f"shape ({expected})", f"shape {array.shape}")
    return array


def _checked_shape(argument: str, shape: tuple[int, int]) -> tuple[int, int]:
    """Return (height, width); raise `ArgumentError` unless both are there and above 0."""
    if len(shape) != 2 or min(shape) < 1:
        raise ArgumentError(argument, "(height, width) in pixels", shown(shape))
    return shape

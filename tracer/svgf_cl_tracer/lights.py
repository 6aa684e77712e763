"""Lights without triangles: suns, point lights and spot lights."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .errors import SceneError
from .materials import Colour
from .motion import Motion
from .vec3 import Vec3
from .vectors import Float64


@dataclass(frozen=True, eq=False)
class Sun:
    """A disc of light at infinity, or a direction without extent (glTF's directional light).

    Parameters
    ----------
    direction_to_light : (x, y, z)
        From the scene towards the middle of the disc; any length.
    irradiance : (r, g, b)
        Irradiance on a plane that faces the light, linear, >= 0.
    angular_radius : float
        Half of the angle under which it is seen, in degrees, 0 <= angular_radius < 90. At 0 it is not visible, neither
        to the camera nor in a mirror.
    motion : Motion, optional
        Turns the direction.

    Raises
    ------
    SceneError
        If a number is not finite or is out of its range.
    """

    direction_to_light: Colour
    irradiance: Colour
    angular_radius: float = 0.25
    motion: Motion | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.direction_to_light).all() and np.any(self.direction_to_light)):
            raise SceneError(f"sun: expected a direction of a length above 0, got {self.direction_to_light}")
        if not (np.isfinite(self.irradiance).all() and min(self.irradiance) >= 0.0):
            raise SceneError(f"sun: expected an irradiance >= 0, got {self.irradiance}")
        if not 0.0 <= self.angular_radius < 90.0:
            raise SceneError(f"sun: expected an angular radius in degrees in [0, 90), got {self.angular_radius}")

    def relative_to(self, origin: Vec3) -> Sun:
        """The same sun, because it is infinitely far away."""
        return self

    def direction_at(self, time: float) -> Float64:
        """The unit vector (3,) towards the middle of the disc, at `time` in seconds."""
        direction = np.array(self.direction_to_light, np.float64)
        return _unit(direction if self.motion is None else self.motion.turn(time) @ direction)


@dataclass(frozen=True, eq=False)
class PointLight:
    """A light without extent that shines in all directions or within a cone (glTF's point and spot lights).

    Parameters
    ----------
    position : (x, y, z)
    intensity : (r, g, b)
        Power per solid angle, linear, >= 0: irradiance at distance 1.
    direction : (x, y, z)
        The cone's axis, away from the light; any length.
    inner_angle, outer_angle : float
        Degrees from the axis at which the light begins to fade, and at which it ends; 180 without a cone. In between it
        falls as KHR_lights_punctual defines.
    reach : float
        Distance at which the light has faded to nothing (glTF's range).
    motion : Motion, optional
        Moves position and direction.

    Raises
    ------
    SceneError
        If a number is not finite or is out of its range.
    """

    position: Colour
    intensity: Colour
    direction: Colour = (0.0, 0.0, -1.0)
    inner_angle: float = 180.0
    outer_angle: float = 180.0
    reach: float = np.inf
    motion: Motion | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite([*self.position, *self.direction]).all() and np.any(self.direction)):
            raise SceneError(f"light: expected finite position and direction, got {self.position}, {self.direction}")
        if not (np.isfinite(self.intensity).all() and min(self.intensity) >= 0.0):
            raise SceneError(f"light: expected an intensity >= 0, got {self.intensity}")
        if not 0.0 <= self.inner_angle <= self.outer_angle <= 180.0:
            raise SceneError(
                f"light: expected 0 <= inner <= outer angle <= 180 degrees, got {self.inner_angle}, {self.outer_angle}"
            )
        if not self.reach > 0.0:
            raise SceneError(f"light: expected a reach above 0, got {self.reach}")

    def relative_to(self, origin: Vec3) -> PointLight:
        """The same light with positions relative to `origin`."""
        if self.motion is None:
            x, y, z = np.subtract(self.position, origin).tolist()
            return replace(self, position=(x, y, z))
        return replace(self, motion=self.motion.relative_to(origin))

    def placed(self, time: float) -> tuple[Float64, Float64]:
        """Position (3,) and unit direction (3,) in the world, at `time` in seconds."""
        position, direction = np.array(self.position, np.float64), np.array(self.direction, np.float64)
        if self.motion is not None:
            matrix = self.motion.matrix(time)
            position, direction = matrix[:3, :3] @ position + matrix[:3, 3], self.motion.turn(time) @ direction
        return position, _unit(direction)


def _unit(direction: Float64) -> Float64:
    unit: Float64 = direction / np.linalg.norm(direction)
    return unit

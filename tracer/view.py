"""What a camera sees through a batch of image positions: the first hits, and the features a denoiser asks for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .geometry import Hits, Surface
from .integrator import reflected_light
from .scene import Scene
from .vectors import Float32, Float64

Shape = tuple[int, int]


@dataclass(frozen=True, eq=False)
class View:
    """First hits of the rays through N image positions.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    shape : (height, width)
    directions : (3, N) float64
        World directions of the rays.
    hits : Hits
        K of the N rays.
    surface : Surface
        What those K rays met.
    albedo : (3, K) float32
        Its reflectance.
    """

    scene: Scene
    camera: Camera
    shape: Shape
    directions: Float64
    hits: Hits
    surface: Surface
    albedo: Float32

    @classmethod
    def through(cls, scene: Scene, camera: Camera, x: Float64, y: Float64, shape: Shape) -> View:
        """Send rays through the image positions `x`, `y` (N,) in pixels; whole numbers are pixel centres."""
        directions = camera.directions(x, y, shape)
        rays = directions.astype(np.float32)
        origins = np.broadcast_to(np.array(camera.position, np.float32)[:, None], rays.shape)
        hits = scene.triangles.intersect(origins, rays)
        surface = scene.triangles.surface(hits, rays.take(hits.ray, axis=1))
        return cls(
            scene, camera, shape, directions, hits, surface, scene.materials.albedo(surface.material, surface.uv)
        )

    def radiance(self, random: np.random.Generator, bounces: int) -> Float32:
        """One sample of direct light, indirect light and emission (3, 3, N); the first axis tells which."""
        result = np.zeros((3, *self.directions.shape), np.float32)
        direct, indirect = reflected_light(self.scene, self.surface, self.albedo, random, bounces)
        emission = self.scene.materials.emission(self.surface.material, self.surface.uv) * self.surface.front
        if self.scene.sky is not None:
            result[2] = self.scene.sky
        for target, values in zip(result, (direct, indirect, emission), strict=True):
            self._place(target, values)
        return result

    def features(self, previous: Camera) -> dict[str, NDArray[np.generic]]:
        """The G-buffer as planes, (3, N) or (N,), by the name of the `Frame` field.

        `previous` is the camera of the frame before.
        """
        count = self.directions.shape[1]
        triangles, triangle = self.scene.triangles, self.hits.triangle
        normal, albedo = np.zeros((3, count), np.float32), np.ones((3, count), np.float32)
        self._place(normal, self.surface.normal)
        self._place(albedo, self.albedo)
        instance = np.zeros(count, np.uint32)
        instance[self.hits.ray] = triangles.instance.take(triangle)
        # In double precision: motion is a small difference of large image positions.
        point = triangles.positions(triangle, self.hits.u, self.hits.v)
        now, before = self.directions.copy(), self.directions.copy()
        self._place(now, point - np.array(self.camera.position)[:, None])
        self._place(before, point - np.array(previous.position)[:, None])
        now = self.camera.project(now, self.shape)
        motion = previous.project(before, self.shape) - now
        missed = np.ones(count, np.bool_)
        missed[self.hits.ray] = False
        motion[2, missed] = 0.0
        depth = np.where(missed, np.inf, now[2])
        return {
            "albedo": albedo,
            "normal": normal,
            "depth": depth.astype(np.float32),
            "motion": motion.astype(np.float32),
            "id": instance,
        }

    def _place(self, target: NDArray[np.floating], values: NDArray[np.floating]) -> None:
        """Write the values (3, K) of the hits into their columns of `target` (3, N)."""
        if values.shape == target.shape:
            target[:] = values
        else:
            for row, value in zip(target, values, strict=True):
                row[self.hits.ray] = value

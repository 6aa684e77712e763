"""The emissive triangles of a scene as light sources to sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .geometry import Triangles
from .materials import Material, MaterialTable
from .sampling import triangle_coordinates
from .vectors import LUMINANCE, Float32, normalise


class AreaLights:
    """Emissive triangles, picked in proportion to area times luminance, sampled uniformly over their area.

    Attributes
    ----------
    count : int
        Number of emissive triangles; `sample` needs at least one.
    """

    def __init__(self, triangles: Triangles, materials: Sequence[Material], table: MaterialTable) -> None:
        brightness = np.array([LUMINANCE @ material.mean_emission() for material in materials])
        normal = np.cross(triangles.edge1, triangles.edge2, axis=0).astype(np.float64)
        power = brightness[triangles.material] * np.linalg.norm(normal, axis=0) / 2.0
        lamps = np.flatnonzero(power > 0.0)
        self.count = len(lamps)
        self._triangles, self._materials, self._triangle = triangles, table, lamps
        # Without the last value, which rounding may leave below the largest random number.
        self._cumulative = (np.cumsum(power[lamps]) / power.sum())[:-1].astype(np.float32)
        self._inverse_density = (power.sum() / brightness[triangles.material[lamps]]).astype(np.float32)
        self._normal = normalise(normal[:, lamps]).astype(np.float32)

    def sample(self, u: Float32) -> tuple[Float32, Float32, Float32]:
        """Points on lamps for uniform numbers `u` (3, N) in [0, 1).

        Returns their position, the unit normal of the lamp's front, and radiance divided by the density per unit of
        area, each (3, N).
        """
        pick = np.searchsorted(self._cumulative, u[0], side="right")
        triangle = self._triangle.take(pick)
        b, c = triangle_coordinates(u[1:])
        position = self._triangles.corner.take(triangle, axis=1)
        position += b * self._triangles.edge1.take(triangle, axis=1)
        position += c * self._triangles.edge2.take(triangle, axis=1)
        radiance = self._materials.emission(self._triangles.material.take(triangle), self._triangles.uv(triangle, b, c))
        radiance *= self._inverse_density.take(pick)
        return position, self._normal.take(pick, axis=1), radiance

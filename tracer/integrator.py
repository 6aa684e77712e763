"""Path tracing: the light that a batch of surface points reflects towards the rays that found them.

At every vertex of a path one lamp point is sampled (next-event estimation), and one direction is drawn with the
cosine of the surface. That direction continues the path; where it leaves the scene it has sampled the sky. A lamp hit
by it adds nothing, since the vertex before has sampled the lamps already.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import Hits, Surface
from .sampling import cosine_directions
from .scene import Scene
from .vectors import Float32, dot

NOTHING = Hits(np.empty(0, np.intp), np.empty(0, np.int32), np.empty(0, np.float32), np.empty(0, np.float32))


def reflected_light(
    scene: Scene, surface: Surface, albedo: Float32, random: np.random.Generator, bounces: int
) -> tuple[Float32, Float32]:
    """Radiance reflected at K first hits: what was reflected once, and the rest.

    Parameters
    ----------
    scene : Scene
    surface : Surface
        The K first hits.
    albedo : (3, K) float32
        Their reflectance.
    random : numpy.random.Generator
    bounces : int
        Further surfaces a path may visit, >= 0.

    Returns
    -------
    direct, indirect : (3, K) float32
    """
    direct = np.zeros_like(albedo)
    indirect = np.zeros_like(albedo)
    path = np.arange(albedo.shape[1])
    throughput = albedo
    for bounce in range(bounces + 1):
        gathered = _lamp_light(scene, surface, random)
        direction = cosine_directions(surface.normal, random.random((2, len(path)), dtype=np.float32))
        # The shading normal can send a direction below the true surface, where no light comes from.
        usable = dot(direction, surface.face_normal) > 0
        hits, escaped = _follow(scene, surface.origin, direction, last=bounce == bounces)
        if scene.sky is not None:
            gathered += scene.sky * (escaped & usable)
        gathered *= throughput
        _add(indirect if bounce else direct, path, gathered)
        if not hits.ray.size:
            break
        surface = scene.triangles.surface(hits, direction.take(hits.ray, axis=1))
        path = path.take(hits.ray)
        throughput = (throughput * usable).take(hits.ray, axis=1)
        throughput *= scene.materials.albedo(surface.material, surface.uv)
    return direct, indirect


def _follow(scene: Scene, origin: Float32, direction: Float32, *, last: bool) -> tuple[Hits, NDArray[np.bool_]]:
    """The next hits of a path, and which rays left the scene; on the last vertex only the latter, if it matters."""
    if not last:
        hits = scene.triangles.intersect(origin, direction)
        escaped = np.ones(direction.shape[1], np.bool_)
        escaped[hits.ray] = False
        return hits, escaped
    if scene.sky is not None:
        return NOTHING, ~scene.triangles.occluded(origin, direction)
    return NOTHING, np.zeros(direction.shape[1], np.bool_)


def _lamp_light(scene: Scene, surface: Surface, random: np.random.Generator) -> Float32:
    """Light (3, K) from one sampled lamp point, reflected by a white Lambertian surface."""
    if not scene.lights.count:
        return np.zeros_like(surface.normal)
    position, lamp_normal, radiance = scene.lights.sample(random.random((3, surface.normal.shape[1]), np.float32))
    toward = position - surface.origin
    cosine = np.maximum(dot(toward, surface.normal), 0)
    # Lamps shine to their front only.
    lamp_cosine = np.maximum(-dot(toward, lamp_normal), 0)
    squared = dot(toward, toward)
    # Both cosines carry a factor of the distance, hence its fourth power.
    geometry = cosine * lamp_cosine / np.maximum(np.float32(np.pi) * squared * squared, np.float32(1e-30))
    geometry *= dot(toward, surface.face_normal) > 0
    # End the shadow ray in front of the lamp, as far as rays start in front of a surface.
    toward += scene.triangles.lift * lamp_normal
    geometry *= ~scene.triangles.occluded(surface.origin, toward, reach=1.0)
    radiance *= geometry
    return radiance


def _add(total: Float32, path: NDArray[np.intp], values: Float32) -> None:
    """Add `values` (3, K) to the columns `path` (K,) of `total`."""
    for row, value in zip(total, values, strict=True):
        row[path] += value

"""The G-buffer: what a denoiser needs to know of the first surface that a pixel shows."""

from __future__ import annotations

import numpy as np

from .bsdf import Reflection, albedo
from .camera import Lens, project
from .compiled import compiled
from .geometry import Surface, interpolated
from .paths import Before, Features
from .surroundings import Tables
from .vec3 import Vec3, dot, subtract


@compiled
def describe(
    tables: Tables,
    lens: Lens,
    before: Before,
    surface: Surface,
    r: Reflection,
    triangle: int,
    b: float,
    c: float,
    outgoing: Vec3,
    pixel: int,
    features: Features,
) -> None:
    """Write the features of a surface: the point at `b`, `c` of `triangle`, whose light leaves along `outgoing`."""
    materials, material = tables.materials, surface.material
    glass = materials.transmissive[material]
    reflectance = (1.0, 1.0, 1.0) if glass else albedo(r, min(dot(surface.normal, outgoing), 1.0))
    for channel in range(3):
        features.albedo[pixel, channel] = reflectance[channel]
    features.roughness[pixel] = 0.0 if glass else materials.roughness[material]
    features.hit_distance[pixel, 0] = features.hit_distance[pixel, 1] = 0.0
    now = project(lens, subtract(surface.point, lens.position))
    previous = surface.point
    if triangle >= before.first:
        previous = interpolated(before.corners, triangle - before.first, b, c)
    then = project(before.lens, subtract(previous, before.lens.position))
    for axis in range(3):
        features.normal[pixel, axis] = surface.normal[axis]
        features.motion[pixel, axis] = then[axis] - now[axis]
    features.depth[pixel] = now[2]
    features.id[pixel] = tables.triangles.instance[triangle]


@compiled
def describe_outside(lens: Lens, before: Before, direction: Vec3, pixel: int, features: Features) -> None:
    """Write the features of a miss: its motion is that of a point infinitely far away."""
    for channel in range(3):
        features.albedo[pixel, channel] = 1.0
        features.normal[pixel, channel] = 0.0
        features.motion[pixel, channel] = 0.0
    features.depth[pixel], features.id[pixel], features.roughness[pixel] = np.inf, 0, 1.0
    features.hit_distance[pixel, 0] = features.hit_distance[pixel, 1] = 0.0
    now, then = project(lens, direction), project(before.lens, direction)
    for axis in range(2):
        features.motion[pixel, axis] = then[axis] - now[axis]

"""Path tracing: radiance and G-buffer of a batch of pixels.

At every surface of a path one light is sampled (next-event estimation). One direction is also sampled, from one lobe of
the surface, and the path continues in this direction. If it hits a light, both estimates are weighted. Embree traces a
whole batch at once; between its calls, compiled loops shade the paths one by one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .boxes import passing
from .camera import Lens
from .paths import DIRECT_DIFFUSE, INDIRECT_DIFFUSE, Aim, Before, Draws, Features, Paths, ShadowRays
from .shading import deposit, shade, start_paths
from .surroundings import Moment
from .trees import FAR, MISS, Hits, Trees
from .vectors import Float32, Float64

# The most surfaces of smooth glass that a path may pass in addition to scattering: in and out of two objects.
GLASS = 4


def trace(
    moment: Moment, lens: Lens, before: Before, draws: Draws, aim: Aim, bounces: int, features: Features
) -> Float32:
    """Trace one path through each of N pixels.

    Parameters
    ----------
    moment : Moment
    lens : Lens
    before : Before
    draws : Draws
    aim : Aim
    bounces : int
        Surfaces that may scatter a path after the first surface.
    features : Features
        Receives the first hits, unless it is empty.

    Returns
    -------
    (N, 5, 3) float32
        Radiance by `DIRECT_DIFFUSE` and so on.
    """
    tables, trees, goals = moment
    count = len(draws.pixels)
    light = np.zeros((count, 5, 3), np.float32)
    paths, ahead, shadows = Paths.empty(count), Paths.empty(count), ShadowRays.empty(count)
    start_paths(lens, draws, aim, bounces + 1, paths)
    glass = GLASS if tables.materials.transmissive.any() else 0
    last = bounces + 1 + glass
    for depth in range(last + 1):
        if depth == last:
            paths.scatterings.fill(0)  # paths end at whatever they hit next
        if depth == 1 and len(features.depth):
            hits = trees.intersect(paths.origin, paths.direction)  # all hits, because their distance is a feature
        elif depth < last or len(tables.lights.lamps):
            hits = gains(trees, goals, paths)
        else:
            hits = escapes(trees, paths)
        shadow_count, ahead_count = shade(
            tables, lens, before, draws, depth, paths, hits, light, features, shadows, ahead
        )
        if shadow_count:
            rays = shadows.first(shadow_count)
            blocked = trees.occluded(rays.origin, rays.direction, rays.distance)
            deposit(light, rays, blocked, DIRECT_DIFFUSE if depth == 0 else INDIRECT_DIFFUSE)
        if not ahead_count:
            break
        paths, ahead = ahead.first(ahead_count), paths
    return light


def gains(trees: Trees, goals: Sequence[Float64], paths: Paths) -> Hits:
    """The hits of paths; for paths that can no longer be scattered, only hits that can bring light."""
    if paths.scatterings.all():
        return trees.intersect(paths.origin, paths.direction)
    nowhere = np.full(len(paths.pixel), FAR, np.float32)
    wanted = passing(goals, paths.origin, paths.direction, nowhere) | (paths.scatterings > 0)
    hits = Hits.none(nowhere)
    for values, found in zip(hits, trees.intersect(paths.origin[wanted], paths.direction[wanted]), strict=True):
        values[wanted] = found
    return hits


def escapes(trees: Trees, paths: Paths) -> Hits:
    """For paths that end at their next hit, in a scene without lamps: only whether they leave the scene."""
    count = len(paths.pixel)
    blocked = trees.occluded(paths.origin, paths.direction, np.full(count, FAR, np.float32))
    nowhere = np.zeros(count, np.float32)
    return Hits(np.where(blocked, np.int32(0), np.int32(MISS)), nowhere, nowhere, nowhere)

"""Path tracing: radiance and G-buffer of a batch of pixels.

At every surface of a path one light is sampled (next-event estimation), and one direction is drawn from one lobe of the
surface: it continues the path. Where that finds a light itself, both estimates are weighted. A batch goes through
Embree as a whole; in between compiled loops shade one path after the other.
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

# Surfaces of smooth glass that a path may pass in addition to those it may be scattered at: in and out of two objects.
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
        Surfaces that may scatter a path after the first.
    features : Features
        Filled with the first hits, unless it has room for no pixel.

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
            paths.scatterings.fill(0)  # whatever they still meet, they end there
        if depth == 1 and len(features.depth):
            hits = trees.intersect(paths.origin, paths.direction)  # whatever they meet, its distance is a feature
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
    """What paths meet; of those that may not be scattered any more, only what may bring light."""
    if paths.scatterings.all():
        return trees.intersect(paths.origin, paths.direction)
    nowhere = np.full(len(paths.pixel), FAR, np.float32)
    wanted = passing(goals, paths.origin, paths.direction, nowhere) | (paths.scatterings > 0)
    hits = Hits.none(nowhere)
    for values, found in zip(hits, trees.intersect(paths.origin[wanted], paths.direction[wanted]), strict=True):
        values[wanted] = found
    return hits


def escapes(trees: Trees, paths: Paths) -> Hits:
    """Of paths that end wherever they arrive, in a scene without lamps: only whether they leave it."""
    count = len(paths.pixel)
    blocked = trees.occluded(paths.origin, paths.direction, np.full(count, FAR, np.float32))
    nowhere = np.zeros(count, np.float32)
    return Hits(np.where(blocked, np.int32(0), np.int32(MISS)), nowhere, nowhere, nowhere)

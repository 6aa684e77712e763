"""Single parts of the shading loop, run over the hits of a recorded frame.

Each part sums what it computes, because the compiler would remove it otherwise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from svgf_cl_tracer.compiled import compiled
from svgf_cl_tracer.geometry import surface_at
from svgf_cl_tracer.light_sampling import outside_radiance, sample_light
from svgf_cl_tracer.materials import base_colour, emitted_radiance
from svgf_cl_tracer.paths import Draws, Paths
from svgf_cl_tracer.sampling import random4
from svgf_cl_tracer.shading import FIRST_SURFACE_DRAW
from svgf_cl_tracer.surroundings import Tables
from svgf_cl_tracer.trees import MISS, Hits
from svgf_cl_tracer.vec3 import add, row, scale
from svgf_cl_tracer.vectors import Float64


class Spots(NamedTuple):
    """The state of N paths: the material they hit or `MISS`, whether they may continue, whether a light is sampled.

    `u` and `v` are texture coordinates. A ray to a light starts at `origin`, and is sampled with `numbers`.
    """

    material: NDArray[np.int64]
    goes_on: NDArray[np.bool_]
    lit: NDArray[np.bool_]
    u: Float64
    v: Float64
    origin: Float64
    numbers: Float64

    @classmethod
    def empty(cls, count: int) -> Spots:
        """Room for `count` paths."""
        return cls(
            np.empty(count, np.int64),
            np.empty(count, np.bool_),
            np.empty(count, np.bool_),
            np.empty(count),
            np.empty(count),
            np.empty((count, 3)),
            np.empty((count, 4)),
        )


@compiled
def find_spots(tables: Tables, draws: Draws, depth: int, paths: Paths, hits: Hits, spots: Spots) -> None:
    """Fill in `spots`."""
    for index in range(len(paths.pixel)):
        triangle = hits.triangle[index]
        if triangle == MISS:
            spots.material[index], spots.goes_on[index], spots.lit[index] = MISS, False, False
            continue
        b, c = np.float64(hits.b[index]), np.float64(hits.c[index])
        surface = surface_at(tables.triangles, triangle, b, c, row(paths.direction, index))
        spots.material[index], spots.u[index], spots.v[index] = surface.material, surface.u, surface.v
        glass = tables.materials.transmissive[surface.material]
        spots.goes_on[index] = glass or paths.scatterings[index] > 0
        spots.lit[index] = spots.goes_on[index] and not glass and len(tables.lights.kinds) > 0
        origin = add(surface.point, scale(surface.face_normal, surface.lift))
        numbers = random4(draws.key, draws.pixels[paths.pixel[index]], draws.sample, FIRST_SURFACE_DRAW + 2 * depth + 1)
        for axis in range(3):
            spots.origin[index, axis] = origin[axis]
        for place in range(4):
            spots.numbers[index, place] = numbers[place]


@compiled
def draw_numbers(draws: Draws, depth: int, paths: Paths, spots: Spots) -> float:
    """The random numbers of all paths that may continue."""
    total = 0.0
    for index in range(len(paths.pixel)):
        pixel, draw = draws.pixels[paths.pixel[index]], FIRST_SURFACE_DRAW + 2 * depth
        if spots.goes_on[index]:
            u = random4(draws.key, pixel, draws.sample, draw)
            total += u[0] + u[1] + u[2] + u[3]
        if spots.lit[index]:
            u = random4(draws.key, pixel, draws.sample, draw + 1)
            total += u[0] + u[1] + u[2] + u[3]
    return total


@compiled
def read_textures(tables: Tables, spots: Spots) -> float:
    """The emission of lights, and the base colour where paths may continue; from a texture if there is one."""
    total = 0.0
    for index in range(len(spots.material)):
        material = spots.material[index]
        if material != MISS and tables.lights.lamp_density[material] > 0.0:
            emission = emitted_radiance(tables.materials, material, spots.u[index], spots.v[index])
            total += emission[0] + emission[1] + emission[2]
        if spots.goes_on[index]:
            colour = base_colour(tables.materials, material, spots.u[index], spots.v[index])
            total += colour[0] + colour[1] + colour[2]
    return total


@compiled
def sample_lights(tables: Tables, paths: Paths, spots: Spots) -> float:
    """Sample a light for each path that does so, and the radiance outside for each path that leaves the scene."""
    total = 0.0
    for index in range(len(spots.material)):
        if spots.material[index] == MISS:
            direction, density = row(paths.direction, index), np.float64(paths.density[index])
            shine = outside_radiance(tables.lights, tables.sky, direction, density)
            total += shine[0] + shine[1] + shine[2]
        if spots.lit[index]:
            u = spots.numbers[index, 0], spots.numbers[index, 1], spots.numbers[index, 2], spots.numbers[index, 3]
            origin = row(spots.origin, index)
            sample = sample_light(tables.lights, tables.triangles, tables.materials, tables.sky, origin, u)
            total += sample.light[0] + sample.light[1] + sample.light[2] + sample.direction[0] + sample.density
    return total

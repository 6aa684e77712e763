"""All lights of a scene as one distribution of directions to sample: next-event estimation.

There are four kinds: emissive triangles, suns, point and spot lights, and the image of the sky. Each kind that the
scene has gets an equal share of the samples. Within a kind, brighter lights get more. A constant sky is not sampled:
directions that are sampled from the surface find it well enough.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import LUMINANCE

from .compiled import compiled
from .geometry import Triangles, interpolated, texture_coordinates
from .lights import PointLight, Sun
from .materials import Material, Materials, emitted_radiance, is_solid
from .sampling import Random4, on_circle
from .sky import SkyTable, sample_sky, sky_density, sky_radiance
from .vec3 import Vec3, add, dot, normalise, row, scale, subtract, to_world
from .vectors import Float64

LAMPS, SUNS, POINTS, SKY = range(4)

TINY = np.finfo(np.float64).tiny

BLACK = (0.0, 0.0, 0.0)


class Lights(NamedTuple):
    """All lights of a scene at one time.

    `kinds` are the kinds of light in the scene. Lamps are emissive triangles; `lamp_density` is the probability per
    area of sampling a point on a material. `lamp_chances` and so on are cumulative probabilities within a kind.
    """

    kinds: NDArray[np.int64]
    lamps: NDArray[np.int64]
    lamp_normals: Float64
    lamp_chances: Float64
    lamp_density: Float64
    sun_direction: Float64
    sun_irradiance: Float64
    sun_radiance: Float64
    sun_cosine: Float64
    sun_solid_angle: Float64
    sun_chances: Float64
    point_position: Float64
    point_direction: Float64
    point_intensity: Float64
    point_cosines: Float64
    point_reach: Float64
    point_chances: Float64

    @classmethod
    def of(
        cls,
        triangles: Triangles,
        materials: Sequence[Material],
        lights: Sequence[Sun | PointLight],
        sky: SkyTable,
        time: float,
    ) -> Lights:
        """The lights at `time` in seconds."""
        suns = [light for light in lights if isinstance(light, Sun) and max(light.irradiance) > 0.0]
        points = [light for light in lights if isinstance(light, PointLight) and max(light.intensity) > 0.0]
        brightness = np.array([np.dot(LUMINANCE, material.emission_at(time)) for material in materials])
        shining = np.flatnonzero(brightness[triangles.material] > 0.0)
        edges = triangles.corners[shining, 1:].astype(np.float64)
        normals = np.cross(edges[:, 0], edges[:, 1]) * np.where(triangles.mirrored[shining], -1.0, 1.0)[:, None]
        areas = np.linalg.norm(normals, axis=1) / 2.0
        lamps, normals, areas = shining[areas > 0.0], normals[areas > 0.0], areas[areas > 0.0]
        power = brightness[triangles.material[lamps]] * areas
        radius = np.radians([sun.angular_radius for sun in suns])
        placed = [light.placed(time) for light in points]
        present = [len(lamps), len(suns), len(points), sky.rows.size]
        return cls(
            np.flatnonzero(present).astype(np.int64),
            lamps.astype(np.int64),
            normals / (2.0 * areas[:, None]),
            _cumulative(power),
            brightness / (power.sum() or 1.0),
            _rows([sun.direction_at(time) for sun in suns]),
            _rows([s.irradiance for s in suns]),
            _rows([s.irradiance for s in suns]) / np.maximum(np.pi * np.sin(radius) ** 2, TINY)[:, None],
            np.cos(radius),
            4.0 * np.pi * np.sin(radius / 2.0) ** 2,
            _cumulative(np.array([np.dot(LUMINANCE, s.irradiance) for s in suns])),
            _rows([position for position, _ in placed]),
            _rows([direction for _, direction in placed]),
            _rows([light.intensity for light in points]),
            np.cos(np.radians([(p.inner_angle, p.outer_angle) for p in points])).reshape(-1, 2),
            np.array([light.reach for light in points], np.float64),
            _cumulative(np.array([np.dot(LUMINANCE, p.intensity) for p in points])),
        )


class LightSample(NamedTuple):
    """A direction from which light arrives.

    `light` is radiance divided by `density`, the density per solid angle. The density is infinite, written as 0, for a
    light that no other direction can hit.
    """

    direction: Vec3
    distance: float
    light: Vec3
    density: float


@compiled
def sample_light(
    lights: Lights, triangles: Triangles, materials: Materials, sky: SkyTable, point: Vec3, u: Random4
) -> LightSample:
    """Light from one light at `point`, as if nothing were in between; the scene must have lights to sample."""
    count = len(lights.kinds)
    place = u[0] * count
    number = min(int(place), count - 1)
    kind, rest = lights.kinds[number], place - number
    if kind == LAMPS:
        sample = _sample_lamp(lights, triangles, materials, point, rest, u[1], u[2])
    elif kind == SUNS:
        sample = _sample_sun(lights, rest, u[1], u[2])
    elif kind == POINTS:
        sample = _sample_point(lights, point, rest)
    else:
        direction, density = sample_sky(sky, u[1], u[2])
        share = 1.0 / density if density > 0.0 else 0.0
        sample = LightSample(direction, math.inf, scale(sky_radiance(sky, direction), share), density)
    return LightSample(sample.direction, sample.distance, scale(sample.light, count), sample.density / count)


@compiled
def lamp_density(lights: Lights, material: int, cosine: float, distance: float) -> float:
    """Density per solid angle with which `sample_light` samples a point of a lamp, at this angle and distance."""
    density = float(lights.lamp_density[material])
    return density * distance * distance / (max(cosine, 1e-12) * max(len(lights.kinds), 1))


@compiled
def outside_radiance(lights: Lights, sky: SkyTable, direction: Vec3, density: float) -> Vec3:
    """Radiance from outside the scene, for a path whose direction was sampled with `density` per solid angle.

    Sky and suns are sampled separately, so they are weighted separately, although a sun may be in front of the sky.
    """
    count = max(len(lights.kinds), 1)
    radiance = scale(sky_radiance(sky, direction), mis_weight(density, sky_density(sky, direction) / count))
    for number in range(len(lights.sun_cosine)):
        if _in_sun(lights, number, direction):
            sampled = _chance(lights.sun_chances, number) / (lights.sun_solid_angle[number] * count)
            radiance = add(radiance, scale(row(lights.sun_radiance, number), mis_weight(density, sampled)))
    return radiance


@compiled
def mis_weight(density: float, other: float) -> float:
    """The weight of an estimate that was sampled with `density`, if it could also be sampled with density `other`.

    A density of 0 means the infinite density of a single direction. Source: the power heuristic of Veach, Robust Monte
    Carlo Methods for Light Transport Simulation, 1997, 9.2.4.
    """
    return density * density / (density * density + other * other) if density > 0.0 else 1.0


@compiled
def _sample_lamp(
    lights: Lights, triangles: Triangles, materials: Materials, point: Vec3, u: float, v: float, w: float
) -> LightSample:
    number = _pick(lights.lamp_chances, u)
    triangle = lights.lamps[number]
    material = triangles.material[triangle]
    root = math.sqrt(v)
    b, c = 1.0 - root, w * root
    way = subtract(interpolated(triangles.corners, triangle, b, c), point)
    distance = math.sqrt(dot(way, way))
    direction = normalise(way)
    zero = (0.0, 0.0, 0.0)
    cosine = -dot(row(lights.lamp_normals, number), direction)
    if materials.two_sided[material]:
        cosine = abs(cosine)
    s, t = texture_coordinates(triangles, triangle, b, c)
    if cosine <= 0.0 or distance == 0.0 or not is_solid(materials, material, s, t):
        return LightSample(direction, distance, zero, 0.0)
    density = lights.lamp_density[material] * distance * distance / cosine
    return LightSample(direction, distance, scale(emitted_radiance(materials, material, s, t), 1.0 / density), density)


@compiled
def _sample_sun(lights: Lights, u: float, v: float, w: float) -> LightSample:
    number = _pick(lights.sun_chances, u)
    chance = _chance(lights.sun_chances, number)
    solid_angle, middle = lights.sun_solid_angle[number], row(lights.sun_direction, number)
    if solid_angle == 0.0:
        return LightSample(middle, math.inf, scale(row(lights.sun_irradiance, number), 1.0 / chance), 0.0)
    density = chance / solid_angle
    height = v * solid_angle / (2.0 * math.pi)  # 1 - cosine, computed without loss of digits
    across = math.sqrt(height * (2.0 - height))
    cosine, sine = on_circle(w)
    direction = to_world((across * cosine, across * sine, 1.0 - height), middle)
    return LightSample(direction, math.inf, scale(row(lights.sun_radiance, number), 1.0 / density), density)


@compiled
def _sample_point(lights: Lights, point: Vec3, u: float) -> LightSample:
    """Source of the falloff: glTF, KHR_lights_punctual."""
    number = _pick(lights.point_chances, u)
    way = subtract(row(lights.point_position, number), point)
    squared = max(dot(way, way), 1e-24)
    distance, direction = math.sqrt(squared), normalise(way)
    strength = 1.0 / (squared * _chance(lights.point_chances, number))
    reach = lights.point_reach[number]
    if reach < math.inf:
        strength *= max(min(1.0 - (distance / reach) ** 4, 1.0), 0.0)
    inner, outer = lights.point_cosines[number, 0], lights.point_cosines[number, 1]
    if outer > -1.0:
        cosine = -dot(direction, row(lights.point_direction, number))
        strength *= max(min((cosine - outer) / max(inner - outer, 1e-4), 1.0), 0.0) ** 2
    return LightSample(direction, distance, scale(row(lights.point_intensity, number), strength), 0.0)


@compiled
def _in_sun(lights: Lights, number: int, direction: Vec3) -> bool:
    # In single precision, the error of a unit vector's length exceeds the cosine of a small disc.
    length = math.sqrt(dot(direction, direction))
    along = dot(direction, row(lights.sun_direction, number))
    return bool(lights.sun_solid_angle[number] > 0.0 and along > lights.sun_cosine[number] * length)


@compiled
def _pick(chances: Float64, u: float) -> int:
    """The number whose interval of the cumulative probabilities contains `u`."""
    return min(int(np.searchsorted(chances, u, side="right")), len(chances) - 1)


@compiled
def _chance(chances: Float64, number: int) -> float:
    return float(chances[number]) - (float(chances[number - 1]) if number > 0 else 0.0)


def _cumulative(weights: Float64) -> Float64:
    return np.cumsum(weights) / (weights.sum() or 1.0)


def _rows(vectors: Sequence[Sequence[float]] | Sequence[Float64]) -> Float64:
    return np.array(vectors, np.float64).reshape(-1, 3)

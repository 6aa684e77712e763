"""The compiled loops between calls of Embree: they start paths, shade hits, and sum up light."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .bsdf import (
    Reflection,
    diffuse_density,
    evaluate_diffuse,
    evaluate_specular,
    fresnel_dielectric,
    reflection,
    refract,
    sample_diffuse,
    sample_specular,
    specular_density,
    specular_share,
)
from .camera import Lens, ray_through
from .compiled import compiled
from .gbuffer import describe, describe_outside
from .geometry import Surface, interpolated, surface_at
from .light_sampling import lamp_density, mis_weight, outside_radiance, sample_light
from .materials import base_colour, emitted_radiance
from .paths import (
    DIFFUSE,
    DIRECT_DIFFUSE,
    DIRECT_SPECULAR,
    EMISSION,
    INDIRECT_DIFFUSE,
    INDIRECT_SPECULAR,
    SPECULAR,
    Aim,
    Before,
    Draws,
    Features,
    Paths,
    Radiance,
    ShadowRays,
)
from .sampling import Random4, random4
from .surroundings import Tables
from .trees import FAR, MISS, Hits
from .vec3 import Vec3, add, dot, multiply, row, scale, to_local, to_world
from .vectors import Float32

# Random draws of a path: position in the pixel and time in the shutter, point on the lens, two for each surface.
PIXEL_DRAW, LENS_DRAW, FIRST_SURFACE_DRAW = 0, 1, 2

BLACK = (0.0, 0.0, 0.0)


@compiled
def pick_moments(draws: Draws, count: int, moments: NDArray[np.int64]) -> None:
    """Choose one of `count` moments for each path: `moments` (N,)."""
    for index in range(len(moments)):
        moments[index] = int(random4(draws.key, draws.pixels[index], draws.sample, PIXEL_DRAW)[2] * count)


class Vertex(NamedTuple):
    """A surface that scatters a path: its lobes, the incoming direction, and the throughput of the path.

    `specular_share` is the probability of sampling the specular lobe.
    """

    surface: Surface
    reflection: Reflection
    specular_share: float
    outgoing: Vec3
    throughput: Vec3


@compiled
def start_paths(lens: Lens, draws: Draws, aim: Aim, scatterings: int, paths: Paths) -> None:
    """Start a path through each pixel of `draws`."""
    u = v = (0.5, 0.5, 0.5, 0.5)
    for index in range(len(draws.pixels)):
        pixel = draws.pixels[index]
        if aim.spread > 0.0:
            u = random4(draws.key, pixel, draws.sample, PIXEL_DRAW)
        if lens.radius > 0.0:
            v = random4(draws.key, pixel, draws.sample, LENS_DRAW)
        x = pixel % aim.width + aim.x + aim.spread * (u[0] - 0.5)
        y = pixel // aim.width + aim.y + aim.spread * (u[1] - 0.5)
        origin, direction = ray_through(lens, x, y, v[0], v[1])
        _put(paths, index, origin, direction, (1.0, 1.0, 1.0), 0.0)
        paths.pixel[index], paths.lobe[index], paths.scatterings[index] = index, DIFFUSE, scatterings


@compiled
def deposit(light: Float32, rays: ShadowRays, blocked: NDArray[np.bool_], first: int) -> None:
    """Add the light of unblocked shadow rays to `light`, as the kind `first` and the kind after it."""
    for index in range(len(blocked)):
        if not blocked[index]:
            pixel = rays.pixel[index]
            for lobe in range(2):
                for channel in range(3):
                    light[pixel, first + lobe, channel] += rays.light[index, lobe, channel]


@compiled
def sum_up(light: Float32, spp: int, radiance: Radiance) -> None:
    """Sum the kinds of light (N, 5, 3) of `spp` samples to signals, divided by `spp`."""
    share = 1.0 / spp
    for pixel in range(len(light)):
        for channel in range(3):
            kinds = light[pixel]
            direct_diffuse, direct_specular = kinds[DIRECT_DIFFUSE, channel], kinds[DIRECT_SPECULAR, channel]
            indirect_diffuse, indirect_specular = kinds[INDIRECT_DIFFUSE, channel], kinds[INDIRECT_SPECULAR, channel]
            direct, indirect = (
                share * (direct_diffuse + direct_specular),
                share * (indirect_diffuse + indirect_specular),
            )
            emission = share * kinds[EMISSION, channel]
            radiance.color[pixel, channel] = direct + indirect + emission
            radiance.direct[pixel, channel] = direct
            radiance.indirect[pixel, channel] = indirect
            radiance.diffuse[pixel, channel] = share * (direct_diffuse + indirect_diffuse)
            radiance.specular[pixel, channel] = share * (direct_specular + indirect_specular)
            radiance.emission[pixel, channel] = emission


@compiled
def shade(
    tables: Tables,
    lens: Lens,
    before: Before,
    draws: Draws,
    depth: int,
    paths: Paths,
    hits: Hits,
    light: Float32,
    features: Features,
    shadows: ShadowRays,
    ahead: Paths,
) -> tuple[int, int]:
    """Shade the hits of paths after `depth` surfaces.

    Emitted light is added to `light`. Paths that may be scattered send a ray to a light, which is written to `shadows`,
    and continue, which is written to `ahead`. Returns the numbers of both.
    """
    shadow_count = ahead_count = 0
    for index in range(len(paths.pixel)):
        pixel, lobe = paths.pixel[index], paths.lobe[index]
        direction, throughput = row(paths.direction, index), row(paths.throughput, index)
        density, triangle = np.float64(paths.density[index]), hits.triangle[index]
        kind = EMISSION if depth == 0 else lobe if depth == 1 else INDIRECT_DIFFUSE + lobe
        if triangle == MISS:
            shine = outside_radiance(tables.lights, tables.sky, direction, density)
            _add(light, pixel, kind, multiply(throughput, shine))
            if len(features.depth):
                if depth == 0:
                    describe_outside(lens, before, direction, pixel, features)
                elif depth == 1:
                    features.hit_distance[pixel, lobe] = np.inf
            continue
        if depth == 1 and len(features.depth):
            features.hit_distance[pixel, lobe] = hits.distance[index]
        material = tables.triangles.material[triangle]
        glass = tables.materials.transmissive[material]
        ends = paths.scatterings[index] == 0 and not glass
        shines = tables.lights.lamp_density[material] > 0.0
        if ends and not shines:
            continue
        b, c = np.float64(hits.b[index]), np.float64(hits.c[index])
        surface = surface_at(tables.triangles, triangle, b, c, direction)
        if shines and (surface.front or tables.materials.two_sided[material]):
            shine = emitted_radiance(tables.materials, material, surface.u, surface.v)
            cosine = abs(dot(surface.face_normal, direction))
            weight = mis_weight(density, lamp_density(tables.lights, material, cosine, hits.distance[index]))
            _add(light, pixel, kind, multiply(throughput, scale(shine, weight)))
        if ends:
            continue
        base = base_colour(tables.materials, material, surface.u, surface.v)
        if len(tables.triangles.colours):
            base = multiply(base, interpolated(tables.triangles.colours, triangle, b, c))
        outgoing = scale(direction, -1.0)
        r = reflection(
            base,
            tables.materials.metallic[material],
            tables.materials.roughness[material],
            tables.materials.ior[material],
        )
        if depth == 0 and len(features.depth):
            describe(tables, lens, before, surface, r, triangle, b, c, outgoing, pixel, features)
        draw = FIRST_SURFACE_DRAW + 2 * depth
        u = random4(draws.key, draws.pixels[pixel], draws.sample, draw)
        if glass:
            vertex = Vertex(surface, r, 1.0, outgoing, throughput)
            ahead_count = _pass_glass(tables, vertex, base, u, paths, index, depth, ahead, ahead_count)
            continue
        share = specular_share(r, min(dot(surface.normal, outgoing), 1.0))
        vertex = Vertex(surface, r, share, outgoing, throughput)
        if len(tables.lights.kinds):
            to_light = random4(draws.key, draws.pixels[pixel], draws.sample, draw + 1)
            shadow_count = _aim(tables, vertex, to_light, depth, lobe, pixel, shadows, shadow_count)
        ahead_count = _scatter(vertex, u, paths, index, depth, ahead, ahead_count)
    return shadow_count, ahead_count


@compiled
def _aim(
    tables: Tables,
    vertex: Vertex,
    u: Random4,
    depth: int,
    lobe: int,
    pixel: int,
    shadows: ShadowRays,
    count: int,
) -> int:
    """Send a ray from the surface to a light, unless the light cannot reach it; return the new number of such rays."""
    surface, r, share, outgoing, throughput = vertex
    origin = _lifted(surface, 1.0)
    sample = sample_light(tables.lights, tables.triangles, tables.materials, tables.sky, origin, u)
    cosine = dot(sample.direction, surface.normal)
    shines = max(sample.light[0], sample.light[1], sample.light[2]) > 0.0
    if not shines or cosine <= 0.0 or dot(sample.direction, surface.face_normal) <= 0.0:
        return count
    light = multiply(throughput, sample.light)
    diffuse, specular = BLACK, BLACK
    if share < 1.0:
        cos_o = dot(outgoing, surface.normal)
        weight = mis_weight(sample.density, (1.0 - share) * diffuse_density(cosine))
        diffuse = scale(evaluate_diffuse(r, cos_o, cosine), weight)
    if share > 0.0:
        wo, wi = to_local(outgoing, surface.normal), to_local(sample.direction, surface.normal)
        weight = mis_weight(sample.density, share * specular_density(r, wo, wi))
        specular = scale(evaluate_specular(r, wo, wi), weight)
    if depth > 0:
        total = add(diffuse, specular)
        diffuse, specular = (total, BLACK) if lobe == DIFFUSE else (BLACK, total)
    for channel in range(3):
        shadows.origin[count, channel] = origin[channel]
        shadows.direction[count, channel] = sample.direction[channel]
        shadows.light[count, DIFFUSE, channel] = light[channel] * diffuse[channel]
        shadows.light[count, SPECULAR, channel] = light[channel] * specular[channel]
    # The ray ends in front of the lamp, at the same distance at which rays start from a surface.
    shadows.distance[count] = min(max(sample.distance * (1.0 - 1e-4) - surface.lift, 0.0), FAR)
    shadows.pixel[count] = pixel
    return count + 1


@compiled
def _scatter(vertex: Vertex, u: Random4, paths: Paths, index: int, depth: int, ahead: Paths, count: int) -> int:
    """Sample a direction from one lobe and continue along it, unless it carries no light.

    Return the new number of paths.
    """
    surface, r, share, outgoing, throughput = vertex
    if u[0] < share:
        wo = to_local(outgoing, surface.normal)
        lobe, wi = SPECULAR, sample_specular(r, wo, u[1], u[2])
        density = share * specular_density(r, wo, wi)
        reflected = evaluate_specular(r, wo, wi)
    else:
        lobe, wi = DIFFUSE, sample_diffuse(u[1], u[2])
        density = (1.0 - share) * diffuse_density(wi[2])
        reflected = evaluate_diffuse(r, dot(outgoing, surface.normal), wi[2])
    onward = to_world(wi, surface.normal)
    # With a shading normal, a direction may be below the true surface, where no light arrives from.
    if density <= 0.0 or dot(onward, surface.face_normal) <= 0.0:
        return count
    throughput = multiply(throughput, scale(reflected, 1.0 / density))
    if max(throughput[0], throughput[1], throughput[2]) <= 0.0:
        return count
    _put(ahead, count, _lifted(surface, 1.0), onward, throughput, density)
    ahead.pixel[count] = paths.pixel[index]
    ahead.lobe[count] = lobe if depth == 0 else paths.lobe[index]
    ahead.scatterings[count] = paths.scatterings[index] - 1
    return count + 1


@compiled
def _pass_glass(
    tables: Tables,
    vertex: Vertex,
    colour: Vec3,
    u: Random4,
    paths: Paths,
    index: int,
    depth: int,
    ahead: Paths,
    count: int,
) -> int:
    """Reflect or refract a path at smooth glass with this `colour`; return the new number of paths."""
    surface, _, _, outgoing, throughput = vertex
    ior = tables.materials.ior[surface.material]
    eta = ior if surface.front else 1.0 / ior
    wo = to_local(outgoing, surface.normal)
    wi, side = (-wo[0], -wo[1], wo[2]), 1.0
    if u[0] >= fresnel_dielectric(wo[2], eta):
        wi, side = refract(wo, eta)[0], -1.0
        if surface.front:  # the colour counts once for the way in and out together
            throughput = multiply(throughput, colour)
    onward = to_world(wi, surface.normal)
    if dot(onward, surface.face_normal) * side <= 0.0:
        return count
    _put(ahead, count, _lifted(surface, side), onward, throughput, 0.0)
    ahead.pixel[count] = paths.pixel[index]
    ahead.lobe[count] = SPECULAR if depth == 0 else paths.lobe[index]
    ahead.scatterings[count] = paths.scatterings[index]
    return count + 1


@compiled
def _lifted(surface: Surface, side: float) -> Vec3:
    """The origin of a ray that leaves the surface on the side of its normals (1) or on the other side (-1)."""
    return add(surface.point, scale(surface.face_normal, side * surface.lift))


@compiled
def _put(paths: Paths, index: int, origin: Vec3, direction: Vec3, throughput: Vec3, density: float) -> None:
    for axis in range(3):
        paths.origin[index, axis] = origin[axis]
        paths.direction[index, axis] = direction[axis]
        paths.throughput[index, axis] = throughput[axis]
    paths.density[index] = density


@compiled
def _add(light: Float32, pixel: int, kind: int, radiance: Vec3) -> None:
    for channel in range(3):
        light[pixel, kind, channel] += radiance[channel]

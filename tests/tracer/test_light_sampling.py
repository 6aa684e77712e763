"""What `sample_light` draws, against closed forms of the light that arrives, and of what it is drawn with."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from svgf_cl_tracer.compiled import compiled
from svgf_cl_tracer.geometry import Instance, Triangles
from svgf_cl_tracer.light_sampling import Lights, lamp_density, mis_weight, outside_radiance, sample_light
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material, Materials
from svgf_cl_tracer.motion import Motion, Track
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.sky import Environment, SkyTable
from svgf_cl_tracer.surroundings import Tables
from svgf_cl_tracer.vec3 import Vec3
from tests.tracer.estimates import under_rectangle

COUNT = 40_000
BLACK = (0.0, 0.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)

Quad = Callable[..., Instance]
Floats = NDArray[np.float64]


@compiled
def draw(
    lights: Lights,
    triangles: Triangles,
    materials: Materials,
    sky: SkyTable,
    point: Vec3,
    u: Floats,
    direction: Floats,
    distance: Floats,
    light: Floats,
    density: Floats,
) -> None:
    for n in range(len(u)):
        found = sample_light(lights, triangles, materials, sky, point, (u[n, 0], u[n, 1], u[n, 2], u[n, 3]))
        for axis in range(3):
            direction[n, axis], light[n, axis] = found.direction[axis], found.light[axis]
        distance[n], density[n] = found.distance, found.density


def samples(tables: Tables, point: Vec3 = ORIGIN) -> tuple[Floats, Floats, Floats, Floats]:
    """Directions (N, 3), distances (N,), light (N, 3) and densities (N,)."""
    u = np.random.default_rng(5).random((COUNT, 4))
    result = np.empty((COUNT, 3)), np.empty(COUNT), np.empty((COUNT, 3)), np.empty(COUNT)
    direction, distance, light, density = result
    draw(tables.lights, tables.triangles, tables.materials, tables.sky, point, u, direction, distance, light, density)
    return result


def tables(
    instances: Sequence[Instance], lights: Sequence[Sun | PointLight] = (), sky: Environment | None = None
) -> Tables:
    return Scene(instances, lights=lights, sky=sky).around((0.0, 0.0, 0.0)).at(0.0).tables


def assert_irradiance(found: Tables, expected: Sequence[float], point: Vec3 = ORIGIN) -> None:
    """That what falls on a face at `point` that looks up is this, within four standard errors."""
    direction, _, light, _ = samples(found, point)
    arriving = light * np.maximum(direction[:, [1]], 0.0)
    error = arriving.std(0) / math.sqrt(COUNT)
    assert (np.abs(arriving.mean(0) - expected) <= 4.0 * error + 1e-9).all()


def lamp(*emission: float, **given: object) -> Material:
    return Material(BLACK, emission=emission, **given)


@pytest.fixture(scope="module")
def ground(floor: Callable[[Material], Instance]) -> Instance:
    return floor(Material())


@pytest.fixture(scope="module")
def ceiling(quad: Quad) -> Callable[..., Instance]:
    """Maker of a lamp 2 by 0.8 at a height of 1.5, that shines down."""
    return lambda material: quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), material)


def test_a_rectangle_has_its_form_factor(ground: Instance, ceiling: Quad) -> None:
    expected = np.multiply((10.0, 5.0, 1.0), math.pi * under_rectangle(2, 0.8, 1.5))
    assert_irradiance(tables([ground, ceiling(lamp(10, 5, 1))]), expected)


def test_lamps_get_samples_by_their_power(quad: Quad) -> None:
    small = quad((-0.5, 2, -0.5), (1, 0, 0), (0, 0, 1), lamp(1, 1, 1))
    large = quad((-1, 3, -1), (2, 0, 0), (0, 0, 2), lamp(3, 3, 3))
    dark = quad((-9, 4, -9), (18, 0, 0), (0, 0, 18))
    direction, distance, _, _ = samples(tables([small, dark, large]))
    height = direction[:, 1] * distance
    assert (np.isclose(height, 2) | np.isclose(height, 3)).all()
    assert np.isclose(height, 3).mean() == pytest.approx(12 / 13, abs=0.01)


def test_the_inverse_density_sums_up_to_the_solid_angle(ground: Instance, ceiling: Quad) -> None:
    a, b, d = 1.0, 0.4, 1.5
    expected = 4 * math.asin(a * b / math.sqrt((a * a + d * d) * (b * b + d * d)))
    _, _, _, density = samples(tables([ground, ceiling(lamp(1, 1, 1))]))
    assert (1 / density).mean() == pytest.approx(expected, abs=4 * (1 / density).std() / math.sqrt(COUNT))
    radius = math.radians(20)
    _, _, _, density = samples(tables([ground], [Sun((1, 2, 3), (1, 1, 1), 20.0)]))
    np.testing.assert_allclose(1 / density, 2 * math.pi * (1 - math.cos(radius)), rtol=1e-9)


def test_lamps_shine_to_the_front_or_to_both_sides(quad: Quad, ground: Instance) -> None:
    def upward(**given: bool) -> Instance:
        return quad((-1, 1, 1), (2, 0, 0), (0, 0, -2), lamp(5, 5, 5, **given))

    assert_irradiance(tables([ground, upward()]), BLACK)
    assert_irradiance(tables([ground, upward(two_sided=True)]), [5 * math.pi * under_rectangle(2, 2, 1)] * 3)


def test_a_textured_lamp_shines_as_its_texture_says(ground: Instance, ceiling: Quad) -> None:
    half = np.zeros((1, 64, 3), np.uint8)
    half[:, 16:48] = 255
    expected = 4 * math.pi * under_rectangle(1, 0.8, 1.5)
    # Half a texel is blurred at either edge.
    found = tables([ground, ceiling(lamp(4, 4, 4, emission_texture=half))])
    direction, _, light, _ = samples(found)
    np.testing.assert_allclose((light * direction[:, [1]]).mean(0), expected, rtol=0.02)


def test_holes_in_a_lamp_do_not_shine(ground: Instance, ceiling: Quad) -> None:
    mask = np.full((1, 64, 4), 255, np.uint8)
    mask[:, :16, 3] = mask[:, 48:, 3] = 0
    found = tables([ground, ceiling(lamp(4, 4, 4, base_texture=mask, alpha_cutoff=0.5))])
    assert_irradiance(found, [4 * math.pi * under_rectangle(1, 0.8, 1.5)] * 3)


@pytest.mark.parametrize("radius", [0.0, 0.25, 20.0])
def test_a_sun_has_its_irradiance(ground: Instance, radius: float) -> None:
    sun = Sun((1.0, 2.0, 2.0), (3.0, 2.0, 1.0), radius)
    assert_irradiance(tables([ground], [sun]), np.multiply((3.0, 2.0, 1.0), 2 / 3))
    direction, distance, _, density = samples(tables([ground], [sun]))
    assert (distance == math.inf).all()
    cosine = direction @ (1 / 3, 2 / 3, 2 / 3)
    assert cosine.min() >= math.cos(math.radians(radius)) - 1e-12
    assert (density > 0.0).all() == (radius > 0.0)


def test_a_point_light_falls_with_the_square_of_the_distance(ground: Instance) -> None:
    light = PointLight((1.0, 2.0, 2.0), (9.0, 18.0, 27.0))
    assert_irradiance(tables([ground], [light]), np.multiply((1.0, 2.0, 3.0), 2 / 3))
    assert_irradiance(tables([ground], [light]), np.multiply((9.0, 18.0, 27.0), 2 / 12**1.5), (-1.0, 0.0, 0.0))


def test_a_point_light_fades_out_at_its_reach(ground: Instance) -> None:
    for reach, share in ((4.0, 1 - 0.5**4), (2.0, 0.0), (1.0, 0.0)):
        light = PointLight((0.0, 2.0, 0.0), (4.0, 4.0, 4.0), reach=reach)
        assert_irradiance(tables([ground], [light]), [share] * 3)


def test_a_spot_fades_from_its_inner_to_its_outer_angle(ground: Instance) -> None:
    spot = PointLight((0.0, 1.0, 0.0), (1.0, 1.0, 1.0), (0.0, -1.0, 0.0), 20.0, 40.0)
    for degrees in (0.0, 19.0, 25.0, 35.0, 39.9, 41.0, 80.0):
        cosine = math.cos(math.radians(degrees))
        inner, outer = math.cos(math.radians(20.0)), math.cos(math.radians(40.0))
        share = min(max((cosine - outer) / (inner - outer), 0.0), 1.0) ** 2
        place = (math.tan(math.radians(degrees)), 0.0, 0.0)
        assert_irradiance(tables([ground], [spot]), [share * cosine**3] * 3, place)


def test_a_sky_with_a_band_has_its_irradiance(ground: Instance) -> None:
    rows = np.zeros((720, 4, 3), np.float32)
    rows[80:240] = (1.0, 2.0, 3.0)
    expected = math.pi * (math.sin(math.radians(60)) ** 2 - math.sin(math.radians(20)) ** 2)
    direction, _, light, _ = samples(tables([ground], sky=Environment(rows)))
    arriving = light * np.maximum(direction[:, [1]], 0.0)
    np.testing.assert_allclose(arriving.mean(0), np.multiply((1, 2, 3), expected), rtol=0.01)


def test_all_kinds_of_light_add_up(ground: Instance, ceiling: Quad) -> None:
    lights = [
        Sun((1.0, 2.0, 2.0), (3.0, 0.0, 0.0), 1.0),
        Sun((1.0, 2.0, -2.0), (0.0, 3.0, 0.0), 0.0),
        PointLight((1.0, 2.0, 2.0), (0.0, 0.0, 27.0)),
        PointLight((1.0, 2.0, 2.0), (0.0, 0.0, 54.0)),
    ]
    found = tables([ground, ceiling(lamp(1, 1, 1))], lights, Environment(np.ones((16, 32, 3), np.float32)))
    assert len(found.lights.kinds) == 4
    assert_irradiance(found, np.add((2.0, 2.0, 6.0), math.pi * (1 + under_rectangle(2, 0.8, 1.5))))


@pytest.mark.parametrize("density", [0.0, 0.1, 10.0])
def test_paths_that_find_a_light_weigh_it_by_what_it_is_sampled_with(
    ground: Instance, ceiling: Quad, density: float
) -> None:
    sky = Environment(np.random.default_rng(3).random((8, 16, 3)).astype(np.float32))
    suns = [Sun((1, 2, 3), (1, 1, 1), 5.0), Sun((-1, 2, 3), (2, 1, 1), 2.0)]
    for found in (tables([ground], sky=sky), tables([ground], suns)):
        direction, _, light, sampled = samples(found)
        for n in range(0, COUNT, 500):
            seen = outside_radiance(found.lights, found.sky, tuple(direction[n].tolist()), density)
            weight = mis_weight(density, sampled[n])
            np.testing.assert_allclose(seen, light[n] * sampled[n] * weight, rtol=1e-5, atol=1e-9)
    found = tables([ceiling(lamp(1, 1, 1)), ground], suns)
    direction, distance, _, sampled = samples(found)
    for n in np.flatnonzero(np.isfinite(distance))[::500]:
        assert lamp_density(found.lights, 0, direction[n, 1], distance[n]) == pytest.approx(sampled[n], rel=1e-6)


def test_both_weights_of_an_estimate_add_up_to_1() -> None:
    assert mis_weight(2.0, 3.0) + mis_weight(3.0, 2.0) == pytest.approx(1.0)
    assert mis_weight(0.0, 3.0) == mis_weight(3.0, 0.0) == 1.0


@pytest.mark.parametrize("radius", [0.02, 0.25, 5.0])
def test_a_sun_is_as_large_as_it_is_bright(ground: Instance, radius: float) -> None:
    """Rays are single precision: of those about its edge as many find it as should."""
    found = tables([ground], [Sun((1.0, 2.0, 2.0), (1.0, 1.0, 1.0), radius)])
    random, middle = np.random.default_rng(1), np.array((1.0, 2.0, 2.0)) / 3
    across = np.array([(2.0, 0.0, -1.0), (2.0, -5.0, 4.0)]) / [[math.sqrt(5)], [math.sqrt(45)]]
    offset = random.uniform(-2, 2, (4000, 2)) * math.radians(radius)
    direction = middle + offset @ across
    direction = (direction / np.linalg.norm(direction, axis=1, keepdims=True)).astype(np.float32).astype(np.float64)
    seen = [max(outside_radiance(found.lights, found.sky, tuple(way), 0.0)) > 0.0 for way in direction.tolist()]
    inside = np.tan(np.radians(radius)) > np.linalg.norm(offset, axis=1)
    assert np.mean(seen == inside) > 0.995


def test_a_lamp_that_is_dimmed_and_a_light_that_moves_change_with_time(ground: Instance, ceiling: Quad) -> None:
    switched = lamp(4, 4, 4, brightness=Track([0.0, 1.0], [[1.0], [0.0]]))
    passing = PointLight((0, 2, 0), (4, 4, 4), motion=Motion.sliding([0.0, 1.0], [(0, 0, 0), (0, 2, 0)]))
    scene = Scene([ground, ceiling(switched)], lights=[passing])
    shine = 4 * math.pi * under_rectangle(2, 0.8, 1.5)
    for time, expected in ((0.0, shine + 1.0), (0.5, 0.5 * shine + 4 / 9), (1.0, 0.25), (9.0, 0.25)):
        assert_irradiance(scene.around((0.0, 0.0, 0.0)).at(time).tables, [expected] * 3)

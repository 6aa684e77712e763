"""What single surfaces make of light: both lobes, mirrors, glass."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from svgf_cl_tracer.bsdf import Reflection, evaluate_diffuse, evaluate_specular, reflection
from svgf_cl_tracer.camera import Camera
from svgf_cl_tracer.compiled import compiled
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.sky import Environment, sky_radiance, sky_table
from svgf_cl_tracer.textures import LINEAR
from svgf_cl_tracer.vec3 import Vec3, to_local
from tests.tracer.estimates import assert_mean, still

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
UP = (0.0, 1.0, 0.0)
GOLD = (1.0, 0.71, 0.29)
# Looks at the origin from where a mirror would show the lamp, near its edge.
AT_ORIGIN = Camera((0.2, 0.6, 0.1), (0.0, 0.0, 0.0), fov_y=0.01)
SHINE = (4.0, 2.0, 1.0)

SURFACES = {
    f"{name} {roughness}": Material(colour, metallic=metallic, roughness=roughness, ior=1.5)
    for name, colour, metallic in (("gold", GOLD, 1.0), ("coat", (0.7, 0.2, 0.1), 0.0), ("half metal", GOLD, 0.5))
    for roughness in (0.1, 0.25, 0.5, 1.0)
}
SURFACES["matt"] = Material((0.7, 0.2, 0.1))

Quad = Callable[..., Instance]
Floor = Callable[[Material], Instance]
Floats = NDArray[np.float64]


@compiled
def gather(r: Reflection, wo: Vec3, direction: Floats, light: Floats, lobes: Floats) -> None:
    """Add up what comes in along directions (N, 3), as radiance times solid angle (N, 3), reflected: (2, 3)."""
    for n in range(len(direction)):
        wi = to_local((direction[n, 0], direction[n, 1], direction[n, 2]), (0.0, 1.0, 0.0))
        diffuse, specular = evaluate_diffuse(r, wo[2], wi[2]), evaluate_specular(r, wo, wi)
        for channel in range(3):
            lobes[0, channel] += diffuse[channel] * light[n, channel]
            lobes[1, channel] += specular[channel] * light[n, channel]


def reflected(material: Material, direction: Floats, light: Floats) -> Floats:
    """What a floor reflects towards the camera by either lobe, (2, 3)."""
    r = reflection(material.base_colour, material.metallic, material.roughness, material.ior)
    toward = np.array(AT_ORIGIN.position) / np.linalg.norm(AT_ORIGIN.position)
    lobes = np.zeros((2, 3))
    gather(r, to_local(tuple(toward.tolist()), UP), direction, np.broadcast_to(light, direction.shape).copy(), lobes)
    return lobes


def midpoints(count: int) -> Floats:
    return (np.arange(count) + 0.5) / count


def assert_lobes(scene: Scene, expected: Floats) -> None:
    frame = still(scene, AT_ORIGIN, bounces=0)
    for values, lobe in zip((frame.diffuse, frame.specular), expected, strict=True):
        if lobe.any():
            assert_mean(values, lobe)
        else:
            np.testing.assert_array_equal(values, 0)


@pytest.mark.parametrize("surface", SURFACES)
def test_a_lamp_is_reflected_as_its_integral_says(floor: Floor, quad: Quad, surface: str) -> None:
    """However rough the surface: what light sampling misses reflected rays find, and nothing is counted twice."""
    lamp = quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), Material(BLACK, emission=SHINE))
    x, z = np.meshgrid(2 * midpoints(600) - 1, 0.8 * midpoints(600) - 0.4)
    place = np.stack([x, np.full_like(x, 1.5), z], -1).reshape(-1, 3)
    distance = np.linalg.norm(place, axis=1, keepdims=True)
    solid_angle = (2 / 600) * (0.8 / 600) * 1.5 / distance**3
    expected = reflected(SURFACES[surface], place / distance, solid_angle * SHINE)
    assert_lobes(Scene([floor(SURFACES[surface]), lamp]), expected)


@pytest.mark.parametrize("surface", SURFACES)
def test_a_sun_is_reflected_as_its_integral_says(floor: Floor, surface: str) -> None:
    middle, radius = np.array((-0.25, 0.6, -0.1)), math.radians(5.0)
    middle /= np.linalg.norm(middle)
    across = np.cross(middle, (1, 0, 0)) / np.linalg.norm(np.cross(middle, (1, 0, 0)))
    angle, turn = np.meshgrid(radius * midpoints(300), 2 * math.pi * midpoints(300))
    angle, turn = angle.reshape(-1, 1), turn.reshape(-1, 1)
    tilt = np.cos(turn) * across + np.sin(turn) * np.cross(middle, across)
    solid_angle = radius / 300 * 2 * math.pi / 300 * np.sin(angle)
    light = solid_angle * SHINE / (math.pi * math.sin(radius) ** 2)
    expected = reflected(SURFACES[surface], np.cos(angle) * middle + np.sin(angle) * tilt, light)
    scene = Scene([floor(SURFACES[surface])], lights=[Sun(tuple(middle), SHINE, 5.0)])
    assert_lobes(scene, expected)


@pytest.fixture(scope="module")
def sky() -> tuple[Environment, Floats, Floats]:
    """An image, directions (N, 3) all over the upper half, and what comes from each: radiance times solid angle."""
    image = np.random.default_rng(2).random((8, 16, 3)).astype(np.float32)
    image[2, 9] = 30.0
    table = sky_table(Environment(image))
    polar, turn = np.meshgrid(math.pi / 2 * midpoints(200), 2 * math.pi * midpoints(800))
    direction = np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), np.sin(polar) * np.cos(turn)], -1)
    radiance = np.array([sky_radiance(table, tuple(way)) for way in direction.reshape(-1, 3).tolist()])
    solid_angle = (math.pi / 2 / 200) * (2 * math.pi / 800) * np.sin(polar).reshape(-1, 1)
    return Environment(image), direction.reshape(-1, 3), radiance * solid_angle


@pytest.mark.parametrize("surface", SURFACES)
def test_an_image_of_the_sky_is_reflected_as_its_integral_says(
    floor: Floor, surface: str, sky: tuple[Environment, Floats, Floats]
) -> None:
    image, direction, light = sky
    assert_lobes(Scene([floor(SURFACES[surface])], sky=image), reflected(SURFACES[surface], direction, light))


def picture(quad: Quad, code: NDArray[np.uint8] | None = None) -> Instance:
    """A wall at z = -3 that shines; how bright it is tells the place across, from -4 to 4."""
    ramp = np.arange(256, dtype=np.uint8) if code is None else code
    image = np.repeat(np.repeat(ramp[None, :, None], 3, axis=2), 2, axis=0)
    return quad((-4, -4, -3), (8, 0, 0), (0, 8, 0), Material(BLACK, emission=WHITE, emission_texture=image))


def place_seen(radiance: NDArray[np.float32]) -> Floats:
    """Where on the picture's wall light of this radiance came from."""
    return (np.interp(radiance, LINEAR, np.arange(256)) + 0.5) / 32 - 4


def test_a_mirror_shows_what_a_mirrored_camera_sees(floor: Floor, quad: Quad) -> None:
    wall = picture(quad)
    mirror = floor(Material(WHITE, metallic=1.0, roughness=0.0))
    shown = still(Scene([wall, mirror]), Camera((0.3, 1.0, 2.0), (0.1, -1.0, -3.0)), (64, 64), jitter=False)
    in_mirror = shown.id == 2
    assert in_mirror.mean() > 0.3
    seen = still(Scene([wall]), Camera((0.3, -1.0, 2.0), (0.1, 1.0, -3.0), (0.0, -1.0, 0.0)), (64, 64), jitter=False)
    difference = np.abs(shown.specular - seen.emission[:, ::-1])[in_mirror]
    # Now and then a sample of the lamp lies within a lobe that is almost a mirror's, and weighs much.
    assert np.quantile(difference, 0.99) < 0.01
    np.testing.assert_array_equal(shown.diffuse, 0)
    np.testing.assert_array_equal(shown.indirect, 0)


def test_a_mirror_in_a_mirror_is_a_bounce(quad: Quad) -> None:
    """Light that was reflected twice is indirect."""
    mirror = Material(WHITE, metallic=1.0, roughness=0.0)
    down, up = quad((-9, 2, -9), (18, 0, 0), (0, 0, 18), mirror), quad((-9, 0, 9), (18, 0, 0), (0, 0, -18), mirror)
    camera = Camera((0, 1, 0), (0, 0, -0.8), fov_y=1.0)
    frame = still(Scene([down, up, picture(quad)]), camera, (16, 16))
    assert frame.direct.max() < 1e-4 < 0.1 < frame.indirect.min()
    assert still(Scene([down, up, picture(quad)]), camera, (16, 16), bounces=0).color.max() < 1e-4


def test_a_matt_surface_has_no_specular_light_and_a_metal_no_diffuse(floor: Floor) -> None:
    for material, name in ((Material(), "specular"), (Material(metallic=1.0, roughness=0.5), "diffuse")):
        frame = still(Scene([floor(material)], sky=WHITE, lights=[Sun(UP, WHITE)]), AT_ORIGIN, (32, 32))
        np.testing.assert_array_equal(getattr(frame, name), 0)
        assert frame.color.min() > 0


def test_light_is_counted_by_the_lobe_of_the_first_surface(floor: Floor) -> None:
    """Whatever it is reflected by on its way there."""
    matt, metal = Material(), Material(metallic=1.0, roughness=0.5)
    dome = trimesh.creation.icosphere(1, 9.0).triangles
    for first, other, name in ((matt, metal, "specular"), (metal, matt, "diffuse")):
        lamp = Instance(trimesh.creation.icosphere(1, 0.3).triangles + np.array((1, 2, 0)), Material(emission=WHITE))
        frame = still(Scene([floor(first), Instance(dome, other), lamp]), AT_ORIGIN, (32, 32), bounces=3)
        assert frame.indirect.max() > 0
        np.testing.assert_array_equal(getattr(frame, name), 0)


def slab(thickness: float, **given: object) -> Instance:
    """A pane of glass across the view, from z = -1 to the back."""
    pane = trimesh.creation.box(
        (20, 20, thickness), trimesh.transformations.translation_matrix((0, 0, -1 - thickness / 2))
    )
    return Instance(pane.triangles, Material(**({"base_colour": WHITE, "transmissive": True, "ior": 1.5} | given)))


def fresnel(degrees: float, ior: float) -> tuple[float, float]:
    """Reflectance of a smooth surface, from Fresnel's sines and tangents, and the angle of what is refracted."""
    i = math.radians(degrees)
    t = math.asin(math.sin(i) / ior)
    if degrees == 0.0:
        return ((ior - 1) / (ior + 1)) ** 2, t
    return (math.sin(i - t) ** 2 / math.sin(i + t) ** 2 + math.tan(i - t) ** 2 / math.tan(i + t) ** 2) / 2, t


@pytest.mark.parametrize("degrees", [0.0, 40.0, 65.0])
@pytest.mark.parametrize("tint", [1.0, 0.5])
def test_a_pane_reflects_and_transmits_as_the_series_of_its_reflections(degrees: float, tint: float) -> None:
    """A sky that is red before the pane and green behind it, and all the ways between its two faces."""
    image = np.zeros((64, 128, 3), np.float32)
    image[:32, :, 0], image[32:, :, 1] = 1.0, 1.0
    to_world = np.array([(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)])  # its top lies towards +z
    scene = Scene([slab(0.1, base_colour=(tint,) * 3)], sky=Environment(image, to_world))
    eye = (math.tan(math.radians(degrees)), 0.0, 0.0)
    frame = still(scene, Camera(eye, (0, 0, -1), fov_y=0.01), bounces=8)
    r, _ = fresnel(degrees, 1.5)
    transmitted = tint * (1 - r) ** 2 / (1 - r * r)
    back = r + tint * (1 - r) ** 2 * r / (1 - r * r)
    assert_mean(frame.specular[..., [0, 0, 0]], back, precision=0.03)
    assert_mean(frame.specular[..., [1, 1, 1]], transmitted)
    np.testing.assert_array_equal(frame.diffuse, 0)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0])
def test_a_pane_shifts_what_is_behind_it_as_snell_says(quad: Quad, degrees: float) -> None:
    eye = (math.tan(math.radians(degrees)), 0.0, 0.0)
    camera = Camera(eye, (0, 0, -1), fov_y=0.01)
    frame = still(Scene([slab(0.5), picture(quad)]), camera, (64, 64))
    _, inside = fresnel(degrees, 1.5)
    straight = -2 * math.tan(math.radians(degrees))
    expected = straight + 0.5 * (math.tan(math.radians(degrees)) - math.tan(inside))
    direct = frame.specular[frame.specular[..., 0] > 0.0]
    np.testing.assert_allclose(np.median(place_seen(direct)), expected, atol=0.01)


def test_glass_like_the_air_cannot_be_seen(quad: Quad, floor: Floor) -> None:
    wall = picture(quad)
    ball = Instance(trimesh.creation.icosphere(3).triangles, Material(WHITE, transmissive=True, ior=1.0))
    camera = Camera((0, 0, 3), (0, 0, 0))
    without = still(Scene([wall]), camera, (64, 64)).color
    behind = still(Scene([wall, ball]), camera, (64, 64))
    assert (behind.id == 2).mean() > 0.2
    np.testing.assert_allclose(behind.color, without, atol=1e-4)
    # Nor does it keep light from a floor below, by either way in, even at the last surface.
    for bounces in (0, 1):
        lit = still(Scene([floor(Material()), ball], sky=WHITE), AT_ORIGIN, (32, 32), bounces=bounces).color
        np.testing.assert_allclose(lit, 0.8, rtol=1e-4)


def test_hit_distance_is_the_way_to_the_next_surface(floor: Floor, quad: Quad) -> None:
    ceiling = quad((-50, 2, -50), (100, 0, 0), (0, 0, 100), Material(BLACK, emission=WHITE))
    camera = Camera((0.5, 0.6, 0.0), (0.0, 0.0, 0.0), fov_y=0.01)
    for bounces in (0, 1):
        frame = still(Scene([floor(Material()), ceiling]), camera, bounces=bounces)
        diffuse, specular = np.moveaxis(frame.hit_distance, -1, 0)
        np.testing.assert_array_equal(specular, 0)
        assert diffuse.min() > 2 * (1 - 1e-3)
        # Directions spread as the cosine: its mean is 2/3.
        assert_mean(np.repeat(2 / diffuse[..., None], 3, -1), 2 / 3)
        mirror = still(Scene([floor(Material(metallic=1.0, roughness=0.0)), ceiling]), camera, bounces=bounces)
        np.testing.assert_array_equal(mirror.hit_distance[..., 0], 0)
        np.testing.assert_allclose(np.median(mirror.hit_distance[..., 1]), 2 * math.hypot(0.5, 0.6) / 0.6, rtol=1e-3)


@pytest.mark.parametrize("bounces", [0, 1])
def test_hit_distance_does_not_hang_on_whether_the_scene_has_lamps(floor: Floor, quad: Quad, bounces: int) -> None:
    ceiling = quad((-50, 2, -50), (100, 0, 0), (0, 0, 100), Material())
    frame = still(Scene([floor(Material()), ceiling], sky=WHITE), AT_ORIGIN, (32, 32), bounces=bounces)
    assert frame.hit_distance[..., 0].min() > 1.9


def test_hit_distance_is_0_in_the_lobe_that_was_not_sampled_and_infinite_to_the_sky(floor: Floor) -> None:
    scene = Scene([floor(Material(ior=1.5, roughness=0.3))], sky=WHITE)
    found = still(scene, AT_ORIGIN).hit_distance
    assert ((found == 0) | (found == np.inf)).all()
    assert not (found == np.inf).all(-1).any()
    assert 0.05 < (found[..., 1] == np.inf).mean() < 0.95
    up = still(scene, Camera((0, 1, 0), (0, 2, 0.1)), (4, 4))
    np.testing.assert_array_equal(up.hit_distance, 0)


@pytest.mark.parametrize("place", [0.0, 1e3])
def test_a_body_far_from_the_origin_looks_the_same(place: float) -> None:
    """But for the noise: points keep their digits, rays leave their surface, and shadows touch what casts them."""
    offset = np.array((place, place / 2, -place))
    ball = Instance(trimesh.creation.icosphere(4).triangles + offset, Material(WHITE))
    camera = Camera(tuple(offset + np.array((0, 0, 5))), tuple(offset), fov_y=15.0)
    color = still(Scene([ball], sky=WHITE), camera, (64, 64), bounces=3).color
    np.testing.assert_allclose(color, 1.0, rtol=1e-4)


def test_a_speck_far_away_changes_nothing(floor: Floor) -> None:
    """How far rays are lifted off a surface hangs on that surface, not on all that the scene holds."""
    ball = Instance(trimesh.creation.icosphere(3, 0.5).triangles + np.array((0, 0.5, 0)), Material())
    speck = Instance(trimesh.creation.icosphere(0).triangles + 1e5, Material(BLACK))
    camera = Camera((0, 1, 3), (0, 0.4, 0))
    alone, beside = (
        still(Scene([floor(Material()), ball, *more], lights=[Sun((1, 1, 0), WHITE)], sky=WHITE), camera, (64, 64))
        for more in ([], [speck])
    )
    np.testing.assert_array_equal(beside.color, alone.color)

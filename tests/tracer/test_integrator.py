"""Whole paths against closed forms, and against the converged image of another renderer."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from svgf_cl.frame import CHANNELS
from svgf_cl_tracer import Camera, CameraPath, Shot, builtin_scene, integrator, load_scene, render_frame
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion
from svgf_cl_tracer.paths import Paths
from svgf_cl_tracer.scene import Scene
from svgf_cl_tracer.sky import Environment
from svgf_cl_tracer.trees import Hits, Trees
from tests.tracer.estimates import AT_ORIGIN, assert_mean, still, under_rectangle

CORNELL = Path(__file__).parents[3] / "shared" / "scenes" / "cornell_box"

ALBEDO = (0.5, 0.25, 0.75)
MATT = Material(ALBEDO)
SKY = (1.0, 2.0, 3.0)
BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
AT_BALL = Camera((0, 0, 5), (0, 0, 0), fov_y=15.0)

ROUGHNESSES = (0.0, 0.1, 0.3, 0.6, 1.0)
# Surfaces that reflect all light.
WHITES = {f"metal {r}": Material(WHITE, metallic=1.0, roughness=r) for r in ROUGHNESSES}
WHITES |= {f"coated {r}": Material(WHITE, roughness=r, ior=1.5) for r in ROUGHNESSES}
WHITES["matt"] = Material(WHITE)

Quad = Callable[..., Instance]
Floor = Callable[[Material], Instance]


def ball(material: Material, *, smooth: bool = False) -> Instance:
    mesh = trimesh.creation.icosphere(4 if smooth else 3)
    return Instance(mesh.triangles, material, mesh.vertex_normals[mesh.faces] if smooth else None)


def corner(quad: Quad, material: Material) -> list[Instance]:
    """A floor and two walls, open to where the camera is."""
    return [
        quad((-1, 0, 1), (2, 0, 0), (0, 0, -2), material),
        quad((-1, 0, -1), (2, 0, 0), (0, 1, 0), material),
        quad((-1, 0, 1), (0, 0, -2), (0, 1, 0), material),
    ]


def box(material: Material) -> Instance:
    """A closed box around the origin, fronts inwards."""
    return Instance(trimesh.creation.box((4, 2, 3)).triangles[:, ::-1], material)


def test_a_plane_under_a_constant_sky_reflects_its_albedo(floor: Floor) -> None:
    frame = still(Scene([floor(MATT)], sky=SKY), AT_ORIGIN, (9, 9), bounces=0)
    np.testing.assert_allclose(frame.direct, np.broadcast_to(np.multiply(ALBEDO, SKY), (9, 9, 3)), rtol=1e-6)
    np.testing.assert_array_equal(frame.indirect, 0)


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_a_convex_body_reflects_only_the_sky(bounces: int) -> None:
    frame = still(Scene([ball(MATT)], sky=SKY), AT_BALL, (32, 32), bounces=bounces)
    assert (frame.id == 1).all()
    np.testing.assert_allclose(frame.color, np.broadcast_to(np.multiply(ALBEDO, SKY), (32, 32, 3)), rtol=1e-5)


@pytest.mark.parametrize("material", WHITES)
def test_a_white_body_cannot_be_seen_before_a_white_sky(material: str) -> None:
    frame = still(Scene([ball(WHITES[material])], sky=WHITE), AT_BALL, bounces=0)
    assert_mean(frame.color, 1.0, precision=0.003)


@pytest.mark.parametrize("material", WHITES)
def test_a_white_corner_cannot_be_seen_before_a_white_sky(quad: Quad, material: str) -> None:
    scene = Scene(corner(quad, WHITES[material]), sky=WHITE)
    frame = still(scene, Camera((3, 3, 3), (0, 0.3, 0), fov_y=30.0), (100, 100), bounces=64)
    assert frame.color.mean() == pytest.approx(1.0, abs=0.01)


def test_smooth_glass_cannot_be_seen_before_a_white_sky() -> None:
    glass = Material(WHITE, transmissive=True, ior=1.5)
    for smooth in (False, True):
        color = still(Scene([ball(glass, smooth=smooth)], sky=WHITE), AT_BALL, (100, 100), bounces=64).color
        assert color.mean() == pytest.approx(1.0, abs=0.01)


def test_every_path_in_a_white_corner_brings_back_the_sky(quad: Quad) -> None:
    scene = Scene(corner(quad, Material(WHITE)), sky=WHITE)
    color = still(scene, Camera((3, 3, 3), (0, 0.3, 0), fov_y=30.0), (40, 40), bounces=64).color
    np.testing.assert_allclose(color, 1.0, rtol=1e-4)


@pytest.mark.parametrize("bounces", [0, 2])
@pytest.mark.parametrize("glass", [False, True])
def test_walls_that_shine_in_a_closed_box_make_a_geometric_series(bounces: int, glass: bool) -> None:
    """Glass elsewhere does not let paths be reflected more often."""
    outside = Instance(ball(Material()).corners + 9.0, Material(transmissive=glass))
    scene = Scene([box(Material(ALBEDO, emission=SKY)), outside])
    frame = still(scene, Camera((0, 0, 1), (0.3, 0.2, 0), fov_y=90.0), bounces=bounces)
    albedo = np.array(ALBEDO)
    np.testing.assert_array_equal(frame.emission, np.broadcast_to(np.float32(SKY), (200, 200, 3)))
    assert_mean(frame.direct, albedo * SKY)
    assert_mean(frame.indirect, sum(albedo ** (n + 2) for n in range(bounces)) * np.array(SKY))


@pytest.mark.parametrize("material", [name for name in WHITES if name != "matt"])
def test_shining_walls_that_are_white_reflect_all_of_it(material: str) -> None:
    """Lamps all around glossy surfaces, found both ways: sampled, and by reflected rays."""
    white = WHITES[material]
    lamps = Material(white.base_colour, SKY, metallic=white.metallic, roughness=white.roughness, ior=white.ior)
    frame = still(Scene([box(lamps)]), Camera((0, 0, 1), (0.3, 0.2, 0), fov_y=90.0), bounces=1)
    assert_mean(frame.direct, SKY)
    assert_mean(frame.indirect, SKY)


def test_a_rectangular_lamp_matches_its_form_factor(floor: Floor, quad: Quad) -> None:
    lamp = quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), Material(BLACK, emission=(10.0, 5.0, 1.0)))
    expected = np.multiply(ALBEDO, (10.0, 5.0, 1.0)) * under_rectangle(2, 0.8, 1.5)
    assert_mean(still(Scene([floor(MATT), lamp]), AT_ORIGIN, bounces=0).color, expected, precision=0.01)


def test_lamps_and_sky_add_up(floor: Floor, quad: Quad) -> None:
    lamp = quad((-0.5, 1, -0.5), (1, 0, 0), (0, 0, 1), Material(BLACK, emission=(3.0, 3.0, 3.0)))
    # The lamp hides from the floor what is behind it.
    share = under_rectangle(1, 1, 1)
    expected = np.multiply(ALBEDO, np.array(SKY) * (1 - share) + 3.0 * share)
    assert_mean(still(Scene([floor(MATT), lamp], sky=SKY), AT_ORIGIN, bounces=0).color, expected)


def test_a_lamp_is_dark_from_behind(floor: Floor, quad: Quad) -> None:
    upward = quad((-1, 1, 1), (2, 0, 0), (0, 0, -2), Material(BLACK, emission=(5.0, 5.0, 5.0)))
    scene = Scene([floor(MATT), upward])
    np.testing.assert_array_equal(still(scene, AT_ORIGIN, bounces=0).color, 0)
    np.testing.assert_array_equal(still(scene, Camera((0, 0.5, 0), (0, 1, 0.1)), (4, 4)).emission, 0)
    np.testing.assert_array_equal(still(scene, Camera((0, 1.5, 0), (0, 1, 0.1), fov_y=20.0), (4, 4)).emission, 5)


@pytest.mark.parametrize("radius", [0.0, 0.25, 10.0])
def test_a_ball_under_a_sun_follows_lambert(radius: float) -> None:
    sun = Sun((1.0, 1.0, 1.0), (3.0, 2.0, 1.0), radius)
    frame = still(Scene([ball(MATT)], lights=[sun]), AT_BALL, bounces=0)
    cosine = frame.normal @ np.float32([1 / math.sqrt(3)] * 3)
    whole = cosine > math.sin(math.radians(radius)) + 0.01  # all of the disc is above the horizon
    reflected = frame.direct[whole] / cosine[whole][:, None]
    assert_mean(reflected, np.multiply(ALBEDO, (3.0, 2.0, 1.0)) / math.pi)
    if radius == 0.0:
        np.testing.assert_allclose(reflected.std(0), 0.0, atol=1e-4)
    np.testing.assert_array_equal(frame.direct[cosine < -math.sin(math.radians(radius)) - 0.01], 0)


def test_point_and_spot_lights_follow_the_inverse_square(floor: Floor) -> None:
    point = PointLight((1.0, 2.0, 2.0), (9.0, 18.0, 27.0))
    frame = still(Scene([floor(MATT)], lights=[point]), AT_ORIGIN, (8, 8), bounces=0)
    expected = np.multiply(ALBEDO, (1.0, 2.0, 3.0)) * 2 / 3 / math.pi
    np.testing.assert_allclose(frame.color, np.broadcast_to(expected, (8, 8, 3)), rtol=1e-3)
    spot = PointLight((0.0, 2.0, 0.0), (4.0, 4.0, 4.0), (0.0, -1.0, 1.0), 30.0, 60.0)
    frame = still(Scene([floor(MATT)], lights=[spot]), AT_ORIGIN, (8, 8), bounces=0)
    fade = (math.cos(math.radians(45)) - 0.5) / (math.cos(math.radians(30)) - 0.5)
    expected = np.multiply(ALBEDO, fade**2 / math.pi)
    np.testing.assert_allclose(frame.color, np.broadcast_to(expected, (8, 8, 3)), rtol=1e-3)


def test_lights_without_extent_cast_hard_shadows(floor: Floor, quad: Quad) -> None:
    light = PointLight((0.0, 2.0, 0.0), (4.0, 4.0, 4.0))
    shade = quad((-0.5, 1, -0.5), (1, 0, 0), (0, 0, 1), Material(BLACK))
    frame = still(
        Scene([floor(MATT), shade], lights=[light]), Camera((0, 0.9, 0), (0, 0, 1e-3), fov_y=110.0), bounces=0
    )
    # Where each pixel's ray meets the floor: the shadow is twice the size of what casts it.
    y, x = (np.mgrid[:200, :200] - 99.5) / 100 * 0.9 * math.tan(math.radians(55))
    size = np.maximum(np.abs(x), np.abs(y))
    assert (frame.color[size < 0.97] == 0).all()
    assert (frame.color[size > 1.03] > 0).all()


def test_a_band_of_the_sky_has_its_closed_form(floor: Floor) -> None:
    rows = np.zeros((720, 4, 3), np.float32)
    rows[80:240] = SKY  # 20 to 60 degrees from the zenith
    expected = np.multiply(ALBEDO, SKY) * (math.sin(math.radians(60)) ** 2 - math.sin(math.radians(20)) ** 2)
    frame = still(Scene([floor(MATT)], sky=Environment(rows)), AT_ORIGIN, bounces=0)
    assert_mean(frame.color, expected, precision=0.01)


@pytest.mark.parametrize("material", [MATT, Material(WHITE, metallic=1.0, roughness=0.5)])
def test_sky_and_suns_that_overlap_add_up(floor: Floor, material: Material) -> None:
    def color(*lights: Sun, sky: float = 0.0) -> np.ndarray:
        image = Environment(np.full((8, 16, 3), sky, np.float32)) if sky else None
        return still(Scene([floor(material)], lights=lights, sky=image), AT_ORIGIN, bounces=0).color

    # Discs as bright as the sky behind them.
    suns = [Sun((0.0, 1.0, tilt), WHITE, 30.0) for tilt in (0.0, -0.2)]
    together = color(*suns, sky=1.0)
    alone = [color(suns[0]), color(suns[1]), color(sky=1.0)]
    assert_mean(together, sum(part.mean((0, 1)) for part in alone), precision=0.003)


def sheet(quad: Quad, height: float, opacity: NDArray[np.uint8], *, moving: bool = False) -> Instance:
    """A large square with an alpha mask, across the vertical; its fronts look down."""
    image = np.concatenate([np.full((*opacity.shape, 3), 128, np.uint8), opacity[..., None]], axis=2)
    material = Material(BLACK, base_texture=image, alpha_cutoff=0.5)
    return quad((-4, height, -4), (8, 0, 0), (0, 0, 8), material, Motion([]) if moving else None)


# Sheets with nothing on them, with all of it solid, and solid on one half: x < 0.
EMPTY, SOLID = np.zeros((1, 1), np.uint8), np.full((1, 1), 255, np.uint8)
HALF = np.repeat(np.array([[255, 0]], np.uint8), 32, axis=1)


@pytest.mark.parametrize("moving", [(False, False, False), (True, True, True), (False, True, False)])
def test_no_ray_of_a_path_meets_what_is_transparent(floor: Floor, quad: Quad, moving: tuple[bool, ...]) -> None:
    """Rays of the camera, of a bounce, and towards lights: the picture is the same, noise and all."""
    lamp = quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), Material(BLACK, emission=(10.0, 5.0, 1.0)))
    wall = quad((-2, 0, -2), (4, 0, 0), (0, 4, 0), MATT)
    layers = [sheet(quad, 0.1 * (n + 1), EMPTY, moving=m) for n, m in enumerate(moving)]
    bare, covered = (
        still(Scene([floor(MATT), wall, lamp, *more], lights=[Sun((1, 2, 3), WHITE)], sky=SKY), AT_ORIGIN, (64, 64))
        for more in ([], layers)
    )
    assert bare.indirect.max() > 0
    for name in ("id", "depth", "direct", "indirect"):
        np.testing.assert_allclose(getattr(covered, name), getattr(bare, name), rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("moving", [False, True])
def test_half_a_sheet_casts_half_a_shadow(floor: Floor, quad: Quad, moving: bool) -> None:
    light = PointLight((0.0, 2.0, 0.0), (4.0, 4.0, 4.0))
    layers = [sheet(quad, 1.0, HALF, moving=moving), sheet(quad, 1.1, EMPTY)]
    below = Camera((0, 0.9, 0), (0, 0, 1e-3), up=(0, 0, -1), fov_y=90.0)
    frame = still(Scene([floor(MATT), *layers], lights=[light]), below, (64, 64), bounces=0)
    assert (frame.id == 1).all()
    np.testing.assert_array_equal((frame.direct > 0).all(-1), np.arange(64) >= 32 + np.zeros((64, 1)))


def test_a_camera_sees_through_layers_to_the_first_that_is_solid(floor: Floor, quad: Quad) -> None:
    layers = [
        sheet(quad, 1.0, SOLID),
        sheet(quad, 1.5, EMPTY, moving=True),
        sheet(quad, 2.0, HALF, moving=True),
        sheet(quad, 3.0, HALF.T),
    ]
    frame = still(Scene([floor(MATT), *layers], sky=WHITE), Camera((0, 4, 0), (0, 0, 1e-3), up=(0, 0, -1)), (64, 64))
    x, y = np.meshgrid(np.arange(64) >= 32, np.arange(64) >= 32)
    # The image's top is v = 1: towards +z, at the bottom of the picture.
    np.testing.assert_array_equal(frame.id, np.where(y, 5, np.where(x, 2, 4)))
    np.testing.assert_allclose(frame.depth, np.where(y, 1, np.where(x, 3, 2)), rtol=1e-3)


def test_bounces_only_add_light() -> None:
    camera = Camera((0, 1.0, 6.8), (0, 1.0, 5.8), fov_y=19.5)
    means = [still(room(), camera, (48, 48), spp=4, bounces=bounces).color.mean() for bounces in (0, 1, 2)]
    assert means[0] < means[1] < means[2]


def room() -> Scene:
    walls = trimesh.creation.box((2, 2, 2))
    lamp = trimesh.creation.box((0.5, 0.1, 0.5))
    return Scene(
        [
            Instance(walls.triangles[walls.triangles_center[:, 2] < 0.9] + np.array((0, 1, 0)), Material()),
            Instance(lamp.triangles + np.array((0, 1.8, 0)), Material(emission=(9.0, 9.0, 9.0))),
        ]
    )


colours = st.tuples(*[st.sampled_from([0.0, 0.5, 1.0])] * 3)
materials = st.builds(
    Material,
    base_colour=colours,
    emission=colours,
    metallic=st.sampled_from([0.0, 0.5, 1.0]),
    roughness=st.sampled_from([0.0, 0.01, 0.3, 1.0]),
    ior=st.sampled_from([1.0, 1.5, 20.0]),
    transmissive=st.booleans(),
    two_sided=st.booleans(),
)
places = st.tuples(*[st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0])] * 3)
triangles = st.lists(st.tuples(places, places, places), min_size=1, max_size=4).map(np.array)
normals = st.none() | st.tuples(*[st.sampled_from([-1.0, 0.0, 1.0])] * 3)
lights = st.one_of(
    st.builds(
        Sun, st.sampled_from([(0.0, 1.0, 0.0), (1.0, 1.0, 1.0)]), colours, st.sampled_from([0.0, 1e-4, 1.0, 89.0])
    ),
    st.builds(PointLight, places, colours, reach=st.sampled_from([0.1, math.inf])),
)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(triangles, normals, materials), max_size=4), st.lists(lights, max_size=2), materials)
def test_light_is_finite_whatever_the_scene(bodies: list, lamps: list, last: Material) -> None:
    """Triangles without area, in each other, in lights; mirrors and matt ones; normals that fit nothing."""
    instances = [
        Instance(corners, material, None if normal is None else np.broadcast_to(normal, corners.shape))
        for corners, normal, material in bodies
    ]
    scene = Scene([*instances, box(last)], lights=lamps, sky=(0.1, 0.1, 0.1))
    frame = still(scene, Camera((0.7, 0.3, 1.2), (0, 0, 0), fov_y=90.0, aperture=0.1), (12, 12), bounces=4)
    for value in (frame.color, frame.albedo, frame.normal, frame.motion):
        assert np.isfinite(value).all()
    assert frame.color.min() >= 0.0
    assert ((frame.albedo >= 0.0) & (frame.albedo <= 1.0 + 1e-6)).all()


def test_paths_end_after_too_much_glass(floor: Floor) -> None:
    """They end dark, whatever else there is."""
    panes = [
        trimesh.creation.box((9, 0.1, 9), trimesh.transformations.translation_matrix((0, y, 0))) for y in range(20)
    ]
    glass = Instance(np.concatenate([pane.triangles for pane in panes]), Material(WHITE, transmissive=True))
    scene = Scene([floor(Material(WHITE)), glass], lights=[Sun((0, 1, 0), WHITE)])
    frame = still(scene, Camera((0, 25, 0), (0, 0, 0.1), fov_y=10.0), (16, 16))
    np.testing.assert_array_equal(frame.color, 0)


@pytest.mark.skipif(not CORNELL.is_dir(), reason=f"{CORNELL} is not there")
def test_the_cornell_box_matches_another_renderer() -> None:
    expected = np.load(CORNELL / "reference_tungsten_256.npy").astype(np.float32)
    camera = Camera((0, 1.0, 6.8), (0, 1.0, 5.8), fov_y=19.5)
    shot = Shot(load_scene(CORNELL / "cornell_box.glb"), (64, 64), camera_path=CameraPath.static(camera))
    color = render_frame(shot, 0, spp=128, bounces=16).color
    np.testing.assert_allclose(color.mean((0, 1)), expected.mean((0, 1)), rtol=0.01)
    blocks = color.reshape(16, 4, 16, 4, 3).mean((1, 3)) / expected.reshape(16, 16, 16, 16, 3).mean((1, 3))
    assert np.median(blocks) == pytest.approx(1.0, abs=0.01)
    assert np.percentile(np.abs(blocks - 1.0), 90) < 0.06


@pytest.mark.parametrize("name", ["cornell", "glossy", "swing", "switch"])
def test_rays_that_pass_lamps_and_glass_by_bring_nothing(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The frame is the same, to the bit, if all that paths meet is looked for."""
    shot = Shot(builtin_scene(name), (36, 64), 8)
    expected = render_frame(shot, 3, spp=2, bounces=2)
    asked: list[int] = []
    monkeypatch.setattr(integrator, "gains", lambda trees, goals, paths: every(trees, paths, asked))
    frame = render_frame(shot, 3, spp=2, bounces=2)
    assert asked
    for field in CHANNELS:
        np.testing.assert_array_equal(getattr(frame, field), getattr(expected, field))


def every(trees: Trees, paths: Paths, asked: list[int]) -> Hits:
    """What all paths meet."""
    asked.append(len(paths.pixel))
    return trees.intersect(paths.origin, paths.direction)

"""The integrator against closed forms, and against the converged image of another renderer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tracer import Camera, load_scene, render_frame, render_reference
from tracer.geometry import Instance
from tracer.materials import Material
from tracer.scene import Scene

CORNELL = Path(__file__).parents[3] / "shared" / "scenes" / "cornell_box"

ALBEDO = (0.5, 0.25, 0.75)
SKY = (1.0, 2.0, 3.0)
# Looks at one point of the floor, the origin, through a very long lens, from below all lamps.
AT_ORIGIN = Camera((0.15, 0.5, 0.2), (0.0, 0.0, 0.0), fov_y=0.01)


def under_rectangle(width: float, depth: float, height: float) -> float:
    """Form factor from a point to a rectangle straight above its normal, centred (Howell, C-11 four times)."""
    a, b = width / 2 / height, depth / 2 / height
    first = a / np.hypot(1, a) * np.arctan(b / np.hypot(1, a))
    return float(4 * (first + b / np.hypot(1, b) * np.arctan(a / np.hypot(1, b))) / (2 * np.pi))


def mean_and_error(scene: Scene, bounces: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean radiance from the floor at the origin, and its standard error."""
    color = render_reference(scene, AT_ORIGIN, (160, 160), spp=1, bounces=bounces).reshape(-1, 3)
    return color.mean(0), color.std(0) / np.sqrt(len(color))


def test_a_plane_under_a_constant_sky_reflects_its_albedo(floor: Callable[[Material], Instance]) -> None:
    frame = render_frame(Scene([floor(Material(ALBEDO))], sky=SKY), AT_ORIGIN, None, (9, 9), bounces=0)
    expected = np.broadcast_to(np.multiply(ALBEDO, SKY), (9, 9, 3))
    np.testing.assert_allclose(frame.direct, expected, rtol=1e-6)
    np.testing.assert_array_equal(frame.indirect, 0)


@pytest.mark.parametrize("bounces", [0, 1, 3])
def test_a_convex_body_reflects_only_the_sky(bounces: int) -> None:
    ball = trimesh.creation.icosphere(3)
    scene = Scene([Instance(ball.triangles, Material(ALBEDO))], sky=SKY)
    frame = render_frame(scene, Camera((0, 0, 5), (0, 0, 0), fov_y=15.0), None, (32, 32), bounces=bounces)
    assert (frame.id == 1).all()
    np.testing.assert_allclose(frame.color, np.broadcast_to(np.multiply(ALBEDO, SKY), (32, 32, 3)), rtol=1e-5)


def test_a_white_furnace_is_as_bright_as_its_sky(quad: Callable[..., Instance]) -> None:
    white = Material((1.0, 1.0, 1.0))
    walls = [
        quad((-1, 0, 1), (2, 0, 0), (0, 0, -2), white),
        quad((-1, 0, -1), (2, 0, 0), (0, 1, 0), white),
        quad((-1, 0, 1), (0, 0, -2), (0, 1, 0), white),
    ]
    scene = Scene(walls, sky=(1.0, 1.0, 1.0))
    camera = Camera((3, 3, 3), (0, 0.3, 0), fov_y=30.0)
    color = render_frame(scene, camera, None, (40, 40), bounces=64).color
    # Every path ends in the sky and brings back exactly 1.
    np.testing.assert_allclose(color, 1.0, rtol=1e-4)


def test_a_rectangular_lamp_matches_its_form_factor(
    floor: Callable[[Material], Instance], quad: Callable[..., Instance]
) -> None:
    lamp = quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), Material((0, 0, 0), emission=(10.0, 5.0, 1.0)))
    mean, error = mean_and_error(Scene([floor(Material(ALBEDO)), lamp]), bounces=0)
    expected = np.multiply(ALBEDO, (10.0, 5.0, 1.0)) * under_rectangle(2, 0.8, 1.5)
    assert (np.abs(mean - expected) < 4 * error).all()
    assert (error < 0.01 * expected).all()


def test_lamps_and_sky_add_up(floor: Callable[[Material], Instance], quad: Callable[..., Instance]) -> None:
    ground = floor(Material(ALBEDO))
    bright = quad((-0.5, 1, -0.5), (1, 0, 0), (0, 0, 1), Material((0, 0, 0), emission=(3.0, 3.0, 3.0)))
    # A black sheet of the lamp's place and size: what it hides from the sky, it does not add.
    share = under_rectangle(1, 1, 1)
    mean, error = mean_and_error(Scene([ground, bright], sky=SKY), bounces=0)
    expected = np.multiply(ALBEDO, np.array(SKY) * (1 - share) + 3.0 * share)
    assert (np.abs(mean - expected) < 4 * error).all()


def test_a_lamp_is_dark_from_behind(floor: Callable[[Material], Instance], quad: Callable[..., Instance]) -> None:
    upward = quad((-1, 1, 1), (2, 0, 0), (0, 0, -2), Material((0, 0, 0), emission=(5.0, 5.0, 5.0)))
    scene = Scene([floor(Material(ALBEDO)), upward])
    mean, _ = mean_and_error(scene, bounces=0)
    np.testing.assert_array_equal(mean, 0)
    below = render_frame(scene, Camera((0, 0.5, 0), (0, 1, 0.1)), None, (4, 4))
    above = render_frame(scene, Camera((0, 1.5, 0), (0, 1, 0.1), fov_y=20.0), None, (4, 4))
    np.testing.assert_array_equal(below.emission, 0)
    np.testing.assert_array_equal(above.emission, 5)


def test_bounces_only_add_light() -> None:
    camera = Camera((0, 1.0, 6.8), (0, 1.0, 5.8), fov_y=19.5)
    scene = corner()
    means = [render_reference(scene, camera, (48, 48), spp=4, bounces=bounces).mean() for bounces in (0, 1, 2)]
    assert means[0] < means[1] < means[2]


def corner() -> Scene:
    room = trimesh.creation.box((2, 2, 2))
    lamp = trimesh.creation.box((0.5, 0.1, 0.5))
    return Scene(
        [
            Instance(room.triangles[room.triangles_center[:, 2] < 0.9] + np.array((0, 1, 0)), Material()),
            Instance(lamp.triangles + np.array((0, 1.8, 0)), Material(emission=(9.0, 9.0, 9.0))),
        ]
    )


@pytest.mark.skipif(not CORNELL.is_dir(), reason=f"{CORNELL} is not there")
def test_the_cornell_box_matches_another_renderer() -> None:
    expected = np.load(CORNELL / "reference_tungsten_256.npy").astype(np.float32)
    scene = load_scene(CORNELL / "cornell_box.glb")
    camera = Camera((0, 1.0, 6.8), (0, 1.0, 5.8), fov_y=19.5)
    color = render_reference(scene, camera, (64, 64), spp=128, bounces=16)
    np.testing.assert_allclose(color.mean((0, 1)), expected.mean((0, 1)), rtol=0.01)
    blocks = color.reshape(16, 4, 16, 4, 3).mean((1, 3)) / expected.reshape(16, 16, 16, 16, 3).mean((1, 3))
    assert np.median(blocks) == pytest.approx(1.0, abs=0.01)
    assert np.percentile(np.abs(blocks - 1.0), 90) < 0.06

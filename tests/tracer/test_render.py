"""Frames and samples: that they are whole, the same however they are traced, and independent of each other."""

from __future__ import annotations

import math
import os
from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from svgf_cl_tracer import CameraPath, Scene, SceneError, Shot, render, render_frame, render_sequence
from svgf_cl_tracer.camera import Camera
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.materials import Material
from svgf_cl_tracer.motion import Motion, Track
from svgf_cl_tracer.render import FRAME, REFERENCE, Features, Sampler
from svgf_cl_tracer.sampling import pixel_jitter
from svgf_cl_tracer.sky import Environment
from svgf_cl_tracer.textures import LINEAR
from tests.tracer.estimates import AT_ORIGIN

SHAPE = (24, 32)
BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
CHECKS = np.full((8, 8, 4), 255, np.uint8)
CHECKS[..., 3] = 255 * (np.indices((8, 8)).sum(0) % 2)

Quad = Callable[..., Instance]
Floor = Callable[[Material], Instance]


@pytest.fixture(scope="module")
def everything(floor: Floor, quad: Quad) -> Shot:
    """A shot with all that a scene can have."""
    ball = trimesh.creation.icosphere(2, 0.6).triangles
    slide = Motion.sliding([0.0, 1.0], [(0, 0, 0), (4, 0, 0)])
    scene = Scene(
        [
            floor(Material((0.6, 0.5, 0.4), roughness=0.4, ior=1.5)),
            quad((-2, 0, -1), (4, 0, 0), (0, 2, 0), Material(base_texture=CHECKS, alpha_cutoff=0.5)),
            Instance(ball + np.array((-1, 0.6, 0)), Material(WHITE, metallic=1.0, roughness=0.2), motion=slide),
            Instance(ball + np.array((1, 0.6, 0.5)), Material(WHITE, transmissive=True, ior=1.5)),
            quad((-1, 3, -1), (2, 0, 0), (0, 0, 2), Material(BLACK, (4, 4, 4), brightness=Track([0, 1], [[1], [0]]))),
            quad((-2.2, 0, 1), (1, 0, 0), (0, 1, 0), Material(base_texture=CHECKS, alpha_cutoff=0.5), slide),
        ],
        lights=[Sun((1, 2, 1), WHITE, 2.0), PointLight((0, 2, 2), WHITE, motion=slide)],
        sky=Environment(np.random.default_rng(1).random((4, 8, 3)).astype(np.float32)),
    )
    cameras = [Camera((x, 1.5, 5), (x / 2, 0.7, 0), aperture=0.05, shutter=0.5) for x in (0.0, 1.0)]
    return Shot(scene, SHAPE, 5, CameraPath.through(cameras), fps=5.0)


@pytest.fixture(scope="module")
def lamp(floor: Floor, quad: Quad) -> Shot:
    """A floor under a lamp: every pixel shows the same point, and is an independent estimate of the same light."""
    above = quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), Material(BLACK, emission=(10.0, 5.0, 1.0)))
    scene = Scene([floor(Material(roughness=0.5, ior=1.5)), above])
    return Shot(scene, (128, 128), 5, CameraPath.static(AT_ORIGIN))


def sampler_of(shot: Shot, number: int, stream: int, *, seed: int = 0, jitter: bool = True) -> Sampler:
    return Sampler(shot, number, stream=stream, seed=seed, jitter=jitter, bounces=1)


@pytest.mark.parametrize("spp", [1, 3])
def test_a_frame_is_whole(everything: Shot, spp: int) -> None:
    frame = render_frame(everything, 1, spp=spp)
    frame.check(SHAPE)
    assert len(frame.present()) == 13
    for name, value in frame.present().items():
        assert value.flags.c_contiguous
        assert value.dtype == (np.uint32 if name == "id" else np.float32)
    assert set(np.unique(frame.id)) == {0, 1, 2, 3, 4, 6}
    for name in ("color", "direct", "indirect", "diffuse", "specular", "emission"):
        assert np.isfinite(getattr(frame, name)).all()
        assert getattr(frame, name).max() > 0.0


@pytest.mark.parametrize("spp", [1, 3])
def test_both_ways_of_splitting_light_add_up(everything: Shot, spp: int) -> None:
    frame = render_frame(everything, 1, spp=spp)
    np.testing.assert_allclose(frame.color, frame.direct + frame.indirect + frame.emission, rtol=1e-5)
    np.testing.assert_allclose(frame.color, frame.diffuse + frame.specular + frame.emission, rtol=1e-5)


def test_an_image_hangs_neither_on_the_number_of_threads_nor_on_its_tiles(
    everything: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def images() -> list[NDArray[np.float32]]:
        return list(render_frame(everything, 2, spp=2, seed=9).present().values())

    alone = images()
    for threads, tile in ((1, 1 << 14), (5, 100), (2, 7)):
        monkeypatch.setattr(os, "cpu_count", lambda threads=threads: threads)
        monkeypatch.setattr(render, "TILE", tile)
        for one, many in zip(alone, images(), strict=True):
            np.testing.assert_array_equal(one, many)


def test_a_sample_is_the_same_whichever_others_are_traced(everything: Shot) -> None:
    def sample(number: int, pixels: slice) -> NDArray[np.float32]:
        features = Features.empty(pixels.stop - pixels.start)
        light = sampler.trace(pixels, number, features)
        return np.concatenate([light.reshape(len(light), -1), features.motion], axis=1)

    sampler, whole = sampler_of(everything, 1, REFERENCE), slice(0, SHAPE[0] * SHAPE[1])
    together = [sample(number, whole) for number in range(4)]
    sampler = sampler_of(everything, 1, REFERENCE)
    for number in (3, 1):
        np.testing.assert_array_equal(sample(number, whole), together[number])
    np.testing.assert_array_equal(sample(2, slice(200, 333)), together[2][200:333])


def test_frames_samples_and_references_share_no_noise(lamp: Shot) -> None:
    def noise(stream: int, seed: int, number: int, sample: int) -> NDArray[np.float32]:
        sampler = sampler_of(lamp, number, stream, seed=seed, jitter=False)
        color: NDArray[np.float32] = sampler.trace(slice(0, lamp.shape[0] * lamp.shape[1]), sample).sum(1)
        return color[:, 0]

    first = noise(FRAME, 0, 0, 0)
    np.testing.assert_array_equal(first, noise(FRAME, 0, 0, 0))
    np.testing.assert_allclose(first, render_frame(lamp, 0, jitter=False).color[..., 0].ravel(), rtol=1e-6)
    others = [
        noise(*key)
        for key in (
            [(REFERENCE, 0, 0, sample) for sample in range(4)]
            + [(FRAME, 0, 0, sample) for sample in range(1, 4)]
            + [(FRAME, seed, 0, 0) for seed in range(1, 4)]
            + [(FRAME, 0, number, 0) for number in range(1, 4)]
        )
    ]
    # The pixels of a picture are independent of each other too.
    others += [np.roll(first, step) for step in (1, 2, 128, 129)]
    correlation = np.corrcoef([first, *others]) - np.eye(len(others) + 1)
    assert np.abs(correlation).max() < 5.0 / math.sqrt(len(first))


def test_the_gbuffer_is_the_first_samples(everything: Shot) -> None:
    one, many = (render_frame(everything, 3, spp=spp) for spp in (1, 4))
    for name in ("albedo", "normal", "depth", "motion", "id", "roughness", "hit_distance"):
        np.testing.assert_array_equal(getattr(one, name), getattr(many, name))


def test_more_samples_are_less_noisy(lamp: Shot) -> None:
    few, many = (render_frame(lamp, 0, spp=spp, jitter=False).color[..., 0].std() for spp in (1, 16))
    assert few / many == pytest.approx(4.0, rel=0.1)


def test_the_first_sample_lies_at_the_frames_offset_and_further_ones_anywhere_in_the_pixel(quad: Quad) -> None:
    ramp = np.repeat(np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 3, axis=2), 2, axis=0)
    wall = quad((-4, -4, -4), (8, 0, 0), (0, 8, 0), Material(BLACK, emission=WHITE, emission_texture=ramp))
    shot = Shot(Scene([wall]), (8, 8), 3, CameraPath.static(Camera((0, 0, 0), (0, 0, -4), fov_y=50.0)))

    def place(*samples: int, jitter: bool = True) -> NDArray[np.float64]:
        """The column that each sample of each pixel shows."""
        sampler = sampler_of(shot, 2, FRAME, jitter=jitter)
        color = np.array([sampler.trace(slice(0, 64), sample).sum(1)[:, 0] for sample in samples])
        return np.interp(color, LINEAR, np.arange(256)) * 8 / 256 / 4 * shot.camera(0).lens((8, 8)).scale

    centre = place(0, jitter=False)
    np.testing.assert_allclose(place(0) - centre, pixel_jitter(2)[0], atol=0.01)
    offset = place(*range(1, 65)) - centre
    np.testing.assert_allclose([offset.min(), offset.max()], (-0.5, 0.5), atol=0.01)
    assert offset.std() == pytest.approx(1 / math.sqrt(12), rel=0.03)


def test_a_sequence_is_its_frames(everything: Shot) -> None:
    frames = list(render_sequence(everything, seed=4))
    assert len(frames) == 5
    assert not frames[0].motion.any()
    for number in (1, 4):
        for name, value in render_frame(everything, number, seed=4).present().items():
            np.testing.assert_array_equal(getattr(frames[number], name), value)


@pytest.mark.parametrize("wrong", [{"spp": 0}, {"bounces": -1}, {"seed": -1}, {"number": -1}])
def test_numbers_out_of_range_are_named(everything: Shot, wrong: dict[str, int]) -> None:
    with pytest.raises(SceneError, match=next(iter(wrong))):
        render_frame(everything, **({"number": 0} | wrong))


def spot(quad: Quad, motion: Motion | None = None) -> Instance:
    """A square light, 0.2 wide, 8 in front of the camera."""
    return quad((-0.1, -0.1, -8), (0.2, 0, 0), (0, 0.2, 0), Material(BLACK, emission=WHITE), motion)


def spread_of(color: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean place of a picture's light and its variance, (x, y) each, in pixels from the middle."""
    light = color[..., 0].astype(np.float64) / color[..., 0].sum()
    place = np.indices(light.shape)[::-1] - (light.shape[0] - 1) / 2
    mean = (place * light).sum((1, 2))
    return mean, (place**2 * light).sum((1, 2)) - mean**2


@pytest.mark.parametrize("focus", [4.0, 16.0])
def test_a_point_out_of_focus_becomes_the_disc_of_a_thin_lens(quad: Quad, focus: float) -> None:
    camera = Camera((0, 0, 0), (0, 0, -focus), fov_y=15.0, aperture=0.5)
    shot = Shot(Scene([spot(quad)]), (32, 32), camera_path=CameraPath.static(camera))
    color = render_frame(shot, 0, spp=600).color
    scale = camera.lens((32, 32)).scale
    mean, variance = spread_of(color)
    diameter = 0.5 * abs(8 - focus) / (8 * focus) * scale
    np.testing.assert_allclose(mean, 0.0, atol=0.1)
    # A disc's variance, that of the light itself, and that of a pixel.
    expected = diameter**2 / 16 + (0.2 / 8 * scale) ** 2 / 12 + 1 / 12
    np.testing.assert_allclose(variance, expected, rtol=0.05, atol=0.1)


def test_what_is_in_focus_is_as_sharp_as_through_a_pinhole(quad: Quad) -> None:
    board = quad((-1, -1, -4), (2, 0, 0), (0, 2, 0), Material(BLACK, WHITE, emission_texture=CHECKS[..., [3, 3, 3]]))
    sharp, through_lens = (
        render_frame(
            Shot(Scene([board]), (32, 32), camera_path=CameraPath.static(Camera((0, 0, 0), (0, 0, -4), aperture=a))),
            0,
            spp=8,
        ).color
        for a in (0.0, 0.5)
    )
    assert sharp.std() > 0.1
    np.testing.assert_allclose(through_lens, sharp, atol=1e-3)


@pytest.mark.parametrize("moving", ["light", "camera"])
def test_what_moves_while_the_shutter_is_open_is_smeared_along_its_way(quad: Quad, moving: str) -> None:
    """Half a frame long: from where it is at the frame's time to half the way to the next frame's."""
    slide = Motion.sliding([0.0, 1.0], [(0, 0, 0), (1, 0, 0)]) if moving == "light" else None
    end = (0.0, 0.0, 0.0) if moving == "light" else (-1.0, 0.0, 0.0)
    path = [Camera(eye, (eye[0], 0, -8), fov_y=15.0, shutter=0.5) for eye in ((0.0, 0.0, 0.0), end)]
    shot = Shot(Scene([spot(quad, slide)]), (32, 32), 2, CameraPath.through(path), fps=1.0)
    scale = path[0].lens((32, 32)).scale / 8
    mean, variance = spread_of(render_frame(shot, 0, spp=600).color)
    np.testing.assert_allclose(mean, (0.25 * scale, 0.0), atol=0.1)
    size = (0.2 * scale) ** 2 / 12 + 1 / 12
    smear = (0.5 * scale) ** 2 / 12 * (1 - 1 / render.MOMENTS**2)
    np.testing.assert_allclose(variance, (smear + size, size), rtol=0.05, atol=0.1)


def test_an_open_shutter_changes_nothing_where_nothing_moves(lamp: Shot) -> None:
    for shutter in (0.0, 0.9):
        camera = Camera(AT_ORIGIN.position, AT_ORIGIN.look_at, fov_y=AT_ORIGIN.fov_y, shutter=shutter)
        shot = Shot(lamp.scene, lamp.shape, 5, CameraPath.static(camera))
        np.testing.assert_array_equal(render_frame(shot, 2).color, render_frame(lamp, 2).color)


def test_lights_switch_and_move_in_the_right_frame(floor: Floor, quad: Quad) -> None:
    switch = Track([0.0, 0.25, 0.5], [[1.0], [0.0], [2.0]], step=True)
    above = quad((-1, 1.5, -0.4), (2, 0, 0), (0, 0, 0.8), Material(BLACK, WHITE, brightness=switch))
    flash = Shot(Scene([floor(Material()), above]), (64, 64), 5, CameraPath.static(AT_ORIGIN), fps=8.0)
    means = [frame.color.mean() for frame in render_sequence(flash)]
    np.testing.assert_allclose(np.divide(means, means[0]), (1, 1, 0, 0, 2), rtol=0.02)
    rising = PointLight((0, 1, 0), WHITE, motion=Motion.sliding([0.0, 0.5], [(0, 0, 0), (0, 2, 0)]))
    lift = Shot(Scene([floor(Material())], lights=[rising]), (8, 8), 5, CameraPath.static(AT_ORIGIN), fps=8.0)
    means = [frame.color.mean() for frame in render_sequence(lift)]
    np.testing.assert_allclose(np.divide(means, means[0]), 1 / np.array((1, 1.5, 2, 2.5, 3)) ** 2, rtol=1e-3)

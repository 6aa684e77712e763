"""The built-in scenes show what they say: light, movement, and what is hard about each."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from svgf_cl.frame import Frame
from svgf_cl_tracer import BUILTIN, Scene, SceneError, Shot, builtin_scene, render_frame

SHAPE = (36, 64)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

scene = cache(builtin_scene)


def rendered(name: str, number: int, *, spp: int = 1, jitter: bool = True) -> Frame:
    return render_frame(Shot(scene(name), SHAPE, BUILTIN[name].frames), number, spp=spp, jitter=jitter)


def luminance(frame: Frame) -> np.ndarray:
    return np.asarray(frame.color) @ LUMINANCE


def moved(frame: Frame) -> np.ndarray:
    """Where a pixel was elsewhere a frame ago."""
    return np.hypot(frame.motion[..., 0], frame.motion[..., 1]) > 0.05


def movers(name: str) -> set[int]:
    """The ids of what has a motion."""
    return {number for number, instance in enumerate(scene(name).instances, 1) if instance.motion is not None}


@pytest.mark.parametrize("name", BUILTIN)
def test_every_scene_says_what_is_hard_and_how_many_frames_show_it(name: str) -> None:
    assert 10 < len(BUILTIN[name].hard) <= 30  # it is a caption, too
    assert 24 <= BUILTIN[name].frames <= 48


@pytest.mark.parametrize("name", BUILTIN)
def test_a_scene_is_the_same_each_time(name: str) -> None:
    def parts(made: Scene) -> list[np.ndarray | None]:
        textures = [instance.material.base_texture for instance in made.instances]
        return [part for i in made.instances for part in (i.corners, i.normals, i.uv)] + textures

    for one, other in zip(parts(scene(name)), parts(builtin_scene(name)), strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", BUILTIN)
def test_a_scene_is_lit_to_be_shown(name: str) -> None:
    assert 0.1 < luminance(rendered(name, BUILTIN[name].frames // 2, spp=8)).mean() < 2.0


@pytest.mark.parametrize("name", BUILTIN)
def test_the_camera_keeps_clear_of_everything(name: str) -> None:
    for number in (0, BUILTIN[name].frames // 2, BUILTIN[name].frames - 1):
        frame = rendered(name, number)
        assert np.asarray(frame.depth).min() > 0.5
        assert len(np.unique(frame.id)) > 5


def test_unknown_names_are_refused_with_the_known_ones() -> None:
    with pytest.raises(SceneError, match="cornell"):
        builtin_scene("teapot")


# What is hard


def test_glossy_has_every_roughness_and_much_specular_light() -> None:
    frame = rendered("glossy", 12, spp=4)
    assert len(np.unique(frame.roughness)) >= 6
    assert np.asarray(frame.specular).mean() > 0.25 * np.asarray(frame.color).mean()


def test_mirrors_show_what_no_feature_tells() -> None:
    frame = rendered("mirror", 12, spp=16)
    mirrors = np.asarray(frame.roughness) < 0.05
    assert 0.1 < mirrors.mean() < 0.4
    assert np.ptp(np.asarray(frame.albedo)[mirrors], axis=0).max() < 1e-6
    seen = np.asarray(frame.specular)[mirrors] @ LUMINANCE
    assert seen.std() > 0.5 * seen.mean()


def test_the_wall_slides_behind_columns_that_stay() -> None:
    frame = rendered("sliding", 24, jitter=False)
    slides = moved(frame)
    assert 0.4 < slides.mean() < 0.8
    assert set(frame.id[slides].tolist()) == movers("sliding")
    assert (np.asarray(frame.motion)[slides, 0] > 0).all()  # it came from the right


def test_the_lamp_is_switched_off_and_on_again_and_the_window_stays() -> None:
    before, off, again = (luminance(rendered("switch", number, spp=8)) for number in (11, 12, 24))
    assert 0 < off.mean() < 0.3 * before.mean()
    assert again.mean() == pytest.approx(before.mean(), rel=0.05)
    assert np.mean(off < 0.5 * before) > 0.8


def test_the_pendulum_swings_from_side_to_side_and_all_else_stands_still() -> None:
    frames = [rendered("swing", number, jitter=False) for number in range(6, 48, 6)]
    columns = [np.nonzero(moved(frame))[1].mean() for frame in frames]
    assert min(columns) < 0.35 * SHAPE[1]
    assert max(columns) > 0.65 * SHAPE[1]
    assert set().union(*(frame.id[moved(frame)].tolist() for frame in frames)) == movers("swing")


def test_thin_things_come_and_go_by_the_pixel() -> None:
    one, next_one = (np.asarray(rendered("fence", 12).id), np.asarray(rendered("fence", 13).id))
    edges = np.mean(one[:, 1:] != one[:, :-1])
    assert edges > 0.1
    assert np.mean(one != next_one) > 0.05
    assert sum(instance.material.alpha_cutoff is not None for instance in scene("fence").instances) == 3


def test_fireflies_fly_though_no_lamp_is_seen() -> None:
    frame = rendered("fireflies", 12)
    assert not np.asarray(frame.emission).any()
    indirect = np.asarray(frame.indirect) @ LUMINANCE
    assert indirect.max() > 50 * indirect.mean() > 0.0
    assert np.median(indirect) < 0.1 * indirect.mean()


def test_lens_and_shutter_blur_what_is_out_of_focus_and_what_moves() -> None:
    camera = scene("blur").camera_path.at(0.5)
    assert camera.aperture > 0 < camera.shutter
    one, other = (np.asarray(rendered("blur", number, jitter=False).depth) for number in (12, 13))
    assert np.mean(one != other) > 0.3
    frame = rendered("blur", 12)
    assert set(frame.id[moved(frame)].tolist()) == movers("blur")


def test_nothing_moves_in_static() -> None:
    one, later = rendered("static", 1, jitter=False), rendered("static", 20, jitter=False)
    for name in ("albedo", "normal", "depth", "id"):
        np.testing.assert_array_equal(getattr(one, name), getattr(later, name))
    assert not np.asarray(one.motion).any()
    assert not np.array_equal(one.color, later.color)


def test_contrast_spans_three_orders_of_magnitude() -> None:
    shades = luminance(rendered("contrast", 12, spp=32))
    assert np.quantile(shades, 0.99) > 1e3 * np.quantile(shades, 0.01)

"""A judge says of pictures what is wrong with them, and of right ones nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("flip_evaluator")
pytest.importorskip("skimage")

from svgf_cl import Frame
from svgf_cl.compare.judge import Findings, Judge, switches_in
from svgf_cl.compare.view import View

SHAPE = (24, 32)
RNG = np.random.default_rng(0)
# A shadow, a third of the picture, wanders over a floor; the lamp goes out before the fourth frame.
LEVELS = (1.0, 1.0, 1.0, 0.3, 0.3, 0.3)
ALBEDO = 0.4


def light(number: int) -> np.ndarray:
    """A frame's light without albedo."""
    shadow = np.broadcast_to((np.arange(SHAPE[1]) - 2 * number) % 12 < 4, SHAPE)
    return LEVELS[number] * np.where(shadow, 0.4, 1.2)


def truth(number: int) -> np.ndarray:
    return ALBEDO * light(number)[..., None] * np.ones(3)


def noisy(picture: np.ndarray) -> np.ndarray:
    return picture * RNG.gamma(400, 1 / 400, picture.shape)


def floor(number: int) -> Frame:
    return Frame(
        color=truth(number),
        normal=np.broadcast_to((0.0, 1.0, 0.0), (*SHAPE, 3)),
        depth=np.full(SHAPE, 2.0),
        motion=np.zeros((*SHAPE, 2)),
        albedo=np.full((*SHAPE, 3), ALBEDO),
        emission=np.zeros((*SHAPE, 3)),
        id=np.ones(SHAPE, np.uint32),
    )


HALVES = [(noisy(truth(number)), noisy(truth(number))) for number in range(len(LEVELS))]


def findings(pictures: list[np.ndarray], *, jitter: bool = False) -> Findings:
    judge, earlier = Judge(switches_in(HALVES)), None
    for number, picture in enumerate(pictures):
        view = View(floor(number), HALVES[number], jitter, earlier)
        judge.see(picture, view)
        earlier = view.frame, view.halves
    return judge.findings


RIGHT = [truth(number) for number in range(len(LEVELS))]


@pytest.mark.parametrize("jitter", [False, True])
def test_the_right_pictures_have_no_fault(jitter: bool) -> None:
    found = findings(RIGHT, jitter=jitter)
    assert found.psnr > 45
    assert found.ssim > 0.95
    assert max(found.temporal, found.temporal_on_surfaces) < 0.005
    assert found.bias == pytest.approx(0, abs=0.01)
    assert [found.edges, found.shadows, found.moving_shadows] == pytest.approx([1, 1, 1], abs=0.02)
    assert found.lags == (0,)


def test_light_lost_is_bias_and_nothing_else_that_lags_or_flickers() -> None:
    found = findings([0.9 * picture for picture in RIGHT])
    assert found.bias == pytest.approx(-0.1, abs=0.01)
    assert [found.shadows, found.moving_shadows] == pytest.approx([1, 1], abs=0.02)
    assert found.psnr < 35


def test_flicker_is_temporal_error() -> None:
    # As shown, 0.1 more and less by turns: where nothing is clipped the error changes by the difference.
    bright = [picture * (1.2 if number % 2 else 1.0) for number, picture in enumerate(RIGHT)]
    found = findings(bright)
    assert found.temporal > 10 * findings(RIGHT).temporal
    assert found.temporal_on_surfaces > 0.02


def test_a_mean_of_the_past_lags_and_loses_what_moves() -> None:
    pictures = [RIGHT[0]]
    for picture in RIGHT[1:]:
        pictures.append(pictures[-1] + 0.2 * (picture - pictures[-1]))
    found = findings(pictures)
    assert found.lags == (None,)
    assert found.moving_shadows < 0.7
    assert found.bias > 0.1


def test_a_blurred_shadow_loses_contrast_in_all_frames() -> None:
    flat = [np.full_like(picture, picture.mean()) for picture in RIGHT]
    found = findings(flat)
    assert [found.edges, found.shadows, found.moving_shadows] == pytest.approx([0, 0, 0], abs=0.01)


def test_nan_in_a_picture_is_nan_in_every_figure_of_all_pixels() -> None:
    broken = [picture.copy() for picture in RIGHT]
    broken[2][12, 16] = math.nan
    found = findings(broken)
    assert all(map(math.isnan, (found.psnr, found.ssim, found.flip, found.relmse, found.temporal, found.bias)))


def test_a_lamp_is_seen_to_be_switched_in_spite_of_noise() -> None:
    assert switches_in(HALVES) == [3]
    assert switches_in(HALVES[:3]) == []
    assert findings(RIGHT[:3]).lags == ()

"""A judge says of pictures what is wrong with them, and of right ones nothing."""

from __future__ import annotations

import math
from dataclasses import fields, replace

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


def judged(pictures: list[np.ndarray], *, jitter: bool = False, without: tuple[str, ...] = ()) -> Judge:
    judge, earlier = Judge(switches_in(HALVES)), None
    for number, picture in enumerate(pictures):
        view = View(replace(floor(number), **dict.fromkeys(without)), HALVES[number], jitter, earlier)
        judge.see(picture, view)
        earlier = view.frame, view.halves
    return judge


def findings(pictures: list[np.ndarray], *, jitter: bool = False) -> Findings:
    return judged(pictures, jitter=jitter).findings


RIGHT = [truth(number) for number in range(len(LEVELS))]


@pytest.mark.parametrize("jitter", [False, True])
def test_the_right_pictures_have_no_fault(jitter: bool) -> None:
    found = findings(RIGHT, jitter=jitter)
    assert found.psnr > 45
    assert found.ssim > 0.95
    assert max(found.temporal, found.temporal_on_surfaces) < 0.005
    assert found.bias == pytest.approx(0, abs=0.01)
    assert [found.edges, found.shadows, found.moving_shadows] == pytest.approx([1, 1, 1], abs=0.02)
    assert [found.relmse_trimmed, found.flicker, found.warped] == pytest.approx([0, 0, 0], abs=0.002)
    assert found.lags == (0,)
    assert all(map(math.isnan, (found.detail, found.ghost, found.unsettled)))  # all of one colour and at rest


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


def test_noise_of_pictures_changes_more_than_the_truth() -> None:
    found = findings([picture * RNG.gamma(20, 1 / 20, picture.shape) for picture in RIGHT[:3]])  # no lamp is switched
    assert min(found.flicker, found.warped) > 0.01


def test_a_mean_of_the_past_lags_and_loses_what_moves() -> None:
    pictures = [RIGHT[0]]
    for picture in RIGHT[1:]:
        pictures.append(pictures[-1] + 0.2 * (picture - pictures[-1]))
    found = findings(pictures)
    assert found.lags == (None,)
    assert found.moving_shadows < 0.7
    assert found.bias > 0.1
    assert max(found.flicker, found.warped) < -0.01


def test_a_blurred_shadow_loses_contrast_in_all_frames() -> None:
    flat = [np.full_like(picture, picture.mean()) for picture in RIGHT]
    found = findings(flat)
    assert [found.edges, found.shadows, found.moving_shadows] == pytest.approx([0, 0, 0], abs=0.01)


def box(number: int) -> np.ndarray:
    """Where a box is that moves right by 3 pixels a frame, with a rod of 2 pixels above it."""
    y, x = np.indices(SHAPE)
    left = 2 + 3 * number
    return ((y >= 8) & (x >= left) & (x < left + 10)) | ((y < 8) & (x >= left) & (x < left + 2))


def paint(number: int) -> np.ndarray:
    """Albedo of the frame: tiles on the box, which move along with it."""
    y, x = np.indices(SHAPE)
    tiles = (x - 3 * number) // 2 % 2 == y // 2 % 2
    return np.where(box(number), np.where(tiles, 0.6, 0.4), 0.1)[..., None] * np.ones(3)


def moving(pictures: list[np.ndarray]) -> Findings:
    judge, earlier = Judge(), None
    for number, picture in enumerate(pictures):
        motion = np.stack((np.where(box(number), -3.0, 0.0), np.zeros(SHAPE)), axis=-1)
        depth, ids = np.where(box(number), 1.0, 2.0), np.where(box(number), 2, 1)
        frame = replace(floor(0), albedo=paint(number), motion=motion, depth=depth, id=ids)
        view = View(frame, (paint(number), paint(number)), jitter=False, earlier=earlier)
        judge.see(picture, view)
        earlier = view.frame, view.halves
    return judge.findings


def test_what_moves_is_judged_too() -> None:
    right = [paint(number) for number in range(5)]
    found = moving(right)
    assert [found.detail, found.ghost, found.unsettled, found.flicker] == pytest.approx([1, 0, 0, 0], abs=1e-6)
    assert found.warped == pytest.approx(0, abs=1e-6)

    late = moving([right[0], *right[:-1]])  # each picture is that of the frame before
    assert 0.2 < late.ghost <= 1
    assert late.unsettled > 0.5
    assert late.detail < 0.9
    assert late.warped > 0.05


def test_curves_tell_of_each_frame() -> None:
    pictures = [picture * (1.3 if number == 4 else 1.0) for number, picture in enumerate(RIGHT)]
    curves = judged(pictures).curves
    assert {len(curve) for curve in curves.values()} == {len(RIGHT)}
    assert np.argmin(curves["psnr"]) == np.argmin(curves["ssim"]) == 4
    assert np.argmax(curves["flip"]) == np.argmax(curves["relmse"]) == 4
    assert math.isnan(curves["temporal"][0])
    assert min(curves["temporal"][4:]) > 10 * max(curves["temporal"][1:4])
    assert np.mean(curves["psnr"]) == pytest.approx(findings(pictures).psnr)


@pytest.mark.parametrize("without", [("albedo",), ("id",), ("emission",), ("albedo", "id", "emission")])
def test_frames_may_lack_fields(without: tuple[str, ...]) -> None:
    found, whole = judged(RIGHT, without=without).findings, findings(RIGHT)
    lost = {"shadows", "moving_shadows", "temporal_on_surfaces"} if {"albedo", "id"} & {*without} else set()
    for field in fields(Findings):
        expected = math.nan if field.name in lost else getattr(whole, field.name)
        assert getattr(found, field.name) == pytest.approx(expected, nan_ok=True), field.name


def test_one_reference_may_stand_for_both_halves() -> None:
    judge = Judge()
    for number, picture in enumerate(RIGHT):
        judge.see(picture, View(floor(number), (picture, picture), jitter=False))
    found = judge.findings
    assert (found.psnr, found.ssim, found.relmse, found.bias) == (math.inf, 1, 0, 0)
    assert math.isnan(found.temporal)  # what the frame before was is not known
    assert math.isnan(found.flicker)
    assert math.isnan(found.warped)


def test_nan_in_a_picture_is_nan_in_every_figure_of_all_pixels() -> None:
    broken = [picture.copy() for picture in RIGHT]
    broken[2][12, 16] = math.nan
    found = findings(broken)
    figures = found.psnr, found.ssim, found.flip, found.relmse, found.relmse_trimmed, found.temporal, found.bias
    assert all(map(math.isnan, (*figures, found.flicker, found.warped)))


def test_a_lamp_is_seen_to_be_switched_in_spite_of_noise() -> None:
    assert switches_in(HALVES) == [3]
    assert switches_in(HALVES[:3]) == []
    assert findings(RIGHT[:3]).lags == ()


def behind_gaps(pictures: list[np.ndarray], gaps: set[int]) -> Findings:
    """Of pictures some of which follow on frames that nobody knows."""
    judge, earlier = Judge(switches_in(HALVES)), None
    for number, picture in enumerate(pictures):
        judge.see(picture, View(floor(number), HALVES[number], False, None if number in gaps else earlier))
        earlier = floor(number), HALVES[number]
    return judge.findings


def test_behind_a_gap_nothing_is_followed_on() -> None:
    stuck = [RIGHT[0]] * len(RIGHT)
    assert behind_gaps(stuck, set()).lags == (None,)
    # The lamp goes out before frame 3, and what is known of that ends before frame 4: 1 and not 3 frames are counted.
    late = [*RIGHT[:3], RIGHT[2], *RIGHT[4:]]
    assert behind_gaps(late, set()).lags == (1,)
    assert behind_gaps(late, {4}).lags == (None,)
    assert behind_gaps(late, {3}).lags == ()


def test_where_every_frame_is_behind_a_gap_there_are_figures_of_single_frames_alone() -> None:
    found = behind_gaps(RIGHT, set(range(len(RIGHT))))
    over_time = found.temporal, found.temporal_on_surfaces, found.flicker, found.warped, found.moving_shadows
    assert all(map(math.isnan, over_time))
    assert found.psnr > 45
    assert found.shadows == pytest.approx(1, abs=0.02)

"""predict.cl, change.cl, update.cl and guidance.cl: a history that is corrected where the light has changed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Denoiser, Frame, Kalman
from svgf_cl.oracle.kalman import NOTHING_KNOWN
from tests import denoising
from tests.frames import SHAPE, SPLIT, changing_sequence, noise, wall
from tests.oracle import KALMAN_CASES, error_to_oracle

feed = partial(denoising.feed, kind=Kalman)
CHANGING = partial(changing_sequence, SPLIT)
NO_TEST = {"change_threshold": 1000.0}
FADING = (0.1, 0.7, 0.4, 0.6, 0.2)


def changed() -> Denoiser:
    """After the third frame of a case, in which the light on the left grows by a factor of 8."""
    case = KALMAN_CASES["Kalman, split"]
    with denoising.vector_width(case.width):
        return feed(*case.frames()[:3])[1]


def known(den: Denoiser) -> np.ndarray:
    """Where something is known of the light."""
    return den.stage("innovation_residual")[0] < NOTHING_KNOWN


def test_cases_both_keep_and_lose_history() -> None:
    assert 0.3 < np.mean(known(changed())) < 0.9


def test_cases_find_that_light_has_changed_where_it_has() -> None:
    den = changed()
    doubted, tested = den.stage("correction_doubt")[0] > 0, den.stage("facet_depth") > 0
    left = np.indices(tested.shape)[1] < tested.shape[1] // 2
    assert np.mean(doubted[tested & left]) > 0.5
    assert np.mean(doubted[tested & ~left]) < 0.2


def test_cases_test_poles_directly() -> None:
    """No pixel of even coordinates shows them: what they know of a variance over space is their own."""
    den = changed()
    names = ("expected_variance", "inverse_count", "sample_variance")
    variance, count, of_sample = (den.stage(name)[0] for name in names)
    poles = known(den) & (np.indices(SHAPE)[1] % 6 == 3)
    assert np.mean(variance[poles] > 1.01 * (count * of_sample)[poles]) > 0.5


# Root-mean-square error over all pixels, relative to the picture's mean; about three times what was measured.
# Single pixels near the threshold of the test find a change or find none.
HALVES = {"half_guides": True, "half_history": True}
FAST = {"precision": "fast"}
BOUNDS = [({}, 7e-4), (HALVES, 7e-3), (FAST, 0.12), (HALVES | FAST, 0.12)]


@pytest.mark.parametrize(("choice", "bound"), BOUNDS, ids=[" ".join(choice) or "precise" for choice, _ in BOUNDS])
def test_error_to_the_oracle(choice: dict[str, Any], bound: float) -> None:
    assert error_to_oracle(CHANGING, Kalman(), **choice) <= bound


@pytest.mark.parametrize("count", range(1, 7))
def test_what_stands_still_is_a_mean_of_so_many_frames(count: int) -> None:
    _, den = feed(*[wall()] * count)
    assert_allclose(den.stage("inverse_count"), 1 / count, rtol=1e-6)


def scattered(values: Sequence[float]) -> list[Frame]:
    """Frames of grey noise: over them each pixel has all of these values, in an order of its own."""
    order = np.random.default_rng(0).random((len(values), *SHAPE)).argsort(axis=0)
    return [wall(color=np.array(values)[order[number], None]) for number in range(len(values))]


def test_without_test_and_floor_it_converges_to_the_mean_and_its_variance() -> None:
    _, den = feed(*scattered(FADING), alpha_color=0, **NO_TEST)
    assert_allclose(den.stage("accumulated"), np.mean(FADING), rtol=1e-6)
    assert_allclose(den.stage("tone"), np.mean(np.sqrt(FADING)), rtol=1e-6)
    assert_allclose(den.stage("sample_variance"), np.var(FADING), rtol=1e-5)


def test_the_least_gain_is_kept() -> None:
    frames = scattered(FADING)
    _, den = feed(*frames, alpha_color=0.75, **NO_TEST)
    mean = frames[0].color
    for frame in frames[1:]:
        mean = 0.25 * mean + 0.75 * frame.color
    assert_allclose(den.stage("accumulated")[0], mean, rtol=1e-6)


@pytest.mark.parametrize("gain", [0.25, 1.1, 2.0, 100.0])
def test_even_light_that_changes_is_followed_at_once(gain: float) -> None:
    """A change so certain is all believed, and the history with it worth less than the new frame."""
    _, den = feed(*[wall(color=0.5)] * 8, wall(color=0.5 * gain))
    assert_allclose(den.stage("correction"), 0.5 * (gain - 1), rtol=1e-2)
    assert_allclose(den.stage("accumulated"), 0.5 * gain, rtol=1e-2)
    assert den.stage("inverse_count").min() > 0.5


def test_even_light_that_stays_is_not_corrected() -> None:
    _, den = feed(*[wall(color=0.5)] * 8)
    assert_allclose(den.stage("correction"), 0, atol=1e-6)


def test_one_bright_pixel_is_no_change_of_light() -> None:
    """It corrects nobody's history, and not its own."""
    spot = np.full((*SHAPE, 3), 0.5)
    spot[20, 18] = 1e4
    _, den = feed(*[wall(color=0.5 + 0.1 * noise(seed)) for seed in range(8)], wall(color=spot + 0.1 * noise(9)))
    away = np.ones(SHAPE, bool)
    away[20, 18] = False
    assert_allclose(den.stage("accumulated")[0][away], 0.55, atol=0.1)
    assert_allclose(den.stage("accumulated")[0][20, 18], 0.55 + 1e4 / 9, rtol=1e-2)


@pytest.mark.parametrize(
    "change", [{"depth": 3.0}, {"normal": (1.0, 0.0, 0.0)}, {"motion": (100.0, 0.0, 0.0)}, {"motion": (np.nan, 0, 0)}]
)
def test_another_surface_has_no_history(change: dict[str, Any]) -> None:
    _, den = feed(wall(), wall(), wall(color=noise(), **change))
    assert not known(den).any()
    assert_array_equal(den.stage("inverse_count"), 1)
    assert_array_equal(den.stage("accumulated"), den.stage("demodulated"))
    assert_array_equal(den.stage("expected_luminance"), -1)


def test_miss_has_no_state_and_guides_nothing() -> None:
    _, den = feed(*[wall(color=noise(), depth=np.inf)] * 3)
    for name in ("inverse_count", "sample_variance", "guidance", "guidance_1", "variance"):
        assert_array_equal(den.stage(name), 0)


def test_a_grazing_floor_is_not_guided_by_a_bright_sky() -> None:
    """So steep that the depth of nothing, 0, is within its tolerance, and a normal of nothing is at a right angle."""
    y = np.indices(SHAPE)[0]
    depth = np.where(y > 9, 60 / np.maximum(y - 9.5, 0.5), np.inf)
    pictures = [
        feed(*[wall(color=np.where((y > 9)[..., None], noise(seed), sky), depth=depth) for seed in range(3)])[0]
        for sky in (0.0, 1e10)
    ]
    assert_array_equal(pictures[1][10:], pictures[0][10:])


def test_standard_error_can_be_read_with_antialiasing_too() -> None:
    """After the frame, without copies: no later pass has taken its memory."""
    den = Denoiser(SHAPE, settings=Kalman(taa=True, standard_error=True))
    den.denoise(wall(color=noise()))
    assert (den.stage("standard_error") > 0).all()


@pytest.mark.parametrize("count", [1, 4])
def test_standard_error_is_three_roots_of_the_variance_times_albedo(count: int) -> None:
    frames = [wall(color=noise(seed), albedo=(1.0, 0.5, 0.25)) for seed in range(count)]
    _, den = feed(*frames, standard_error=True)
    expected = 3 * np.sqrt(den.stage("filtered_variance")[0]) * (np.array((1, 0.5, 0.25)) @ (0.2126, 0.7152, 0.0722))
    assert_allclose(den.stage("standard_error"), expected, rtol=1e-5)

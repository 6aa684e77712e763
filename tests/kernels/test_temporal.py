"""temporal.cl: history grows along motion while the same surface is seen, and is dropped where it is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame
from tests.denoising import feed
from tests.frames import PLAIN, SHAPE, SPLIT, bumpy_sequence, noise, only, wall
from tests.oracle import CASES

FADING = (0.1, 0.7, 0.4, 0.6, 0.2)


@pytest.mark.parametrize("case", ["plain", "full"])
def test_cases_both_keep_and_lose_history(case: str) -> None:
    length = feed(*CASES[case].frames())[1].stage("history_length")
    assert 0.5 < np.mean(length > 1) < 0.9


def lengths(*frames: Frame) -> np.ndarray:
    return feed(*frames)[1].stage("history_length")


def labelled(**given: Any) -> Frame:
    """A wall with ids."""
    return only(wall(**({"direct": 0.5, "indirect": 0.1, "albedo": 1, "emission": 0, "id": 1} | given)), SPLIT)


def test_first_frame_is_all_there_is() -> None:
    frame = bumpy_sequence(PLAIN, count=1)[0]
    _, den = feed(frame)
    assert_array_equal(den.stage("history_length"), np.isfinite(frame.depth))
    assert_array_equal(den.stage("accumulated"), den.stage("demodulated"))
    assert_array_equal(den.stage("moment_variance"), 0)


@pytest.mark.parametrize("count", range(1, 7))
def test_static_history_grows_by_one_a_frame(count: int) -> None:
    assert_array_equal(lengths(*[wall()] * count), count)


@pytest.mark.parametrize(("half", "most"), [(False, 1024), (True, 32)])
def test_history_length_stops(half: bool, most: int) -> None:
    _, den = feed(*[wall((1, 1))] * (most + 2), half_history=half)
    assert_array_equal(den.stage("history_length"), most)


def test_alpha_zero_converges_to_the_mean_and_its_variance() -> None:
    _, den = feed(*[wall(color=value) for value in FADING], alpha_color=0, alpha_moments=0)
    assert_allclose(den.stage("accumulated"), np.mean(FADING), rtol=1e-6)
    assert_allclose(den.stage("mean"), np.mean(FADING), rtol=1e-6)
    assert_allclose(den.stage("moment_variance"), np.var(FADING), rtol=1e-5)


def test_alpha_one_forgets() -> None:
    _, den = feed(*[wall(color=value) for value in FADING], alpha_color=1, alpha_moments=1)
    assert_allclose(den.stage("accumulated"), FADING[-1], rtol=1e-6)
    assert_array_equal(den.stage("moment_variance"), 0)


@pytest.mark.parametrize("dx", [-5, -1, 0, 1, 17])
@pytest.mark.parametrize("dy", [-3, 0, 1])
def test_pan_by_whole_pixels_moves_the_history(dx: int, dy: int) -> None:
    picture = wall(color=noise())
    history = feed(picture)[1].stage("level_1")[0]
    _, den = feed(picture, wall(color=0.0, motion=(dx, dy, 0.0)))
    y, x = np.indices(SHAPE) + np.array([dy, dx])[:, None, None]
    seen = (x >= 0) & (x < SHAPE[1]) & (y >= 0) & (y < SHAPE[0])
    beside = (x >= -1) & (x <= SHAPE[1]) & (y >= -1) & (y <= SHAPE[0])  # found by the search for thin geometry
    assert_array_equal(den.stage("history_length"), 1 + beside)
    assert_allclose(den.stage("accumulated")[0][seen], history[y[seen], x[seen]] / 2, rtol=1e-6)


def test_pan_by_half_a_pixel_mixes_two() -> None:
    picture = wall(color=noise())
    history = feed(picture)[1].stage("level_1")[0]
    _, den = feed(picture, wall(color=0.0, motion=(0.5, 0.0, 0.0)))
    assert_array_equal(den.stage("history_length"), 2)
    assert_allclose(den.stage("accumulated")[0][:, :-1], (history[:, :-1] + history[:, 1:]) / 4, rtol=1e-5)


def test_dolly_keeps_history_where_depth_is_expected() -> None:
    near = {"depth": 3.0, "motion": (0.0, 0.0, 1.0)}
    assert_array_equal(lengths(wall(), wall(**near)), 2)


@pytest.mark.parametrize(
    "change",
    [
        {"depth": 3.0},
        {"motion": (0.0, 0.0, 1.0)},
        {"normal": (1.0, 0.0, 0.0)},
        {"id": 2},
        {"motion": (100.0, 0.0, 0.0)},
        {"motion": (np.nan, 0.0, 0.0)},
        {"motion": (0.0, np.nan, 0.0)},
        {"motion": (0.0, -np.inf, 0.0)},
        {"motion": (0.0, 0.0, np.inf)},
        {"motion": (3e38, 0.0, 0.0)},
    ],
    ids=str,
)
def test_history_ends_where_another_surface_is_seen(change: dict[str, Any]) -> None:
    assert_array_equal(lengths(labelled(), labelled(), labelled(**change)), 1)


def test_miss_has_no_history_and_gives_none() -> None:
    assert_array_equal(lengths(wall(), wall(depth=np.inf)), 0)
    assert_array_equal(lengths(wall(depth=np.inf), wall()), 1)


def test_thin_geometry_is_found_beside_its_place() -> None:
    pole = np.where(np.arange(SHAPE[1]) == 9, 4.0, np.inf) * np.ones((SHAPE[0], 1))
    aside = wall(depth=np.roll(pole, 1, axis=1), motion=(0.0, 0.0, 0.0))
    assert_array_equal(lengths(wall(depth=pole), aside)[:, 10], 2)

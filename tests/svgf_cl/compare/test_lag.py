"""A filter that averages lags as long as its average is; one that sees the lamp does not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from svgf_cl.compare.lag import lag, response, steps

SIZE = (40, 60, 3)
ON = np.random.default_rng(2).gamma(2.0, 1.0, SIZE)
OFF = 0.1 * np.random.default_rng(3).gamma(2.0, 1.0, SIZE)
EVERYWHERE = np.ones(SIZE[:2], np.bool_)


def halves(truth: np.ndarray, seed: int, sigma: float = 0.3) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return truth * rng.gamma(1 / sigma**2, sigma**2, SIZE), truth * rng.gamma(1 / sigma**2, sigma**2, SIZE)


def test_steps_are_where_light_changes_at_once() -> None:
    assert steps([1.0, 1.05, 1.1, 0.2, 0.21, 0.9, 0.9]) == [3, 5]
    assert steps([1.0]) == steps([0.0, 0.0]) == []


@pytest.mark.parametrize(("before", "after"), [(ON, OFF), (OFF, ON)])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.9, 1.0])
def test_the_response_is_the_share_of_the_way(before: np.ndarray, after: np.ndarray, share: float) -> None:
    picture = before + share * (after - before)
    assert response(picture, (before, before), (after, after), EVERYWHERE).value == pytest.approx(share, abs=1e-9)
    noisy = response(picture, halves(before, 4), halves(after, 5), EVERYWHERE)
    assert noisy.value == pytest.approx(share, abs=0.05)


def test_only_the_pixels_asked_for_respond() -> None:
    left = EVERYWHERE & (np.arange(SIZE[1]) < 30)
    picture = np.where(left[..., None], OFF, ON)
    assert response(picture, (ON, ON), (OFF, OFF), left).value == pytest.approx(1)
    assert math.isnan(response(picture, (ON, ON), (OFF, OFF), left & ~left).value)


def test_an_exponential_average_lags_by_its_length() -> None:
    picture, responses = ON, []
    for _ in range(20):
        picture = picture + 0.2 * (OFF - picture)
        responses.append(response(picture, (ON, ON), (OFF, OFF), EVERYWHERE).value)
    assert lag(responses) == math.ceil(math.log(0.1) / math.log(0.8)) - 1 == 10


def test_who_follows_at_once_has_no_lag_and_who_never_does_none_that_is_known() -> None:
    assert lag([1.0, 1.0]) == 0
    assert lag([0.2, 0.4]) is None
    assert lag([math.nan, 0.95]) == 1

"""Bars and gaps are thin, walls and slopes are not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.compare.thin import thin, unsettled
from tests.frames import wall

SHAPE = (9, 15)
COLUMN = np.broadcast_to(np.arange(SHAPE[1]), SHAPE)
ROW = np.broadcast_to(np.arange(SHAPE[0])[:, None], SHAPE)
GREY = np.full((*SHAPE, 3), 0.5)
EVERYWHERE = np.ones(SHAPE, np.bool_)


def bar(width: int) -> np.ndarray:
    return np.isin(COLUMN, range(6, 6 + width))


def frame(where: np.ndarray, name: str) -> Frame:
    """A wall with something else there: another object, something nearer, or the sky."""
    given = {"id": ("id", 2, 1), "near": ("depth", 2.0, 4.0), "gap": ("depth", np.inf, 4.0)}
    field, there, beside = given[name]
    return wall(SHAPE, **{field: np.where(where, there, beside)})


@pytest.mark.parametrize("name", ["id", "near", "gap"])
def test_bars_and_gaps_are_thin_up_to_two_pixels(name: str) -> None:
    for width in (1, 2):
        np.testing.assert_array_equal(thin(frame(bar(width), name)), bar(width))
    np.testing.assert_array_equal(thin(frame(bar(3), name)), COLUMN == 7)
    assert not thin(frame(bar(4), name)).any()


def test_lying_bars_are_thin_too_and_dots_once() -> None:
    np.testing.assert_array_equal(thin(frame(ROW == 4, "near")), ROW == 4)
    dot = (ROW == 4) & (COLUMN == 7)
    np.testing.assert_array_equal(thin(frame(dot, "id")), dot)


def test_slopes_walls_and_the_border_are_not() -> None:
    assert not thin(wall(SHAPE, depth=2.0 * 1.3**COLUMN)).any()
    assert not thin(wall(SHAPE, id=1)).any()
    assert not thin(frame(COLUMN == 0, "near")).any()


def test_the_share_is_that_of_pixels_plainly_wrong() -> None:
    picture = GREY + np.where(COLUMN < 3, 0.2, np.where(COLUMN < 6, -0.11, 0.09))[..., None]
    assert unsettled(GREY, GREY, EVERYWHERE).value == 0
    assert unsettled(picture, GREY, EVERYWHERE).value == pytest.approx(6 / 15)
    assert unsettled(picture, GREY, COLUMN < 8).value == pytest.approx(6 / 8)
    assert math.isnan(unsettled(picture, GREY, ~EVERYWHERE).value)


def test_nan_is_wrong() -> None:
    assert unsettled(np.full_like(GREY, np.nan), GREY, EVERYWHERE).value == 1


def test_little_noise_of_the_truth_does_not_count() -> None:
    truth = GREY + np.random.default_rng(0).normal(0, 0.02, GREY.shape)
    assert unsettled(GREY, truth, EVERYWHERE).value == 0

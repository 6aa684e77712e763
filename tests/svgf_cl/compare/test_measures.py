"""Every measure has a figure, and says what is best."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from svgf_cl.compare.judge import Findings, Judge
from svgf_cl.compare.measures import MEASURES, value

IDEAL = Findings(
    psnr=math.inf,
    ssim=1.0,
    flip=0.0,
    relmse=0.0,
    relmse_trimmed=0.0,
    bias=0.0,
    temporal=0.0,
    temporal_on_surfaces=0.0,
    flicker=0.0,
    warped=0.0,
    edges=1.0,
    shadows=1.0,
    moving_shadows=1.0,
    detail=1.0,
    ghost=0.0,
    unsettled=0.0,
    lags=(0, 0),
)


def test_the_ideal_is_what_perfect_pictures_have() -> None:
    for measure in MEASURES:
        if measure.ideal is not None:
            assert value(IDEAL, measure.key) == measure.ideal
        else:
            nearly = 1.0 - 1e-9 if measure.sign > 0 else 1e-9
            assert measure.merit(value(IDEAL, measure.key)) > measure.merit(nearly)


def test_each_is_there_once_and_can_be_written() -> None:
    assert len({measure.key for measure in MEASURES}) == len(MEASURES)
    assert {measure.sign for measure in MEASURES} == {-1, 0, 1}
    for measure in MEASURES:
        assert format(value(IDEAL, measure.key), measure.spec)
        assert measure.title
        assert measure.meaning


def test_curves_are_of_measures() -> None:
    assert Judge().curves.keys() <= {measure.key for measure in MEASURES}


@pytest.mark.parametrize(("lags", "longest"), [((0, 3, 1), 3), ((2, None), math.inf), ((7,), 7)])
def test_the_longest_lag_counts(lags: tuple[int | None, ...], longest: float) -> None:
    assert value(replace(IDEAL, lags=lags), "lag") == longest


def test_without_lamps_there_is_no_lag() -> None:
    assert math.isnan(value(replace(IDEAL, lags=()), "lag"))

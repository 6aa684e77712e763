"""What is left of what was seen before."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.compare.ghost import GHOST_FRAMES, Uncovered
from svgf_cl.compare.reprojection import Reprojection
from tests.frames import wall

SHAPE = (30, 60)
COLUMN = np.broadcast_to(np.arange(SHAPE[1]), SHAPE)
RNG = np.random.default_rng(0)
WALL = 0.2 + 0.2 * RNG.random((*SHAPE, 3))
BOX = 0.6 + 0.3 * RNG.random((*SHAPE, 3))
EVERYWHERE = np.ones(SHAPE, np.bool_)
WIDTH = 20


def box(left: int) -> np.ndarray:
    return (left <= COLUMN) & (left + WIDTH > COLUMN)


def scene(left: int, step: int = 0, pan: int = 0) -> Frame:
    """A box that has moved right by `step`, before a wall that the camera has moved by `pan`."""
    motion = np.where(box(left), -step, -pan)
    return wall(SHAPE, id=np.where(box(left), 2, 1), motion=np.stack((motion, np.zeros(SHAPE)), axis=-1))


def shown(left: int) -> np.ndarray:
    return np.where(box(left)[..., None], BOX, WALL)


def noisy(picture: np.ndarray, sigma: float) -> tuple[np.ndarray, np.ndarray]:
    return picture + RNG.normal(0, sigma, picture.shape), picture + RNG.normal(0, sigma, picture.shape)


def uncovered(sigma: float = 0.0) -> Uncovered:
    """After the box has moved by 8 pixels."""
    past = Reprojection.between(scene(10), scene(18, step=8))
    return Uncovered.none(SHAPE).followed(past, noisy(shown(10), sigma))


def test_only_what_the_box_has_left_is_uncovered() -> None:
    np.testing.assert_array_equal(uncovered().lately, (COLUMN >= 10) & (COLUMN < 18))


@pytest.mark.parametrize("share", [-0.2, 0.0, 0.3, 1.0])
@pytest.mark.parametrize("sigma", [0.0, 0.1])
def test_a_ghost_is_the_share_that_was_mixed_in(share: float, sigma: float) -> None:
    picture = shown(18) + share * (shown(10) - shown(18))
    assert uncovered(sigma).left(picture, noisy(shown(18), sigma), EVERYWHERE).value == pytest.approx(
        share, abs=0.3 * sigma + 1e-9
    )


def test_noise_and_other_faults_of_a_picture_are_no_ghost() -> None:
    noise = RNG.normal(0, 0.1, (*SHAPE, 3))
    assert uncovered().left(shown(18) + noise, noisy(shown(18), 0.0), EVERYWHERE).value == pytest.approx(0, abs=0.02)
    elsewhere = np.where((COLUMN < 10)[..., None], 1.0, shown(18))
    assert uncovered().left(elsewhere, noisy(shown(18), 0.0), EVERYWHERE).value == 0


def test_what_hardly_differs_from_the_truth_leaves_no_ghost() -> None:
    faint = Uncovered(uncovered().age, noisy(shown(18) + 0.05, 0.0))
    assert math.isnan(faint.left(shown(18) + 0.04, noisy(shown(18), 0.0), EVERYWHERE).value)
    plain = Uncovered(uncovered().age, noisy(shown(18) + 0.2, 0.0))
    assert plain.left(shown(18) + 0.05, noisy(shown(18), 0.0), EVERYWHERE).value == pytest.approx(0.25)


def test_only_what_is_inside_of_surfaces_counts() -> None:
    picture = np.where((COLUMN == 17)[..., None], shown(10), shown(18))
    assert uncovered().left(picture, noisy(shown(18), 0.0), COLUMN < 17).value == 0
    assert uncovered().left(picture, noisy(shown(18), 0.0), COLUMN == 17).value == pytest.approx(1)


def test_a_ghost_is_looked_for_in_so_many_frames() -> None:
    known, still = uncovered(), Reprojection.between(scene(18), scene(18))
    for _ in range(GHOST_FRAMES - 1):
        known = known.followed(still, noisy(shown(18), 0.0))
        assert known.left(shown(10), noisy(shown(18), 0.0), EVERYWHERE).value == pytest.approx(1)
    known = known.followed(still, noisy(shown(18), 0.0))
    assert math.isnan(known.left(shown(10), noisy(shown(18), 0.0), EVERYWHERE).value)


def test_it_moves_along_with_the_surface_that_was_uncovered() -> None:
    panned = uncovered().followed(Reprojection.between(scene(18), scene(21, 3, 3)), noisy(shown(18), 0.0))
    np.testing.assert_array_equal(panned.lately, (COLUMN >= 13) & (COLUMN < 21))
    np.testing.assert_allclose(panned.old[0][:, 13:21], BOX[:, 10:18])


def test_where_nothing_comes_into_view_there_is_no_figure() -> None:
    still = Reprojection.between(scene(18), scene(18))
    found = Uncovered.none(SHAPE).followed(still, noisy(shown(18), 0.0))
    assert math.isnan(found.left(shown(10), noisy(shown(18), 0.0), EVERYWHERE).value)
    turned = Reprojection.between(scene(18), replace(scene(18), motion=np.full((*SHAPE, 2), 1e4)))
    assert not Uncovered.none(SHAPE).followed(turned, noisy(shown(18), 0.0)).lately.any()

"""Surfaces are found where motion says they were, and nowhere else."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.compare.reprojection import Reprojection
from svgf_cl.io.synthetic import room_frames
from tests.frames import wall

SHAPE = (9, 16)
COLUMN = np.broadcast_to(np.arange(SHAPE[1]), SHAPE)
PICTURE = np.random.default_rng(0).random((*SHAPE, 3))


def box(left: int, motion: float = 0.0) -> Frame:
    """A near box of 4 columns before a wall."""
    there = (left <= COLUMN) & (left + 4 > COLUMN)
    return wall(
        SHAPE,
        depth=np.where(there, 2.0, 4.0),
        id=np.where(there, 2, 1),
        motion=np.stack((np.where(there, motion, 0.0), np.zeros(SHAPE)), axis=-1),
    )


def test_what_moves_by_whole_pixels_is_found_and_the_rest_came_from_outside() -> None:
    past = Reprojection.between(wall(SHAPE), wall(SHAPE, motion=(-2.0, 0.0)))
    np.testing.assert_array_equal(past.found, COLUMN >= 2)
    assert not past.uncovered.any()
    np.testing.assert_allclose(past.warped(PICTURE)[:, 2:], PICTURE[:, :-2])


def test_between_pixels_the_picture_is_their_mean() -> None:
    past = Reprojection.between(wall(SHAPE), wall(SHAPE, motion=(0.25, 0.0)))
    np.testing.assert_array_equal(past.found[0], [*[True] * 15, False])
    np.testing.assert_allclose(past.warped(PICTURE)[:, :-1], 0.75 * PICTURE[:, :-1] + 0.25 * PICTURE[:, 1:])


@pytest.mark.parametrize("fields", [("id",), ()])
def test_what_a_box_leaves_is_uncovered(fields: tuple[str, ...]) -> None:
    """With ids, and by depth alone."""
    before, now = (replace(frame, **{} if fields else {"id": None}) for frame in (box(3), box(5, motion=-2.0)))
    past = Reprojection.between(before, now)
    uncovered = (COLUMN == 3) | (COLUMN == 4)
    np.testing.assert_array_equal(past.uncovered, uncovered)
    np.testing.assert_array_equal(past.found, ~uncovered)


@pytest.mark.parametrize(("name", "value"), [("id", 2), ("depth", 4.5), ("normal", (0.0, 1.0, 0.0))])
def test_another_surface_is_not_the_same(name: str, value: object) -> None:
    past = Reprojection.between(wall(SHAPE, **{"id": 1, name: value}), wall(SHAPE, id=1))
    assert past.uncovered.all()


def test_the_depth_that_motion_gives_is_the_expected_one() -> None:
    assert Reprojection.between(wall(SHAPE, depth=4.5), wall(SHAPE, motion=(0.0, 0.0, 0.5))).found.all()
    assert Reprojection.between(wall(SHAPE), wall(SHAPE, motion=(0.0, 0.0, 0.5))).uncovered.all()


def test_the_sky_is_neither_found_nor_uncovered() -> None:
    sky = wall(SHAPE, depth=np.inf, normal=(0.0, 0.0, 0.0))
    for before in (sky, wall(SHAPE)):
        past = Reprojection.between(before, sky)
        assert not (past.found | past.uncovered).any()


def test_the_nearest_pixel_is_one_of_the_same_surface() -> None:
    rows, columns = Reprojection.between(wall(SHAPE), wall(SHAPE, motion=(-1.8, 0.3))).nearest
    assert (rows[4, 8], columns[4, 8]) == (4, 6)
    beside = wall(SHAPE, id=np.where(COLUMN == 6, 2, 1))
    assert Reprojection.between(beside, wall(SHAPE, id=1, motion=(-1.8, 0.3))).nearest[1][4, 8] == 7


def test_a_moving_camera_finds_the_surfaces_of_a_room_again() -> None:
    for before, now in itertools.pairwise(room_frames((45, 80), 3)):
        past = Reprojection.between(before, now)
        assert past.found.mean() > 0.9
        assert not past.uncovered.any()
        depth = past.warped(before.depth[..., None])[..., 0]
        np.testing.assert_allclose(depth[past.found], (now.depth + now.motion[..., 2])[past.found], rtol=0.01)

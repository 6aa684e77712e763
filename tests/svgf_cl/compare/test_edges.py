"""Edges are where ids change, or depth by much."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl.compare.edges import interior, other
from tests.frames import wall

SHAPE = (6, 12)
COLUMN = np.broadcast_to(np.arange(SHAPE[1]), SHAPE)


@pytest.mark.parametrize(("name", "there", "here"), [("id", 2, 1), ("depth", 2.0, 4.0), ("depth", np.inf, 4.0)])
def test_pixels_on_both_sides_of_an_edge_are_not_interior(name: str, there: float, here: float) -> None:
    frame = wall(SHAPE, **{name: np.where(COLUMN < 5, there, here)})
    np.testing.assert_array_equal(interior(frame), ~np.isin(COLUMN, (4, 5)))


def test_slopes_skies_and_the_border_have_none() -> None:
    assert interior(wall(SHAPE, depth=2.0 * 1.05**COLUMN)).all()
    assert interior(wall(SHAPE, depth=np.inf)).all()


def test_what_differs_is_told_apart() -> None:
    frame = wall(SHAPE, id=np.where(COLUMN < 5, 2, 1), depth=np.where(COLUMN < 8, 2.0, 4.0))
    another, farther, nearer = other(frame, (1, 0))
    np.testing.assert_array_equal(another, COLUMN == 4)
    np.testing.assert_array_equal(farther, COLUMN == 7)
    assert not nearer.any()
    np.testing.assert_array_equal(other(frame, (-2, 0))[2], np.isin(COLUMN, (8, 9)))

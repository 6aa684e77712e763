"""What a view has to look at, with and without the frame before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.compare.view import View
from svgf_cl.io.display import display
from tests.frames import wall

SHAPE = (12, 20)
COLUMN = np.broadcast_to(np.arange(SHAPE[1]), SHAPE)
HALVES = (np.full((*SHAPE, 3), 0.2), np.full((*SHAPE, 3), 0.4))
TILES = np.where(COLUMN // 10 % 2, 0.8, 0.4)[..., None] * np.ones(3)


def tiled(motion: float = 0.0) -> Frame:
    return wall(SHAPE, id=1, albedo=TILES, emission=(0.0, 0.0, 0.0), motion=(motion, 0.0))


def view(motion: float = 0.0, *, jitter: bool = False) -> View:
    return View(tiled(motion), HALVES, jitter, (tiled(), HALVES))


def test_the_truth_is_the_mean_of_its_halves() -> None:
    np.testing.assert_allclose(view().truth, 0.3)
    np.testing.assert_allclose(view().light[0], 0.2 / TILES[..., 0])


def test_surfaces_rest_where_they_are_found_at_their_place() -> None:
    assert view().resting.all()
    assert not view(motion=1.0).resting.any()
    assert not replace(view(), earlier=(wall(SHAPE, id=2), HALVES)).resting.any()


def test_without_the_frame_before_nothing_is_known_to_rest() -> None:
    first = replace(view(), earlier=None)
    assert first.past is None
    assert not first.resting.any()
    assert not first.relit.any()


@pytest.mark.parametrize(("jitter", "margin"), [(False, 2), (True, 3)])
def test_a_texture_is_at_edges_of_albedo_that_move(jitter: bool, margin: int) -> None:
    assert not view(jitter=jitter).textured.any()
    expected = np.isin(COLUMN, (9, 10))
    expected[:margin] = expected[-margin:] = False
    np.testing.assert_array_equal(view(0.5, jitter=jitter).textured, expected)


def test_light_is_looked_at_on_one_colour_alone_where_rays_are_jittered() -> None:
    assert view().lit[6, 9]
    assert not view(jitter=True).lit[6, 9]
    assert view(jitter=True).lit[6, 5]


def test_what_is_shown_is_exposed_and_what_is_light_is_not() -> None:
    dark = replace(view(), exposure=-3.0)
    np.testing.assert_allclose(dark.shown, display(np.full((*SHAPE, 3), 0.3 / 8)))
    np.testing.assert_allclose(dark.shown_halves[1], display(HALVES[1] / 8))
    np.testing.assert_array_equal(dark.truth, view().truth)
    np.testing.assert_array_equal(dark.light[0], view().light[0])

"""Surfaces end where anything but light changes; light changes where nothing else does."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.compare import surfaces

SHAPE = (9, 12)
PLAIN: dict[str, Any] = {
    "color": np.random.default_rng(0).random((*SHAPE, 3)),
    "normal": np.broadcast_to((0.0, 0.0, 1.0), (*SHAPE, 3)),
    "depth": np.full(SHAPE, 3.0),
    "motion": np.zeros((*SHAPE, 2)),
    "albedo": np.full((*SHAPE, 3), 0.5),
    "emission": np.zeros((*SHAPE, 3)),
    "id": np.ones(SHAPE, np.uint32),
}


def changed(name: str, value: object, where: np.ndarray) -> Frame:
    """The plain frame with another value at some of its pixels."""
    there = where.reshape(*where.shape, *[1] * (PLAIN[name].ndim - 2))
    return Frame(**PLAIN | {name: np.where(there, value, PLAIN[name]).astype(PLAIN[name].dtype)})


RIGHT = np.broadcast_to(np.arange(12) >= 6, SHAPE)


def test_one_surface_is_where_its_window_shows_nothing_else() -> None:
    inside = surfaces.one_surface(Frame(**PLAIN))
    assert inside[2:-2, 2:-2].all()
    assert inside.sum() == 5 * 8
    assert surfaces.one_surface(Frame(**PLAIN), 3).sum() == 3 * 6


@pytest.mark.parametrize(
    ("name", "other"), [("normal", (1.0, 0.0, 0.0)), ("depth", np.inf), ("albedo", 0.6), ("id", 2)]
)
def test_one_surface_ends_where_anything_but_light_changes(name: str, other: object) -> None:
    found = surfaces.one_surface(changed(name, other, RIGHT))
    assert not found[:, 4:8].any()
    assert found[4, 3]


def test_colours_of_a_surface_may_be_let_through() -> None:
    assert surfaces.one_surface(changed("albedo", 0.6, RIGHT), one_colour=False)[4, 5]


@pytest.mark.parametrize(("name", "other"), [("emission", 2.0), ("depth", np.inf)])
def test_lamps_and_sky_are_left_out_with_what_touches_them(name: str, other: float) -> None:
    np.testing.assert_array_equal(surfaces.reflecting(changed(name, other, RIGHT))[4], np.arange(12) < 5)


def test_a_texture_moves_where_its_surface_does() -> None:
    moving = replace(changed("albedo", 0.6, RIGHT), motion=np.where(RIGHT[..., None], 0.0, (0.5, 0.0)))
    np.testing.assert_array_equal(surfaces.moving_texture(moving)[4], np.arange(12) == 5)
    assert not surfaces.moving_texture(changed("albedo", 0.6, RIGHT)).any()
    assert not surfaces.moving_texture(changed("motion", 0.5, RIGHT)).any()


@pytest.mark.parametrize("name", ["id", "albedo"])
def test_without_ids_or_albedo_no_surface_is_known(name: str) -> None:
    frame = replace(Frame(**PLAIN), motion=np.ones((*SHAPE, 2)), **{name: None})
    assert not surfaces.one_surface(frame).any()
    assert not surfaces.one_surface(frame, one_colour=False).any()
    assert not surfaces.moving_texture(frame).any()


def test_without_ids_nothing_is_still_and_without_emission_there_is_no_lamp() -> None:
    plain = Frame(**PLAIN)
    assert surfaces.still(plain, plain).all()
    assert not surfaces.still(replace(plain, id=None), plain).any()
    assert surfaces.reflecting(replace(plain, emission=None)).all()


def test_without_albedo_light_is_all_there_is() -> None:
    np.testing.assert_allclose(surfaces.without_albedo(np.full((*SHAPE, 3), 3.0), Frame(**PLAIN | {"albedo": None})), 3)


def test_light_is_what_is_left_without_albedo() -> None:
    frame = changed("albedo", (0.2, 0.5, 0.8), RIGHT)
    np.testing.assert_allclose(surfaces.without_albedo(3.0 * frame.albedo, frame), 3.0)


def test_light_changes_on_what_stays_and_not_by_noise() -> None:
    rng = np.random.default_rng(1)

    def halves(level: object) -> tuple[np.ndarray, np.ndarray]:
        return level + rng.normal(0, 0.02, SHAPE), level + rng.normal(0, 0.02, SHAPE)

    darker = np.where(RIGHT, 0.7, 1.0)
    here = surfaces.still(Frame(**PLAIN), Frame(**PLAIN))
    found = surfaces.relit(halves(1.0), halves(darker), here)
    assert found[4, 8]
    assert not found[4, 2:4].any()
    assert not surfaces.relit(halves(1.0), halves(1.0), here).any()
    for later in (changed("motion", 0.3, RIGHT), changed("id", 2, RIGHT)):
        moved = surfaces.still(Frame(**PLAIN), later)
        assert not surfaces.relit(halves(1.0), halves(darker), moved)[:, 4:].any()

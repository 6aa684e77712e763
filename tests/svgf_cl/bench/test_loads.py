"""Every neighbour is loaded, however often its plane is fetched."""

from __future__ import annotations

from dataclasses import replace

import pytest

from svgf_cl import Settings
from svgf_cl.bench.loads import Loads, loads
from svgf_cl.filters.pipeline import Inputs, pipeline

INPUTS = Inputs(signals=1, motion=3, albedo=True, emission=False, id=True)


def loaded(name: str, inputs: Inputs = INPUTS, settings: Settings | None = None) -> Loads:
    settings = settings or Settings(taa=True)
    (entry,) = (each for each in pipeline(inputs, settings) if each.name == name)
    return loads(entry, inputs, settings)


def test_without_neighbours_each_plane_is_loaded_once() -> None:
    assert loaded("demodulate") == Loads(4 * (3 + 3 + 3 + 1 + 1))  # color albedo normal depth id
    assert loaded("variance") == Loads(4 * 2)  # length and variance
    assert loaded("modulate") == Loads(4 * (3 + 3))


@pytest.mark.parametrize(("taps", "columns"), [("3x3", 3), ("5x5", 5)])
def test_taps_in_the_own_column_are_aligned(taps: str, columns: int) -> None:
    """Normal, depth, colour and variance at every tap, depth and variance around the pixel too."""
    settings = Settings(taps=taps)
    near = 2 * 3  # in each column, two planes
    assert loaded("atrous 3", settings=settings) == Loads(
        4 * (8 * columns + near - 2), 4 * (8 * columns * (columns - 1) + 2 * near)
    )


def test_the_nearest_taps_are_the_nearest_neighbours() -> None:
    assert loaded("atrous 1", settings=Settings(taps="3x3")) == Loads(4 * 8 * 3, 4 * 8 * 6)


def test_taps_a_whole_vector_apart_are_aligned() -> None:
    assert loaded("atrous 5", settings=Settings(taps="3x3")).offset == 4 * 2 * 6, "the pixel's neighbours are left"
    wide = [loaded(f"atrous {level}", settings=Settings(taps="5x5")).offset for level in (3, 4)]
    assert wide[0] - wide[1] == 4 * 8 * 2 * 5, "its outer columns"


def test_history_lies_anywhere() -> None:
    temporal = loaded("temporal")
    assert temporal.offset == 4 * (2 + 4 * (5 + 3 + 3))  # slope; guide, colour and moments
    assert temporal.aligned == 4 * (3 + 5 + 2 + 3)  # motion, guide, slope, colour
    assert loaded("taa").offset == 4 * (6 * (1 + 3) + 16 * 3)


def test_signals_share_what_tells_surfaces_apart() -> None:
    one, two = (loaded("atrous 3", replace(INPUTS, signals=signals)) for signals in (1, 2))
    assert one.bytes < two.bytes < 2 * one.bytes


def test_16_bits_are_half_as_many_bytes() -> None:
    full, half = (
        loaded("atrous 3", settings=Settings(half_guides=chosen, half_history=chosen)) for chosen in (False, True)
    )
    assert full.bytes - half.bytes == 2 * (9 * (3 + 3 + 1) + 8)  # normals, colour, variance and its neighbours

"""Costs follow from the pass table and the equations."""

from __future__ import annotations

from dataclasses import replace

import pytest

from svgf_cl import Kalman, Settings
from svgf_cl.bench.cost import Cost, Loads, cost
from svgf_cl.filters.signals import SPLITS, Inputs, Signal

INPUTS = Inputs(motion=3, albedo=True, id=True)
TWO = SPLITS[0]


def costs(inputs: Inputs, settings: Settings | None = None) -> dict[str, Cost]:
    settings = settings or Settings(taa=True)
    return {entry.label: cost(entry) for entry in settings.pipeline(inputs).passes}


@pytest.mark.parametrize("signals", SPLITS)
@pytest.mark.parametrize("motion", [2, 3])
@pytest.mark.parametrize("optional", [True, False])
def test_every_pass_has_a_cost(signals: tuple[Signal, ...], motion: int, optional: bool) -> None:
    inputs = Inputs(signals=signals, motion=motion, albedo=optional, emission=optional, id=optional)
    assert all(each.bytes > 0 and each.flops > 0 for each in costs(inputs).values())


def test_bytes_are_planes_read_and_written_once() -> None:
    found = costs(INPUTS, Settings())
    assert found["demodulate"].bytes == 4 * ((3 + 3 + 3 + 1 + 1) + (6 + 3))  # color albedo normal depth id; guide c
    assert found["temporal"].bytes == 4 * ((3 + 6 + 3 + 6 + 3 + 3) + (3 + 3))
    assert found["variance"].bytes == 4 * (2 + 1)  # length and variance; variance
    assert found["atrous 1"].bytes == found["atrous 5"].bytes == 4 * ((5 + 4) + 4)  # normal depth albedo c Var; c Var
    assert found["modulate"].bytes == 4 * ((3 + 3) + 3)


def test_what_a_frame_lacks_costs_nothing() -> None:
    less = costs(replace(INPUTS, albedo=False, id=False, motion=2))
    more = costs(INPUTS)
    assert more["demodulate"].bytes - less["demodulate"].bytes == 4 * (3 + 1 + 1 + 1)  # albedo id; both in the guide
    assert more["temporal"].bytes - less["temporal"].bytes == 4 * (2 * 2 + 1)  # id and albedo twice, motion's depth
    assert all(more[name].flops >= less[name].flops for name in more)


def test_two_signals_share_the_geometry() -> None:
    one, two = costs(INPUTS)["atrous 1"], costs(replace(INPUTS, signals=TWO))["atrous 1"]
    assert one.flops < two.flops < 2 * one.flops
    assert two.bytes - one.bytes == 4 * (4 + 4)


def test_a_level_costs_its_taps() -> None:
    """Each at least an exponential and the weighing of three colours, one variance and the weight."""
    for taps, count in (("5x5", 24), ("3x3", 8)):
        level = costs(INPUTS, Settings(taps=taps))["atrous 1"]
        assert count * (14 + 10) < level.flops < count * 50 + 100
        fast = costs(INPUTS, Settings(taps=taps, precision="fast"))["atrous 1"]
        assert level.flops - fast.flops == count * (14 - 2), "an exponential a tap"


def test_16_bits_move_fewer_bytes() -> None:
    full, half = (costs(INPUTS, Settings(half_guides=chosen, half_history=chosen)) for chosen in (False, True))
    assert full["atrous 1"].bytes - half["atrous 1"].bytes == 2 * (3 + 4 + 4)  # normals, light in and out
    assert full["demodulate"].bytes - half["demodulate"].bytes == 2 * (3 + 3)
    assert full["modulate"].bytes - half["modulate"].bytes == 2 * 3


def loaded(name: str, inputs: Inputs = INPUTS, settings: Settings | None = None) -> Loads:
    return costs(inputs, settings)[name].loads


def test_without_neighbours_each_plane_is_loaded_once() -> None:
    assert loaded("demodulate") == Loads(4 * (3 + 3 + 3 + 1 + 1))  # color albedo normal depth id
    assert loaded("variance") == Loads(4 * 2)  # length and variance
    assert loaded("modulate") == Loads(4 * (3 + 3))


@pytest.mark.parametrize(("taps", "columns"), [("3x3", 3), ("5x5", 5)])
def test_taps_in_the_own_column_are_aligned(taps: str, columns: int) -> None:
    """Normal, depth, albedo, colour and variance at every tap, depth and variance around the pixel too."""
    settings = Settings(taps=taps)
    near = 2 * 3  # in each column, two planes
    assert loaded("atrous 3", settings=settings) == Loads(
        4 * (9 * columns + near - 2), 4 * (9 * columns * (columns - 1) + 2 * near)
    )


def test_the_nearest_taps_are_the_nearest_neighbours() -> None:
    assert loaded("atrous 1", settings=Settings(taps="3x3")) == Loads(4 * 9 * 3, 4 * 9 * 6)


def test_taps_a_whole_vector_apart_are_aligned() -> None:
    assert loaded("atrous 5", settings=Settings(taps="3x3")).offset == 4 * 2 * 6, "the pixel's neighbours are left"
    wide = [loaded(f"atrous {level}", settings=Settings(taps="5x5")).offset for level in (3, 4)]
    assert wide[0] - wide[1] == 4 * 9 * 2 * 5, "its outer columns"


def test_history_lies_anywhere() -> None:
    temporal = loaded("temporal")
    assert temporal.offset == 4 * (2 + 4 * (6 + 3 + 3))  # slope; guide, colour and moments
    assert temporal.aligned == 4 * (3 + 6 + 2 + 3)  # motion, guide, slope, colour
    assert loaded("taa").offset == 4 * (6 * (1 + 1 + 3) + 16 * 3)


def test_signals_share_loads_of_what_tells_surfaces_apart() -> None:
    one, two = (loaded("atrous 3", replace(INPUTS, signals=split)) for split in reversed(SPLITS))
    assert one.bytes < two.bytes < 2 * one.bytes


def test_16_bits_load_half_as_many_bytes() -> None:
    full, half = (
        loaded("atrous 3", settings=Settings(half_guides=chosen, half_history=chosen)) for chosen in (False, True)
    )
    assert full.bytes - half.bytes == 2 * (9 * (3 + 3 + 1) + 8)  # normals, colour, variance and its neighbours


def test_every_second_pixel_of_every_second_row_costs_a_quarter() -> None:
    """Of an image's pixel, on average; what is read of every pixel to make one of these counts four times."""
    passes = {entry.label: entry for entry in Kalman().pipeline(INPUTS).passes}
    mean, first = cost(passes["coarser_mean 1"]), cost(passes["innovation_mean"])
    facets, change = 1 + 2 + 3, 1 + 3 + 3
    assert mean.bytes == 4 * (facets + change + change) / 4  # facets, finer; change
    assert mean.flops == passes["coarser_mean 1"].operations / 4
    assert first.bytes == 4 * ((1 + 3) + (3 + 1) + (facets + change) / 4)  # depth, normal; innovation; both made
    assert first.loads.bytes == 4 * ((4 + 2) + 4 * 3 + 4 * (3 + 1)) / 4  # a block of each; depth's slope


def test_costs_scale() -> None:
    assert Cost(1, Loads(2, 3), 4) * 10 == Cost(10, Loads(20, 30), 40)

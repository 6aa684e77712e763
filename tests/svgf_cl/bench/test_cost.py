"""Costs follow from the pass table and the equations."""

from __future__ import annotations

from dataclasses import replace

import pytest

from svgf_cl import Settings
from svgf_cl.bench.cost import Cost, cost
from svgf_cl.bench.loads import Loads
from svgf_cl.filters.pipeline import Inputs, pipeline

INPUTS = Inputs(signals=1, motion=3, albedo=True, emission=False, id=True)


def costs(inputs: Inputs, settings: Settings | None = None) -> dict[str, Cost]:
    settings = settings or Settings(taa=True)
    return {entry.name: cost(entry, inputs, settings) for entry in pipeline(inputs, settings)}


@pytest.mark.parametrize("signals", [1, 2])
@pytest.mark.parametrize("motion", [2, 3])
@pytest.mark.parametrize("optional", [True, False])
def test_every_pass_has_a_cost(signals: int, motion: int, optional: bool) -> None:
    inputs = Inputs(signals, motion, albedo=optional, emission=optional, id=optional)
    assert all(each.bytes > 0 and each.flops > 0 for each in costs(inputs).values())


def test_bytes_are_planes_read_and_written_once() -> None:
    found = costs(INPUTS, Settings())
    assert found["demodulate"].bytes == 4 * ((3 + 3 + 3 + 1 + 1) + (5 + 3))  # color albedo normal depth id; guide c
    assert found["temporal"].bytes == 4 * ((3 + 5 + 3 + 5 + 3 + 3) + (3 + 3))
    assert found["variance"].bytes == 4 * (2 + 1)  # length and variance; variance
    assert found["atrous 1"].bytes == found["atrous 5"].bytes == 4 * ((4 + 4) + 4)  # normal depth c Var; c Var
    assert found["modulate"].bytes == 4 * ((3 + 3) + 3)


def test_what_a_frame_lacks_costs_nothing() -> None:
    less = costs(replace(INPUTS, albedo=False, id=False, motion=2))
    more = costs(INPUTS)
    assert more["demodulate"].bytes - less["demodulate"].bytes == 4 * (3 + 1 + 1)  # albedo id; id
    assert more["temporal"].bytes - less["temporal"].bytes == 4 * (1 + 1 + 1)  # id twice, motion's depth
    assert all(more[name].flops >= less[name].flops for name in more)


def test_two_signals_share_the_geometry() -> None:
    one, two = costs(INPUTS)["atrous 1"], costs(replace(INPUTS, signals=2))["atrous 1"]
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


def test_costs_scale() -> None:
    assert Cost(1, Loads(2, 3), 4) * 10 == Cost(10, Loads(20, 30), 40)

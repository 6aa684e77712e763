"""The memory of a pipeline: sizes, whose turn it is, and what marks a cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given

from svgf_cl import Inputs, Settings
from svgf_cl.device.layout import Layout
from svgf_cl.device.memory import TURNS, Memory
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.filters.pipeline import Buffer, Life, Pipeline
from svgf_cl.filters.temporal import UNKNOWN
from tests.svgf_cl.filters.strategies import every_pipeline

LAYOUT = Layout(53, 37)


@given(every_pipeline)
def test_what_a_frame_writes_of_a_pair_is_what_the_next_one_finds(pipeline: Pipeline) -> None:
    memory = Memory(LAYOUT, memory_slots(pipeline))
    for resource in pipeline.lasting:
        now = memory.pieces(Buffer(resource))
        if resource.life is Life.PAIR:
            before = memory.pieces(Buffer(resource, previous=True))
            assert before == now[::-1]
            assert len({*now}) == TURNS
        else:
            assert len({*now}) == 1


@given(every_pipeline)
def test_each_turn_has_all_pieces_and_those_that_change_places_are_of_one_size(pipeline: Pipeline) -> None:
    memory = Memory(LAYOUT, memory_slots(pipeline))
    for turn in memory.turns:
        assert sorted(turn) == list(range(len(memory.sizes)))
        assert [memory.sizes[piece] for piece in turn] == list(memory.sizes)
    assert len(memory.turns) == TURNS


@given(every_pipeline)
def test_every_buffer_has_room(pipeline: Pipeline) -> None:
    memory = Memory(LAYOUT, memory_slots(pipeline))
    for buffer in memory.slot_of:
        assert all(memory.nbytes(buffer.resource) <= memory.sizes[piece] for piece in memory.pieces(buffer))


def test_a_half_without_the_other_stays_where_it_is() -> None:
    pipeline = Settings().pipeline(Inputs())
    halves = [slot for slot in memory_slots(pipeline) if slot.buffers[0].previous]
    memory = Memory(LAYOUT, [replace(slot, buffers=slot.buffers[:1]) for slot in halves])
    assert memory.turns[0] == memory.turns[1]


def test_a_cut_fills_what_antialiasing_reads_of_the_past() -> None:
    pipeline = Settings(taa=True).pipeline(Inputs())
    memory = Memory(LAYOUT, memory_slots(pipeline))
    (fill,) = memory.fills(pipeline.lasting)
    assert (fill.buffer.resource.name, fill.buffer.previous) == ("antialiased", True)
    assert (fill.offset, fill.nbytes) == (0, 3 * 4 * LAYOUT.plane)
    assert fill.value == np.float32(UNKNOWN)

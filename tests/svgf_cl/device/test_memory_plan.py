"""Memory is shared by buffers that are never needed at once, and by these alone."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl import Settings
from svgf_cl.device.layout import Layout
from svgf_cl.device.memory_plan import Slot, memory_slots
from svgf_cl.filters.formats import Planes, stored
from svgf_cl.filters.pipeline import HISTORY, IN_PLACE, OUT, PREVIOUS, Inputs, Pass, history_pairs, pipeline
from tests.svgf_cl.filters.test_pipeline import every_inputs

every_settings = st.builds(
    Settings,
    iterations=st.integers(1, 5),
    taa=st.booleans(),
    half_guides=st.booleans(),
    half_history=st.booleans(),
)


def sizes(passes: tuple[Pass, ...], inputs: Inputs, settings: Settings) -> dict[str, Planes]:
    return {name: stored(name, inputs, settings) for step in passes for name in step.writes if name != OUT}


def table(inputs: Inputs, settings: Settings) -> tuple[tuple[Pass, ...], list[Slot]]:
    """The passes and their memory."""
    passes = pipeline(inputs, settings)
    return passes, memory_slots(passes, sizes(passes, inputs, settings))


def place_of(slots: list[Slot]) -> dict[str, str]:
    """Name of the slot of every buffer."""
    return {name: slot.name for slot in slots for name in slot.buffers}


@given(every_inputs, every_settings)
def test_what_is_read_is_what_was_last_written_there(inputs: Inputs, settings: Settings) -> None:
    """Over frames, in which the halves of pairs change places."""
    passes, slots = table(inputs, settings)
    place, pairs = place_of(slots), history_pairs(passes)
    holder: dict[str, str] = dict.fromkeys(place.values(), "")
    for frame in range(4):
        for name in pairs:
            holder[name], holder[PREVIOUS + name] = holder[PREVIOUS + name], holder[name]
        for step in passes:
            for name in step.reads:
                if name in place and (frame or not name.startswith((PREVIOUS, *HISTORY))):
                    assert holder[place[name]] == name.removeprefix(PREVIOUS)
            holder |= {place[name]: name for name in step.writes if name != OUT}


@given(every_inputs, every_settings)
def test_no_pass_uses_one_memory_twice_unless_pixel_by_pixel(inputs: Inputs, settings: Settings) -> None:
    passes, slots = table(inputs, settings)
    place = place_of(slots)
    for step in passes:
        for one, other in itertools.combinations({*step.reads, *step.writes} & place.keys(), 2):
            assert place[one] != place[other] or IN_PLACE.get(one) == other or IN_PLACE.get(other) == one


@given(every_inputs, every_settings)
def test_there_is_room_for_every_buffer(inputs: Inputs, settings: Settings) -> None:
    passes, slots = table(inputs, settings)
    planes = {slot.name: slot.planes for slot in slots}
    for name, needed in sizes(passes, inputs, settings).items():
        assert planes[place_of(slots)[name]].over(needed) == planes[place_of(slots)[name]]
    for name in history_pairs(passes):
        assert planes[name] == planes[PREVIOUS + name]


@given(every_inputs, every_settings)
def test_halos_lie_at_the_same_place_in_all_that_share(inputs: Inputs, settings: Settings) -> None:
    _, slots = table(inputs, settings)
    for slot in slots:
        kinds = {stored(name, inputs, settings) for name in slot.buffers}
        assert len(kinds) == 1 or not slot.planes.is_mixed


@given(every_inputs, every_settings)
def test_history_is_never_overwritten_before_it_is_read(inputs: Inputs, settings: Settings) -> None:
    passes, slots = table(inputs, settings)
    kept = {*HISTORY, *history_pairs(passes)}
    assert all(slot.buffers == [slot.name] for slot in slots if slot.name in kept)


# At 1080p: NRD's ReBLUR holds 148 MB for one signal.
@pytest.mark.parametrize(
    ("chosen", "megabytes"),
    [
        ({}, 200),
        ({"half_guides": True}, 191),
        ({"half_history": True}, 146),
        ({"half_guides": True, "half_history": True}, 119),
    ],
    ids=str,
)
def test_memory_at_1080p(chosen: dict, megabytes: float) -> None:
    inputs = Inputs(signals=1, motion=2, albedo=True, emission=True, id=False)
    _, slots = table(inputs, Settings(**chosen))
    assert sum(Layout(1080, 1920).nbytes(slot.planes.depth) for slot in slots) <= 1e6 * megabytes

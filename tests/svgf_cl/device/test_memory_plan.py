"""Memory is shared by buffers that are never needed at once, and by these alone."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given

from svgf_cl import Inputs, Kalman, Settings
from svgf_cl.device.layout import Layout
from svgf_cl.device.memory import Memory
from svgf_cl.device.memory_plan import Slot, memory_slots
from svgf_cl.filters.formats import Format
from svgf_cl.filters.pipeline import Access, Buffer, Life, Pass, Pipeline, Quantity, Resource, access
from tests.svgf_cl.filters.strategies import every_pipeline


def place_of(slots: list[Slot]) -> dict[Buffer, int]:
    """Number of the slot of every buffer."""
    return {buffer: number for number, slot in enumerate(slots) for buffer in slot.buffers}


def own(accesses: tuple[Access, ...]) -> set[Buffer]:
    return {each.of for each in accesses if isinstance(each.of, Buffer)}


def pairs(pipeline: Pipeline) -> list[tuple[Buffer, Buffer]]:
    """Of every pair what the frame writes and what the last one wrote."""
    lasting = [resource for resource in pipeline.lasting if resource.life is Life.PAIR]
    return [(Buffer(resource), Buffer(resource, previous=True)) for resource in lasting]


@given(every_pipeline)
def test_what_is_read_is_what_was_last_written_there(pipeline: Pipeline) -> None:
    """Over frames, in which the halves of pairs change places."""
    place = place_of(memory_slots(pipeline))
    holder = dict.fromkeys(place.values(), "")
    for frame in range(4):
        for now, before in pairs(pipeline):
            holder[place[now]], holder[place[before]] = holder[place[before]], holder[place[now]]
        for entry in pipeline.passes:
            for buffer in own(entry.reads):
                if frame or buffer.resource.life is Life.SCRATCH:
                    assert holder[place[buffer]] == buffer.resource.name
            holder |= {place[buffer]: buffer.resource.name for buffer in own(entry.writes)}


@given(every_pipeline)
def test_no_pass_uses_one_memory_twice_unless_pixel_by_pixel(pipeline: Pipeline) -> None:
    place = place_of(memory_slots(pipeline))
    for entry in pipeline.passes:
        for one, other in itertools.combinations(own(entry.accesses), 2):
            over = one.resource.over == other.resource.name or other.resource.over == one.resource.name
            assert place[one] != place[other] or over


@given(every_pipeline)
def test_there_is_room_for_every_buffer(pipeline: Pipeline) -> None:
    slots = memory_slots(pipeline)
    place = place_of(slots)
    for buffer, number in place.items():
        assert slots[number].planes.over(buffer.resource.planes) == slots[number].planes
    for now, before in pairs(pipeline):
        assert slots[place[now]].planes == slots[place[before]].planes


@given(every_pipeline)
def test_halos_lie_at_the_same_place_in_all_that_share(pipeline: Pipeline) -> None:
    for slot in memory_slots(pipeline):
        assert len({buffer.resource.planes for buffer in slot.buffers}) == 1 or not slot.planes.is_mixed


@given(every_pipeline)
def test_history_is_never_overwritten_before_it_is_read(pipeline: Pipeline) -> None:
    kept = {Buffer(resource) for resource in pipeline.lasting}
    assert all(len(slot.buffers) == 1 for slot in memory_slots(pipeline) if slot.buffers[0] in kept)


@given(every_pipeline)
def test_buffers_of_one_memory_have_the_same_pixels(pipeline: Pipeline) -> None:
    for slot in memory_slots(pipeline):
        assert len({buffer.resource.spacing for buffer in slot.buffers}) == 1


class TestOverAPair:
    """A buffer of the frame lies where the half of a pair will be, as that is of no use before it is written."""

    def test_takes_no_memory_of_its_own(self) -> None:
        slots = memory_slots(over_a_pair(Format.FLOAT, planes=3))
        assert [[str(buffer) for buffer in slot.buffers] for slot in slots] == [["made", "kept"], ["previous kept"]]

    @pytest.mark.parametrize(("format_", "planes"), [(Format.FLOAT, 2), (Format.HALF, 3)], ids=["smaller", "narrower"])
    def test_has_memory_of_its_own_where_it_does_not_fit(self, format_: Format, planes: int) -> None:
        slots = memory_slots(over_a_pair(format_, planes))
        assert [[str(buffer) for buffer in slot.buffers] for slot in slots] == [["kept"], ["previous kept"], ["made"]]

    def test_is_what_kalman_does_with_its_prediction(self) -> None:
        slots = memory_slots(Kalman().pipeline(Inputs.every()))
        assert ["prediction", "state"] in [[str(buffer) for buffer in slot.buffers] for slot in slots]


def over_a_pair(format_: Format, planes: int) -> Pipeline:
    """A buffer of three floats, and a pair of so many planes that is made of it."""
    made = Resource("made", "made", (Quantity("q", 3),))
    kept = Resource("kept", "kept", (Quantity("q", planes, format=format_),), Life.PAIR, over="made")
    make = Pass("make", "make", reads=(access(kept, previous=True),), writes=(access(made),))
    return Pipeline((make, Pass("keep", "keep", reads=(access(made),), writes=(access(kept),))))


# At 1080p: NRD's ReBLUR holds 148 MB for one signal.
@pytest.mark.parametrize(
    ("chosen", "megabytes"),
    [
        ({}, 218),
        ({"half_guides": True}, 209),
        ({"half_history": True}, 164),
        ({"half_guides": True, "half_history": True}, 137),
    ],
    ids=str,
)
def test_memory_at_1080p(chosen: dict, megabytes: float) -> None:
    pipeline = Settings(**chosen).pipeline(Inputs(motion=2, albedo=True, emission=True))
    assert memory_at_1080p(pipeline) <= 1e6 * megabytes


def memory_at_1080p(pipeline: Pipeline) -> int:
    return sum(Memory(Layout(1080, 1920), memory_slots(pipeline)).sizes)


def test_memory_of_kalman_at_1080p() -> None:
    assert memory_at_1080p(Kalman().pipeline(Inputs(motion=2, albedo=True, emission=True))) <= 1e6 * 414

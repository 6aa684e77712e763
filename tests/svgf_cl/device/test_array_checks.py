"""Parts of buffers: worked on where they lie, apart or refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import ArgumentError, Denoiser, Frame, FrameError
from svgf_cl.device import user_arrays
from svgf_cl.device.array_checks import are_joined
from tests.frames import FULL, SHAPE, bumpy_sequence

FRAME = bumpy_sequence(FULL, count=1)[0]
OUT = (*SHAPE, 3)
ROOM = 1 << 15  # bytes; an image takes less, and on any device a part of a buffer may begin at a multiple of it


@pytest.fixture
def den(queue: cl.CommandQueue) -> Denoiser:
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return Denoiser(SHAPE).denoise(FRAME)


def buffer_for(context: cl.Context, count: int) -> cl.Buffer:
    return cl.Buffer(context, cl.mem_flags.READ_WRITE, count * ROOM)


def part(queue: cl.CommandQueue, buffer: cl.Buffer, begin: int, value: np.ndarray) -> cl_array.Array:
    """An Array with these values in the part of a buffer that begins at this byte."""
    region = buffer.get_sub_region(begin, value.nbytes)
    array = cl_array.Array(queue, value.shape, value.dtype, data=region)
    array.set(np.ascontiguousarray(value))
    return array


def in_one_buffer(frame: Frame, queue: cl.CommandQueue, buffer: cl.Buffer) -> Frame:
    """All fields in parts of a buffer, from its second `ROOM` on."""
    fields = frame.present().items()
    return replace(
        frame, **{name: part(queue, buffer, at * ROOM, value) for at, (name, value) in enumerate(fields, start=1)}
    )


def test_fields_and_result_in_parts_of_one_buffer(
    den: Denoiser, expected: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    buffer = buffer_for(den.queue.context, 1 + len(FRAME.present()))
    frame = in_one_buffer(FRAME, den.queue, buffer)
    out = part(den.queue, buffer, 0, np.zeros(OUT, np.float32))
    with monkeypatch.context() as patch:
        patch.setattr(user_arrays, "StridedCopies", None)
        patch.setattr(user_arrays, "allocate", None)
        den.denoise(frame, out=out)
    assert_array_equal(out.get(), expected)
    for name, value in frame.present().items():
        assert_array_equal(value.get(), getattr(FRAME, name))


def test_a_result_at_the_beginning_of_a_buffer_whose_parts_are_fields(den: Denoiser, expected: np.ndarray) -> None:
    buffer = buffer_for(den.queue.context, 1 + len(FRAME.present()))
    out = cl_array.Array(den.queue, OUT, np.float32, data=buffer)
    den.denoise(in_one_buffer(FRAME, den.queue, buffer), out=out)
    assert_array_equal(out.get(), expected)


def test_a_part_with_an_offset_is_copied_on_the_device(den: Denoiser, expected: np.ndarray) -> None:
    stack = part(den.queue, buffer_for(den.queue.context, 3), ROOM, np.stack([FRAME.normal, FRAME.color]))
    found = den.denoise(replace(FRAME, color=stack[1], normal=stack[0]))
    assert [label for label, _ in den.events if "gather" in label] == ["gather color"]
    assert_array_equal(found, expected)


def test_parts_that_overlap_are_refused(den: Denoiser) -> None:
    buffer = buffer_for(den.queue.context, 1 + len(FRAME.present()))
    frame = in_one_buffer(FRAME, den.queue, buffer)
    last = list(frame.present())[-1]
    align = den.queue.device.mem_base_addr_align // 8
    out = part(den.queue, buffer, len(FRAME.present()) * ROOM - align, np.zeros(OUT, np.float32))
    with pytest.raises(ArgumentError, match=rf"out\): expected memory of its own, got that of {last}"):
        den.denoise(frame, out=out)


def test_a_part_of_a_buffer_of_another_context_is_refused(den: Denoiser) -> None:
    other = cl.Context([den.queue.device])
    stranger = part(cl.CommandQueue(other), buffer_for(other, 1), 0, FRAME.depth)
    with pytest.raises(FrameError, match=r"Frame\.depth: .* context .*, got one of another context"):
        den.denoise(replace(FRAME, depth=stranger))
    disguised = cl_array.Array(den.queue, SHAPE, np.float32, data=stranger.base_data)
    with pytest.raises(FrameError, match=r"Frame\.depth: expected an Array in a buffer of the context .*, got one of"):
        den.denoise(replace(FRAME, depth=disguised))


@pytest.mark.parametrize(
    ("first", "second", "joined"),
    [((0, 40), (40, 40), False), ((0, 44), (40, 40), True), ((60, 4), (40, 40), True), ((0, 4), (76, 4), False)],
)
def test_elements_alone_count(first: tuple[int, int], second: tuple[int, int], joined: bool, den: Denoiser) -> None:
    """Not all of the buffer that they lie in."""
    buffer = buffer_for(den.queue.context, 1)
    arrays = [
        cl_array.Array(den.queue, (nbytes // 4,), np.float32, data=buffer, offset=offset)
        for offset, nbytes in (first, second)
    ]
    assert are_joined(*arrays) == joined
    assert are_joined(*arrays[::-1]) == joined

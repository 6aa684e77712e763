"""What is said of Arrays by their offset and strides is what every single element says."""

from __future__ import annotations

import itertools

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.device.strided import is_aligned, is_apart, is_plain, span
from tests.fuzz.effort import effort

SHAPES = st.lists(st.integers(1, 4), min_size=2, max_size=3).map(tuple)
STEPS = st.integers(-40, 40)


@pytest.fixture(scope="module")
def buffer(queue: cl.CommandQueue) -> cl.Buffer:
    return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 4)


def array(buffer: cl.Buffer, shape: tuple[int, ...], offset: int, strides: tuple[int, ...]) -> cl_array.Array:
    context = buffer.get_info(cl.mem_info.CONTEXT)
    return cl_array.Array(context, shape, np.float32, data=buffer, offset=offset, strides=strides)


def places(of: cl_array.Array) -> list[int]:
    """The first byte of every element."""
    indices = itertools.product(*map(range, of.shape))
    return [of.offset + int(np.dot(index, of.strides)) for index in indices]


@effort(60)
@given(data=st.data(), shape=SHAPES, offset=STEPS)
def test_they_say_the_same(data: st.DataObject, shape: tuple[int, ...], offset: int, buffer: cl.Buffer) -> None:
    made = array(buffer, shape, offset, tuple(data.draw(STEPS) for _ in shape))
    each = places(made)
    assert span(made) == (min(each), max(each) + 4)
    if is_plain(made):
        assert each == list(range(0, 4 * len(each), 4))
    if is_aligned(made):
        assert all(place % 4 == 0 for place in each)
        assert not is_apart(made) or len(set(each)) == len(each)


@effort(20)
@given(order=st.permutations(range(3)), signs=st.tuples(*[st.sampled_from((1, -1))] * 3))
def test_any_order_of_axes_is_apart(order: list[int], signs: tuple[int, ...], buffer: cl.Buffer) -> None:
    strides, step = [0, 0, 0], 4
    for axis in order:
        strides[axis] = signs[axis] * step
        step *= 5
    assert is_apart(array(buffer, (5, 5, 5), 0, tuple(strides)))


@pytest.mark.parametrize(
    ("shape", "strides", "plain"),
    [
        ((2, 3), (12, 4), True),
        ((1, 3), (999, 4), True),
        ((2, 1), (4, 999), True),
        ((2, 3), (16, 4), False),
        ((2, 3), (4, 8), False),
    ],
)
def test_c_order_without_gaps_is_plain(
    shape: tuple[int, ...], strides: tuple[int, ...], plain: bool, buffer: cl.Buffer
) -> None:
    assert is_plain(array(buffer, shape, 0, strides)) == plain
    assert not is_plain(array(buffer, shape, 4, strides))

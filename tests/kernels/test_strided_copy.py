"""strided_copy.cl: elements reach their places whatever the order, offset and strides on either side, bit for bit."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from svgf_cl.device import strided
from svgf_cl.device.strided import StridedCopies, is_apart, span
from tests.fuzz.effort import effort

SIZES = st.tuples(*[st.integers(1, 5)] * 2, st.integers(0, 4)).map(lambda shape: shape if shape[2] else shape[:2])


@st.composite
def layouts(draw: st.DrawFn, shape: tuple[int, ...]) -> tuple[int, tuple[int, ...], int]:
    """Offset, strides and size of a buffer, in bytes: axes in any order and direction, with gaps."""
    strides, step = [0] * len(shape), 4
    for axis in draw(st.permutations(range(len(shape)))):
        step += 4 * draw(st.integers(0, 3))
        strides[axis] = step * draw(st.sampled_from((1, -1)))
        step *= shape[axis]
    lowest = sum(min(0, (count - 1) * each) for count, each in zip(shape, strides, strict=True))
    offset = 4 * draw(st.integers(0, 3)) - lowest
    extent = sum(abs((count - 1) * each) for count, each in zip(shape, strides, strict=True))
    return offset, tuple(strides), offset + lowest + extent + 4 + 4 * draw(st.integers(0, 3))


@effort(30)
@given(data=st.data(), shape=SIZES, by_rows=st.booleans())
def test_elements_reach_their_places(
    data: st.DataObject, shape: tuple[int, ...], by_rows: bool, queue: cl.CommandQueue
) -> None:
    arrays, memories = [], []
    for seed in range(2):
        offset, strides, nbytes = data.draw(layouts(shape))
        memory = np.random.default_rng((seed, nbytes)).integers(0, 2**32, nbytes // 4, np.uint32)  # NaN among floats
        buffer = cl.Buffer(queue.context, cl.mem_flags.COPY_HOST_PTR, hostbuf=memory)
        arrays.append(cl_array.Array(queue, shape, np.float32, data=buffer, offset=offset, strides=strides))
        memories.append(memory)
    source, target = (
        np.ndarray(shape, np.uint32, memory, array.offset, array.strides)
        for array, memory in zip(arrays, memories, strict=True)
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(strided, "copies_rows", lambda device: by_rows)  # as on a CPU, or as on a GPU
        StridedCopies(queue).enqueue(*arrays)
    target[...] = source
    for array, memory in zip(arrays, memories, strict=True):
        assert is_apart(array)
        assert 0 <= span(array)[0] < span(array)[1] <= memory.nbytes
        found = np.empty_like(memory)
        cl.enqueue_copy(queue, found, array.base_data)
        assert_array_equal(found, memory, err_msg="what lies between the elements stays")

"""A launch keeps its arguments from frame to frame, and takes the user's arrays anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser
from svgf_cl.device.launch import Launch, scalar_arguments
from svgf_cl.filters.pipeline import Pass, user
from tests.frames import FULL, SHAPE, bumpy_sequence
from tests.svgf_cl.device.test_user_arrays import on_device

SOURCE = """
kernel void scaled(const int4 size, const float factor, const int frame_number, global const float *in,
                   global float *out) {
    const int i = get_global_id(0) + 4 * get_global_id(1);
    out[i] = factor * in[i] + size.w + 100 * frame_number;
}
"""

SIZE = np.array([0, 0, 0, 7], np.int32)
ENTRY = Pass(
    "scaled",
    "scaled",
    scalars={"factor": 2.0},
    per_frame=("frame_number",),
    reads=(user("color", "in"),),
    writes=(user("out"),),
)


@pytest.mark.filterwarnings("ignore::pyopencl.CompilerWarning")
def test_numbers_change_without_another_kernel(queue: cl.CommandQueue) -> None:
    kernel = cl.Kernel(cl.Program(queue.context, SOURCE).build(), "scaled")
    launch = Launch(ENTRY, kernel, {"size": SIZE, **scalar_arguments(ENTRY)}, (4, 2), (4, 1))
    launch.set_scalars(replace(ENTRY, scalars={"factor": 3.0}))
    given, out = cl_array.arange(queue, 0, 8, dtype=np.float32), cl_array.zeros(queue, 8, np.float32)
    launch.enqueue(queue, {"color": given.base_data, "out": out.base_data}, {"frame_number": 0}).wait()
    assert_array_equal(out.get(), 3 * np.arange(8) + 7)


def test_whole_numbers_stay_whole() -> None:
    found = scalar_arguments(replace(ENTRY, scalars={"python": 2, "numpy": np.int64(2), "float": 2.0}))
    assert list(found.values()) == [2, 2, 2]
    assert [value.dtype for value in found.values()] == [np.int32, np.int32, np.float32]


@pytest.mark.filterwarnings("ignore::pyopencl.CompilerWarning")
def test_users_arrays_are_set_anew_and_all_else_stays(queue: cl.CommandQueue) -> None:
    kernel = cl.Kernel(cl.Program(queue.context, SOURCE).build(), "scaled")
    launch = Launch(ENTRY, kernel, {"size": SIZE, **scalar_arguments(ENTRY)}, (4, 2), (4, 1))
    for frame, start in enumerate((0, 10)):
        given = cl_array.arange(queue, start, start + 8, dtype=np.float32)
        out = cl_array.zeros(queue, 8, np.float32)
        user = {"color": given.base_data, "out": out.base_data, "unused": out.base_data}
        launch.enqueue(queue, user, {"frame_number": frame}).wait()
        assert_array_equal(out.get(), 2 * np.arange(start, start + 8) + 7 + 100 * frame)


def test_a_later_frame_makes_no_kernel_and_takes_no_memory(
    queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch
) -> None:
    den = Denoiser(SHAPE, queue=queue)
    first, *later = [on_device(frame, queue) for frame in bumpy_sequence(FULL, count=4)]
    out = den.denoise(first)
    for name in ("Kernel", "Program", "Buffer"):
        monkeypatch.delattr(cl, name)
    for frame in later:
        den.denoise(frame, out=out)

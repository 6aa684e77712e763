"""A launch keeps its arguments from frame to frame, and takes the user's arrays anew."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser
from svgf_cl.device.launch import Launch
from svgf_cl.filters.pipeline import Pass
from tests.frames import FULL, SHAPE, bumpy_sequence
from tests.svgf_cl.device.test_user_arrays import on_device

SOURCE = """
kernel void scaled(global const float *in, const float factor, const int4 shift, global float *out) {
    const int i = get_global_id(0) + 4 * get_global_id(1);
    out[i] = factor * in[i] + shift.w;
}
"""


@pytest.mark.filterwarnings("ignore::pyopencl.CompilerWarning")
def test_users_arrays_are_set_anew_and_all_else_stays(queue: cl.CommandQueue) -> None:
    kernel = cl.Kernel(cl.Program(queue.context, SOURCE).build(), "scaled")
    arguments = ("in", np.float32(2), np.array([0, 0, 0, 7], np.int32), "out")
    launch = Launch(Pass("scaled", ("in",), ("out",)), kernel, arguments, (4, 2), (4, 1))
    for start in (0, 10):
        given = cl_array.arange(queue, start, start + 8, dtype=np.float32)
        out = cl_array.zeros(queue, 8, np.float32)
        launch.enqueue(queue, {"in": given.base_data, "out": out.base_data, "unused": out.base_data}).wait()
        assert_array_equal(out.get(), 2 * np.arange(start, start + 8) + 7)


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

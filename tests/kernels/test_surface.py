"""surface.clh: each exponential keeps the bound that is stated for it, at every width, and has the faintest weight."""

from __future__ import annotations

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest

from svgf_cl import Settings, Tuning
from svgf_cl.device import programs
from svgf_cl.device.tuning import EXPONENTIALS, VECTOR_WIDTHS
from svgf_cl.filters.signals import Inputs

FAINTEST = -115  # of exponents
EXPONENTS = np.r_[np.linspace(FAINTEST, 10, 2**14 - 24), -0.0, -1e-7, -114.99999, -115.00001, -126, -127, -150, -1e3]
BEYOND = np.array([-np.inf, -1e30, -1e9, -4e6, -1e4, -200, -149, -116], np.float32)

# A stage that computes weights, and behind it a kernel that shows them.
SHOWN = """
__kernel void shown(__global const float *restrict e, __global float *restrict w) {
    const int i = VW * (int)get_global_id(0);
    store(weight(load(e + i)), w + i);
}
"""


def weights(queue: cl.CommandQueue, exponents: np.ndarray, tuning: Tuning) -> np.ndarray:
    """2^e as kernels compute it."""
    defines = tuning.defines | Settings().pipeline(Inputs()).defines
    text = programs.source("variance") + SHOWN
    program = cl.Program(queue.context, text).build(list(programs.options_of("variance", defines)))
    e, w = cl_array.to_device(queue, exponents), cl_array.empty(queue, exponents.shape, np.float32)
    program.shown(queue, (len(exponents) // tuning.vector_width,), None, e.data, w.data)
    return w.get()


@pytest.mark.parametrize("exponential", EXPONENTIALS)
@pytest.mark.parametrize("width", VECTOR_WIDTHS)
def test_a_weight_is_two_to_the_exponent(width: int, exponential: str, queue: cl.CommandQueue) -> None:
    tuning = Tuning(vector_width=width, work_group=(1, 1), exponential=exponential)
    exponents = np.concatenate([EXPONENTS.astype(np.float32), BEYOND, BEYOND])
    expected = np.exp2(np.maximum(exponents.astype(float), FAINTEST))
    bound = {"polynomial": 4e-6, "exp2": 4 * 2.0**-23}[exponential]
    got = weights(queue, exponents, tuning)
    np.testing.assert_allclose(got, expected, rtol=bound)
    assert (got[-2 * len(BEYOND) :] == np.float32(2.0**FAINTEST)).all()

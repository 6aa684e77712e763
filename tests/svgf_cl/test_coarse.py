"""A buffer of every second pixel of every second row: kernels know its size, memory and stage are so big."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, Inputs
from svgf_cl.device import programs
from svgf_cl.device.layout import HALO, Layout
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import OUT, Life, Pass, Pipeline, Quantity, Resource, access, user
from svgf_cl.filters.taps import BLOCK
from svgf_cl.frame import Shape
from tests.denoising import vector_width
from tests.frames import noise, wall

# Takes every second pixel of the frame's red, adds what the frame before had there, and shows it at all four.
SOURCE = """
__kernel void down(const int4 size, const int4 coarse_size, __global const float *color,
                   __global const float *previous_coarse, __global float *coarse) {
    const int y = get_global_id(1);
    for (int x = VW * get_global_id(0); x < min(coarse_size.x, VW * (int)(get_global_id(0) + 1)); ++x) {
        if (y >= coarse_size.y) return;
        const int here = (y + HALO) * coarse_size.z + HALO + x;
        coarse[COARSE_RED * coarse_size.w + here] = color[3 * (2 * y * size.x + 2 * x)] + previous_coarse[here];
    }
}
__kernel void up(const int4 size, const int4 coarse_size, __global const float *coarse, __global float *out) {
    const int y = get_global_id(1);
    for (int x = VW * get_global_id(0); x < min(size.x, VW * (int)(get_global_id(0) + 1)); ++x) {
        if (y >= size.y) return;
        for (int k = 0; k < 3; ++k) {
            out[3 * (y * size.x + x) + k] = coarse[(y / 2 + HALO) * coarse_size.z + HALO + x / 2];
        }
    }
}
"""
SHAPES = [(1, 1), (2, 3), (17, 33), (53, 37)]


@dataclass(frozen=True, kw_only=True)
class Coarse(Filter):
    """The sum of every second pixel's red over all frames."""

    name: ClassVar[str] = "coarse"

    def pipeline(self, inputs: Inputs) -> Pipeline:
        red = Quantity("red", stage="red", unknown=0.0)
        coarse = Resource("coarse", "coarse", (red,), Life.PAIR, spacing=2)
        reads = (user("color"), access(coarse, previous=True))
        down = Pass("coarse", "down", reads=reads, writes=(access(coarse),))
        up = Pass("coarse", "up", reads=(access(coarse, taps={"red": BLOCK}),), writes=(user(OUT),))
        return Pipeline((down, up))


@pytest.fixture(autouse=True)
def kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if kernels/coarse.cl were there."""
    monkeypatch.setattr(programs, "source", lambda name: SOURCE)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("width", [1, 16])
def test_goes_down_and_up_again(shape: Shape, width: int) -> None:
    with vector_width(width):
        den = Denoiser(shape, settings=Coarse())
    total = 0.0
    for number in range(3):
        light = noise(number, shape)
        out = den.denoise(wall(shape, color=light))
        total = total + light[::2, ::2, 0]
        assert_array_equal(den.stage("red"), total)
        assert_array_equal(out[..., 1], total.repeat(2, axis=0).repeat(2, axis=1)[: shape[0], : shape[1]])


def test_takes_a_quarter_of_the_memory() -> None:
    shape = (640, 640)
    den = Denoiser(shape, settings=Coarse())
    den.denoise(wall(shape))
    assert den.nbytes == 2 * Layout(320, 320).nbytes(32)


def test_its_halo_stays_zero_and_a_cut_forgets_it() -> None:
    den = Denoiser((17, 33), settings=Coarse())
    for _ in range(2):
        den.reset()
        den.denoise(wall((17, 33), color=1.0))
        assert_array_equal(den.stage("red"), 1)
    plane = den.raw_stage("red").reshape(9 + 2 * HALO, -1)
    assert plane.sum() == 9 * 17

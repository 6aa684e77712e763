"""A filter that is defined here runs as the library's own do: all that a pass can declare reaches its kernel."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Denoiser, Frame, Inputs, Settings
from svgf_cl.device import programs
from svgf_cl.device.layout import HALO
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import OUT, Life, Pass, Pipeline, Quantity, Resource, access, user
from svgf_cl.filters.taps import grid
from svgf_cl.settings import choice, number
from tests.denoising import vector_width
from tests.frames import SHAPE, noise, wall

COUNT = 7
WEIGHTS = {
    "odd": np.array([1, 3, 5, 7], np.float32),
    "even": np.array([2, 4, 6, 8], np.float32),
    "every other": np.arange(8, dtype=np.float32)[::2],
}

# It adds to a history of its own, and shows the sum; `scale` would be read as rubbish were it passed as a float, and
# `gain` were it passed as an int.
SOURCE = """
__kernel void weigh(const int4 size, const int scale, const float gain, const int frame_number,
                    __global const float *weights, __global const int *table, __global const float *color,
                    __global const float *previous, __global float *sum, __global float *out) {
    const int y = get_global_id(1);
    for (int x = VW * get_global_id(0); x < min(size.x, VW * (int)(get_global_id(0) + 1)); ++x) {
        if (y >= size.y) return;
        const int here = (y + HALO) * size.z + HALO + x;
        for (int k = 0; k < TOTAL_COLOR_CHANNELS; ++k) {
            const int i = 3 * (y * size.x + x) + k, plane = (TOTAL_COLOR + k) * size.w;
            const float light = scale * gain * weights[frame_number % 4] * color[i] + table[k];
            sum[plane + here] = out[i] = light + previous[plane + here];
        }
    }
}
__kernel void count(const int4 size, __global int *seen) {
    const int y = get_global_id(1);
    for (int x = VW * get_global_id(0); x < min(size.x, VW * (int)(get_global_id(0) + 1)); ++x) {
        if (y < size.y) seen[SEEN_FRAMES * size.w + (y + HALO) * size.z + HALO + x] += 1;
    }
}
"""
TABLE = np.array([[10], [20], [30]], np.int32)


@dataclass(frozen=True, kw_only=True)
class Weigh(Filter):
    """Sums of light, weighed by the number of the frame."""

    name: ClassVar[str] = "weigh"

    scale: int = number(2, (0, 100), unit="", reason="A whole number.")
    gain: float = number(0.5, (0.0, 100.0), unit="", reason="Any number.")
    weights: str = choice("odd", "even", "every other", reason="Which of the constant arrays.")

    def pipeline(self, inputs: Inputs) -> Pipeline:
        total = Resource("total", "total", (Quantity("color", 3, stage="total", unknown=100.0),), Life.PAIR)
        seen = Resource("seen", "seen", (Quantity("frames", stage="seen", unknown=0.0),), Life.HISTORY)
        weigh = Pass(
            "weigh",
            "weigh",
            scalars={"scale": self.scale, "gain": self.gain},
            per_frame=("frame_number",),
            arrays={"weights": WEIGHTS[self.weights], "table": TABLE},
            reads=(user("color"), access(total, "previous", previous=True)),
            writes=(access(total, "sum"), user(OUT)),
        )
        return Pipeline((weigh, Pass("weigh", "count", writes=(access(seen),))))


@pytest.fixture(autouse=True)
def kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if kernels/weigh.cl were there."""
    usual = programs.source
    monkeypatch.setattr(programs, "source", lambda name: SOURCE if name == "weigh" else usual(name))


def frames(count: int = COUNT) -> list[Frame]:
    return [wall(color=noise(number)) for number in range(count)]


def sums(settings: Weigh, given: list[Frame]) -> list[np.ndarray]:
    """What is expected of a sequence, picture by picture."""
    total, found = 100.0, []
    for age, frame in enumerate(given):
        light = settings.scale * settings.gain * WEIGHTS[settings.weights][age % 4] * frame.color.astype(np.float64)
        total = total + light + TABLE[:, 0]
        found.append(total)
    return found


@pytest.mark.parametrize("width", [1, 4, 16])
def test_all_that_a_pass_declares_reaches_its_kernel(width: int) -> None:
    settings = Weigh(scale=3, gain=0.25)
    with vector_width(width):
        den = Denoiser(SHAPE, settings=settings)
    for frame, expected in zip(frames(), sums(settings, frames()), strict=True):
        assert_allclose(den.denoise(frame), expected, rtol=1e-6)
        assert_allclose(den.stage("total"), expected, rtol=1e-6)
    assert [name for name, _ in den.events] == ["weigh", "count"]
    assert den.stages == ["total", "seen"]


def test_arrays_need_not_be_contiguous() -> None:
    settings = Weigh(weights="every other")
    den = Denoiser(SHAPE, settings=settings)
    for frame, expected in zip(frames(), sums(settings, frames()), strict=True):
        assert_allclose(den.denoise(frame), expected, rtol=1e-6)


def test_fields_that_are_not_read_may_differ() -> None:
    """It reads color alone, so it does not matter what else there is."""
    den, other = (Denoiser(SHAPE, settings=Weigh()) for _ in range(2))
    for frame in frames(2):
        elsewhere = replace(frame, normal=-frame.normal, depth=0 * frame.depth, motion=frame.motion + 9)
        assert_array_equal(den.denoise(frame), other.denoise(elsewhere))


def test_after_a_cut_frames_count_from_0_and_history_is_what_is_unknown() -> None:
    den = Denoiser(SHAPE, settings=Weigh())
    for frame in frames(3):
        den.denoise(frame)
    den.reset()
    for frame, expected in zip(frames(), sums(Weigh(), frames()), strict=True):
        assert_allclose(den.denoise(frame), expected, rtol=1e-6)


@pytest.mark.parametrize("changed", [{"gain": 2.0}, {"scale": 5}], ids=str)
def test_numbers_change_without_a_new_plan_and_history_goes_on(changed: dict[str, float]) -> None:
    den = Denoiser(SHAPE, settings=Weigh())
    first, *later = frames(3)
    total = den.denoise(first).astype(np.float64)
    settings = replace(Weigh(), **changed)
    assert not den.update(settings)
    for age, frame in enumerate(later, start=1):
        total += settings.scale * settings.gain * WEIGHTS["odd"][age] * frame.color + TABLE[:, 0]
        assert_allclose(den.denoise(frame), total, rtol=1e-6)


def test_other_arrays_are_taken_up_and_history_goes_on() -> None:
    den = Denoiser(SHAPE, settings=Weigh())
    first, second = frames(2)
    total = den.denoise(first).astype(np.float64)
    settings = Weigh(weights="even")
    den.update(settings)
    total += settings.scale * settings.gain * WEIGHTS["even"][1] * second.color + TABLE[:, 0]
    assert_allclose(den.denoise(second), total, rtol=1e-6)


def test_a_history_that_is_not_a_pair_is_written_over_itself() -> None:
    den = Denoiser(SHAPE, settings=Weigh())
    for count, frame in enumerate(frames(3), start=1):
        den.denoise(frame)
        assert_array_equal(den.stage("seen").view(np.int32), count)
    inside = den.raw_stage("seen").view(np.int32)
    assert inside.sum() == 3 * SHAPE[0] * SHAPE[1]  # and the halo stays as it was


def test_other_sizes_and_other_filters_come_and_go() -> None:
    den = Denoiser((5, 9), settings=Weigh())
    for shape in ((5, 9), SHAPE):
        den.resize(shape)
        frame = wall(shape, color=noise(1, shape))
        assert_allclose(den.denoise(frame), sums(Weigh(), [frame])[0], rtol=1e-6)
    assert den.update(Denoiser(SHAPE).settings)
    assert_allclose(den.denoise(wall()), 0.5, rtol=1e-6)
    assert den.update(Weigh())  # of another filter's past it knows nothing, so frames count from 0
    expected = 100 + Weigh().scale * Weigh().gain * WEIGHTS["odd"][0] * 0.5 + TABLE[:, 0]
    assert_allclose(den.denoise(wall()), np.broadcast_to(expected, (*SHAPE, 3)), rtol=1e-6)


@pytest.mark.parametrize("then", [{}, {"iterations": 2}], ids=["once", "and another change"])
def test_taa_that_is_switched_on_knows_no_past(then: dict[str, int]) -> None:
    """Its first picture is what it was given, as after a cut, though the light's history goes on."""
    den = Denoiser(SHAPE, settings=Settings(), keep_stages=True)
    for frame in frames(3):
        den.denoise(frame)
    den.update(Settings(taa=True))
    den.update(Settings(taa=True, **then))
    out = den.denoise(frames(1)[0])
    assert_array_equal(den.stage("history_length"), 4)
    assert_allclose(out, den.stage("modulated"), rtol=1e-5, atol=1e-6)


def test_taps_beyond_the_halo_are_refused() -> None:
    far = Resource("far", "total", (Quantity("color", 3, stage="total"),))

    @dataclass(frozen=True, kw_only=True)
    class Far(Weigh):
        def pipeline(self, inputs: Inputs) -> Pipeline:
            return reaching(far, HALO + 1)

    with pytest.raises(ValueError, match=rf"halo of {HALO} pixels, got some {HALO + 1} away"):
        Denoiser(SHAPE, settings=Far()).denoise(wall())


def reaching(resource: Resource, far: int) -> Pipeline:
    """Passes of which the second reads so many pixels away."""
    write = Pass("weigh", "weigh", level=1, reads=(user("color"),), writes=(access(resource),))
    read = Pass("weigh", "weigh", level=2, reads=(access(resource, taps={"color": grid(1, far)}),), writes=(user(OUT),))
    return Pipeline((write, read))

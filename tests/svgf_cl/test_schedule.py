"""A schedule says of every argument of every launch what it is, without a device."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from svgf_cl import Inputs, Kalman
from svgf_cl.device.layout import Layout
from svgf_cl.device.tuning import CPU_TUNING, GPU_TUNING
from svgf_cl.filters.pipeline import Pipeline
from svgf_cl.frame import CHANNELS
from svgf_cl.schedule import Schedule, whole_groups
from tests.frames import SHAPE, SPLIT, bumpy_sequence
from tests.svgf_cl.filters.strategies import every_pipeline

LAYOUT = Layout(*SHAPE)


@given(every_pipeline)
def test_every_argument_is_one_thing(pipeline: Pipeline) -> None:
    for each in Schedule(pipeline, LAYOUT, GPU_TUNING).passes:
        kinds = [each.values, each.own, each.user, each.entry.arrays, each.entry.per_frame]
        assert sorted(name for kind in kinds for name in kind) == sorted(each.entry.arguments)


@given(every_pipeline)
def test_every_buffer_of_a_pass_has_memory(pipeline: Pipeline) -> None:
    schedule = Schedule(pipeline, LAYOUT, GPU_TUNING)
    used = {buffer for each in schedule.passes for buffer in each.own.values()}
    assert used <= {*schedule.memory.slot_of}


def test_arrays_are_what_frames_have() -> None:
    (frame,) = bumpy_sequence(SPLIT, count=1)
    schedule = Schedule(Kalman().pipeline(Inputs.of(frame)), LAYOUT, GPU_TUNING)
    *names, out = schedule.arrays
    assert out == "out"
    assert {*names} == {*frame.present()}
    for name in names:
        value = getattr(frame, name)
        assert (schedule.arrays[name].shape, schedule.arrays[name].dtype) == (value.shape, value.dtype)
        assert name in CHANNELS
    assert schedule.arrays[out].shape == (*SHAPE, 3)


def test_the_past_may_lie_in_another_layout() -> None:
    past = Layout(90, 91)
    passes = Schedule(Kalman().pipeline(Inputs()), LAYOUT, GPU_TUNING, past).passes
    sizes = [each.sizes["past_size"] for each in passes if "past_size" in each.sizes]
    assert sizes
    for size in sizes:
        np.testing.assert_array_equal(size, past.size)


@pytest.mark.parametrize("tuning", [CPU_TUNING, GPU_TUNING], ids=str)
def test_work_items_reach_every_pixel_that_is_written(tuning) -> None:
    schedule = Schedule(Kalman().pipeline(Inputs()), LAYOUT, tuning)
    for each in schedule.passes:
        written = LAYOUT.every(each.entry.spacing)
        along, down = each.work_items
        assert (along - 1) * tuning.vector_width < written.width <= along * tuning.vector_width
        assert written.height <= down < written.height + each.entry.row_step


def test_work_items_are_rounded_up_to_whole_groups() -> None:
    assert whole_groups((5, 7), (64, 1)) == (64, 7)
    assert whole_groups((64, 9), (32, 4)) == (64, 12)

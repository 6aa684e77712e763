"""A rig samples what it says, of a filter that does what it always does."""

from __future__ import annotations

import pyopencl as cl
import pytest

from svgf_cl import Denoiser, Settings
from svgf_cl.bench.rig import ENQUEUE, EVENT, FRAME, FRAME_NUMPY, HOST, Rig, there_and_back

SHAPE = (9, 16)


@pytest.mark.parametrize("signals", [1, 2])
def test_every_stage_is_sampled_by_both_clocks(queue: cl.CommandQueue, signals: int) -> None:
    rig = Rig(there_and_back(SHAPE, signals), Settings(iterations=2), queue, passes=True)
    rig.sample(0.0)
    rig.sample(0.0)
    passes = {
        ("demodulate",),
        ("temporal",),
        ("variance",),
        ("atrous", "1"),
        ("atrous", "2"),
        ("modulate",),
        ("atrous",),
    }
    both = {(row, clock) for row in {*passes, FRAME} for clock in (EVENT, HOST)}
    assert set(rig.samples) == both | {(ENQUEUE, HOST), (FRAME_NUMPY, HOST)}
    assert all(len(values) == 2 and min(values) > 0 for values in rig.samples.values())


def test_the_whole_holds_its_parts(queue: cl.CommandQueue) -> None:
    rig = Rig(there_and_back(SHAPE, 1), Settings(), queue, passes=True)
    rig.sample(0.0)
    only = {key: values[0] for key, values in rig.samples.items()}
    levels = [only[("atrous", str(level)), EVENT] for level in range(1, 6)]
    assert only[("atrous",), EVENT] == pytest.approx(sum(levels))
    assert only[FRAME, EVENT] >= sum(levels)
    assert only[FRAME, HOST] >= only[ENQUEUE, HOST]


def test_a_variant_is_timed_as_a_whole(queue: cl.CommandQueue) -> None:
    rig = Rig(there_and_back(SHAPE, 1), Settings(), queue, passes=False)
    rig.sample(0.0)
    assert set(rig.samples) == {(FRAME, EVENT), (FRAME, HOST), (ENQUEUE, HOST)}


def test_the_camera_goes_to_and_fro_with_history(queue: cl.CommandQueue) -> None:
    """Sent in turn, each frame finds its surfaces in the other: history grows nearly everywhere."""
    den = Denoiser((45, 80), settings=Settings(), queue=queue, keep_stages=True)
    frames = there_and_back((45, 80), 1)
    for index in range(6):
        den.denoise(frames[index % 2])
    assert (den.stage("history_length") > 3.5).mean() > 0.9

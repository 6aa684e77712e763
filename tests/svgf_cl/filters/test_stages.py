"""Stages: every one lies in a buffer of the pass table and comes out image-shaped."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Settings
from svgf_cl.filters.formats import stored
from svgf_cl.filters.pipeline import Inputs, pipeline
from svgf_cl.filters.stages import StageView, stage_views

PLANES = np.arange(8 * 4 * 5, dtype=np.float32).reshape(8, 4, 5)[:, 1:3, 1:4]  # cropped, as on the way from a device


@pytest.mark.parametrize(
    ("view", "expected"),
    [
        (StageView("b", 3, 0, 1), PLANES[3]),
        (StageView("b", 1, 0, 3), np.stack(PLANES[1:4], axis=-1)),
        (StageView("b", 0, 1, 3), np.stack(PLANES[:3], axis=-1)[None]),
        (StageView("b", 0, 2, 3), np.stack([np.stack(PLANES[:3], axis=-1), np.stack(PLANES[3:6], axis=-1)])),
        (StageView("b", 6, 2, 1), PLANES[6:8]),
        (StageView("b", 1, 2, 1, step=2), PLANES[[1, 3]]),
    ],
)
def test_view_picks_its_planes(view: StageView, expected: np.ndarray) -> None:
    found = view.of(PLANES)
    assert found.dtype == np.float32
    assert_array_equal(found, expected)
    assert not np.shares_memory(found, PLANES)


@pytest.mark.parametrize("signals", [1, 2])
@pytest.mark.parametrize(
    "settings", [Settings(), Settings(iterations=1, taa=True), Settings(half_guides=True, half_history=True)]
)
def test_every_stage_lies_within_a_buffer_that_is_written(signals: int, settings: Settings) -> None:
    inputs = Inputs(signals, 3, True, True, True)
    passes = pipeline(inputs, settings)
    written = {name for step in passes for name in step.writes}
    for view in stage_views(passes, inputs, settings).values():
        assert view.buffer in written
        count = max(view.signals, 1) * view.channels
        end = 8 * np.dtype(view.dtype).itemsize * (view.first + view.step * (count - 1) + 1)
        assert end <= stored(view.buffer, inputs, settings).depth


def test_names_follow_the_pipeline() -> None:
    inputs = Inputs(1, 2, False, False, False)
    settings = Settings(iterations=2, taa=True)
    assert list(stage_views(pipeline(inputs, settings), inputs, settings)) == [
        "normal",
        "depth",
        "demodulated",
        "accumulated",
        "history_length",
        "mean",
        "moment_variance",
        "variance",
        "level_1",
        "level_1_variance",
        "level_2",
        "level_2_variance",
        "modulated",
        "antialiased",
    ]

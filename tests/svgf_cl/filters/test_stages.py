"""Stages: every one is a quantity that is written, and comes out image-shaped."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Inputs, Settings
from svgf_cl.filters.formats import Format
from svgf_cl.filters.pipeline import Quantity, Resource
from svgf_cl.filters.stages import Stage, stages
from svgf_cl.frame import LUMINANCE

PLANES = np.arange(8 * 4 * 5, dtype=np.float32).reshape(8, 4, 5)[:, 1:3, 1:4]  # cropped, as on the way from a device


def stage(*quantities: Quantity) -> Stage:
    """Of the last quantity of a buffer."""
    return Stage(Resource("b", "b", quantities), quantities[-1])


@pytest.mark.parametrize(
    ("shown", "expected"),
    [
        (stage(Quantity("a", 3), Quantity("b")), PLANES[3]),
        (stage(Quantity("a"), Quantity("b", 3)), np.stack(PLANES[1:4], axis=-1)),
        (stage(Quantity("b", 3, signals=1)), np.stack(PLANES[:3], axis=-1)[None]),
        (
            stage(Quantity("b", 3, signals=2)),
            np.stack([np.stack(PLANES[:3], axis=-1), np.stack(PLANES[3:6], axis=-1)]),
        ),
        (stage(Quantity("a", 3, signals=2), Quantity("b", signals=2)), PLANES[6:8]),
    ],
)
def test_a_stage_picks_its_planes(shown: Stage, expected: np.ndarray) -> None:
    found = shown.image(PLANES)
    assert found.dtype == np.float32
    assert_array_equal(found, expected)
    assert not np.shares_memory(found, PLANES)


def test_planes_in_16_bits_behind_others_are_counted_in_their_own_width() -> None:
    shown = stage(Quantity("a"), Quantity("b", 3, format=Format.SNORM))
    planes = PLANES.astype(np.int16)  # of which the first two are the halves of the first in 32 bits
    assert_allclose(shown.image(planes), np.stack(planes[2:5], axis=-1) / 32767)


def test_green_comes_back_from_luminance() -> None:
    color = np.random.default_rng(0).random((4, 5, 3))
    planes = np.stack([color[..., 0], color @ LUMINANCE, color[..., 2]]).astype(np.float32)
    assert_allclose(stage(Quantity("b", 3, is_light=True)).image(planes), color, atol=1e-6)


@pytest.mark.parametrize(
    "settings", [Settings(), Settings(iterations=1, taa=True), Settings(half_guides=True, half_history=True)]
)
def test_every_stage_lies_within_a_buffer_that_is_written(settings: Settings) -> None:
    pipeline = settings.pipeline(Inputs.every())
    for shown in stages(pipeline).values():
        assert shown.resource in pipeline.resources
        assert shown.quantity in shown.resource.quantities


def test_names_follow_the_pipeline() -> None:
    assert list(stages(Settings(iterations=2, taa=True).pipeline(Inputs()))) == [
        "depth",
        "normal",
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

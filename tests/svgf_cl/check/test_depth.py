"""Encodings of depth, told by planes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame, check_frame
from svgf_cl.check.depth import ENCODING, origin
from svgf_cl.io.synthetic import FOCAL_LENGTH, room_frames

SHAPE = (180, 320)
Y, X = np.indices(SHAPE) - np.array([SHAPE[0] - 1, SHAPE[1] - 1])[:, None, None] / 2
ALONG_THE_RAY = np.sqrt(1 + (X**2 + Y**2) / (FOCAL_LENGTH * SHAPE[0]) ** 2)

ENCODINGS = [
    (lambda z: 1 / z, "not linear: a depth buffer, or one over the distance"),
    (lambda z: 1000 / (1000 - 0.1) * (1 - 0.1 / z), "not linear: a depth buffer, or one over the distance"),
    (lambda z: 1000 / (1000 - 0.001) * (1 - 0.001 / z), "not linear: a depth buffer, or one over the distance"),
    (lambda z: 0.1 / (1000 - 0.1) * (1000 / z - 1), "not linear: a depth buffer, or one over the distance"),
    (lambda z: (z - 0.5) / 20, "does not begin at the camera: scaled between near and far plane"),
    (lambda z: 20 - z, "inverted: it falls with the distance"),
    (lambda z: z * ALONG_THE_RAY, "measured along the ray"),
]


@pytest.fixture(scope="module")
def frame() -> Frame:
    return next(room_frames(SHAPE, 1))


@pytest.mark.parametrize(("encoded", "what"), ENCODINGS)
def test_an_encoding_is_named(frame: Frame, encoded: Callable[[np.ndarray], np.ndarray], what: str) -> None:
    wrong = replace(frame, depth=encoded(frame.depth.astype(np.float64)).astype(np.float32))
    assert [(finding.field, finding.what) for finding in check_frame(wrong).findings] == [("depth", what)]


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_distance_passes_in_any_unit(frame: Frame, scale: float) -> None:
    assert ENCODING.topic in check_frame(replace(frame, depth=np.float32(scale) * frame.depth)).passed


def test_coarse_depth_tells_nothing_rather_than_something_wrong(frame: Frame) -> None:
    report = check_frame(replace(frame, depth=frame.depth.astype(np.float16).astype(np.float32)))
    assert not report.findings


def test_the_origin_of_planes() -> None:
    distance = 1 / np.array([[0.2, 0.25, 0.3], [0.1, 0.15, 0.2], [0.3, 0.25, 0.2]]).T
    assert origin(distance) == 0
    assert origin(distance + 3) == pytest.approx(3)
    assert origin(7 - distance) == pytest.approx(7)

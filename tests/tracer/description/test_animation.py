from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from svgf_cl_tracer import SceneError
from svgf_cl_tracer.description.animation import AnyAnimation


def moved(time: float, point: tuple[float, float, float], **fields: Any) -> np.ndarray:
    animation = TypeAdapter(AnyAnimation).validate_python({"nodes": ["a"]} | fields, strict=False)
    return (animation.motion().matrix(time) @ (*point, 1))[:3]


@pytest.mark.parametrize(("axis", "expected"), [("X", (1, -3, 2)), ("Y", (3, 2, -1)), ("Z", (-2, 1, 3))])
def test_a_turn_is_anticlockwise_about_its_axis(axis: str, expected: tuple[float, float, float]) -> None:
    turn = {"kind": f"rigid rotation about +{axis}", "angle_deg": [0, 90]}
    np.testing.assert_allclose(moved(1.0, (1, 2, 3), **turn), expected, atol=1e-12)


def test_a_turn_takes_a_second_between_angles_unless_said_otherwise() -> None:
    turn = {"kind": "rigid rotation about +Y", "angle_deg": [0, -40, 0], "pivot": [1, 0, 0]}
    for times, reached in ((None, 1.0), ([0, 5, 9], 5.0)):
        x, _, z = moved(reached, (2, 0, 0), times_s=times, **turn) - (1, 0, 0)
        assert np.degrees(np.arctan2(-z, x)) == pytest.approx(-40)
    np.testing.assert_allclose(moved(7.0, (2, 0, 0), **turn), (2, 0, 0), atol=1e-12)


def test_what_repeats_begins_again() -> None:
    turn = {"kind": "rigid rotation about +Y", "angle_deg": [0, 90], "repeats": True}
    np.testing.assert_allclose(moved(1.5, (1, 0, 0), **turn), moved(0.5, (1, 0, 0), **turn), atol=1e-12)


def test_keyframes_scale_then_turn_about_the_pivot_then_move() -> None:
    half = np.sqrt(0.5)
    fields = {
        "kind": "keyframes",
        "pivot": [1, 0, 0],
        "times_s": [0, 2],
        "translation": [[0, 0, 0], [0, 0, 7]],
        "rotation": [[0, 0, 0, 1], [0, 0, half, half]],
        "scale": [[1, 1, 1], [3, 1, 1]],
    }
    np.testing.assert_allclose(moved(0.0, (2, 0, 0), **fields), (2, 0, 0), atol=1e-12)
    np.testing.assert_allclose(moved(2.0, (2, 0, 0), **fields), (1, 3, 7), atol=1e-12)


def test_keyframes_may_be_steps() -> None:
    fields = {"kind": "keyframes", "times_s": [0, 1], "translation": [[0, 0, 0], [2, 0, 0]]}
    assert moved(0.5, (0, 0, 0), **fields)[0] == pytest.approx(1)
    assert moved(0.5, (0, 0, 0), **fields, interpolation="step")[0] == pytest.approx(0)


def test_times_ascend() -> None:
    with pytest.raises(SceneError, match="ascending times"):
        moved(0.0, (0, 0, 0), kind="keyframes", times_s=[1, 0], translation=[[0, 0, 0], [2, 0, 0]])

"""Frame: what is missing or does not fit is refused with the field's name, what was expected and what came."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from svgf_cl import Frame, FrameError
from svgf_cl.frame import CHANNELS, REQUIRED
from tests.frames import TINY, bumpy, only, wall

FRAME = bumpy(np.random.default_rng(0), TINY)


def refused(frame: Frame, field: str, expected: str, got: str) -> None:
    with pytest.raises(FrameError) as error:
        frame.check(TINY)
    assert error.value.field == field
    assert str(error.value) == f"Frame.{field}: expected {expected}, got {got}"


def test_every_field_at_once_is_fine() -> None:
    FRAME.check(TINY)
    assert list(FRAME.present()) == [name for name in Frame.__dataclass_fields__ if getattr(FRAME, name) is not None]
    assert FRAME.shape == TINY


@pytest.mark.parametrize("name", REQUIRED)
def test_required_field_is_missed(name: str) -> None:
    refused(replace(FRAME, **{name: None}), name, "an array", "nothing")


@pytest.mark.parametrize("name", ["direct", "indirect"])
def test_half_a_pair_is_refused(name: str) -> None:
    refused(replace(FRAME, **{name: None}), name, "both of direct and indirect, or neither", "nothing")


def test_some_light_is_needed() -> None:
    refused(only(FRAME, ()), "color", "an array (or direct and indirect in its place)", "nothing")


@pytest.mark.parametrize("name", CHANNELS)
def test_shape_must_fit(name: str) -> None:
    value = getattr(FRAME, name)
    for wrong in (value[:-1], value[:, :-1], value[..., None], value.swapaxes(0, 1), value[0]):
        with pytest.raises(FrameError, match=rf"Frame\.{name}: expected shape \(7, 9.* got shape") as error:
            replace(FRAME, **{name: wrong}).check(TINY)
        assert str(error.value).endswith(str(wrong.shape))


def test_motion_may_have_two_components_or_three() -> None:
    only(FRAME, ("color",), motion=2).check(TINY)
    refused(only(FRAME, ("color",), motion=1), "motion", "shape (7, 9, 2) or (7, 9, 3)", "shape (7, 9, 1)")


@pytest.mark.parametrize("name", CHANNELS)
def test_type_must_fit(name: str) -> None:
    wrong = [bool, complex, float if name == "id" else int]
    kind = "integers (uint32)" if name == "id" else "floating point (float32)"
    for dtype in wrong:
        changed = np.zeros(getattr(FRAME, name).shape, dtype)
        refused(replace(FRAME, **{name: changed}), name, kind, f"dtype {changed.dtype}")


@pytest.mark.parametrize("value", [1.0, [[0.5]], "depth"])
def test_what_is_no_array_is_refused(value: Any) -> None:
    refused(replace(FRAME, depth=value), "depth", "a numpy.ndarray or pyopencl.array.Array", type(value).__name__)


def test_shape_comes_from_depth() -> None:
    with pytest.raises(FrameError, match=r"Frame\.depth: expected an array of shape \(H, W\), got shape \(7, 9, 1\)"):
        _ = replace(wall(TINY), depth=np.ones((*TINY, 1))).shape

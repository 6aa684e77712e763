"""What single numbers tell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame, check_frame
from svgf_cl.check import view
from svgf_cl.io.synthetic import room_frames
from svgf_cl.oracle import temporal

SHAPE = (90, 160)


def at(value: float, pixels: slice = np.s_[:4]) -> Callable[[np.ndarray], np.ndarray]:
    """Some rows of a field replaced."""

    def changed(given: np.ndarray) -> np.ndarray:
        result = given.copy()
        result[pixels] = value
        return result

    return changed


# Field, what becomes of it, what is found, how severe it is.
MISTAKES = [
    ("depth", at(np.nan), "NaN or infinity", "error"),
    ("color", at(np.inf, np.s_[:1, :1]), "NaN or infinity", "warning"),
    ("color", at(-1.0), "negative", "error"),
    ("depth", np.negative, "negative", "error"),
    ("depth", at(0.0), "0 where there is a normal", "error"),
    ("depth", at(1e10), "a finite number where the ray hit nothing", "error"),
    ("depth", lambda given: 0 * given + 1, "one value everywhere", "error"),
    ("color", lambda given: 0 * given, "one value everywhere", "error"),
    ("albedo", lambda given: 0 * given + 1, "one value everywhere", "warning"),
    ("id", lambda given: 0 * given, "one value everywhere", "warning"),
    ("normal", lambda given: 0.5 * given + 0.5, "encoded in 0..1", "error"),
    ("normal", at(0.0), "zero where there is a depth", "error"),
    ("normal", lambda given: 2 * given, "not of unit length", "error"),
    ("albedo", lambda given: 255 * given, "above 1, as if it held emitted light", "error"),
    ("color", lambda given: np.minimum(2 * given, 1), "clipped to 0..1", "error"),
]


# The same of fields that the denoiser only carries, added to the frame: they cost nothing.
CARRIED = [
    ("diffuse", -1.0, "negative"),
    ("specular", np.inf, "NaN or infinity"),
    ("diffuse", 9.0, "the sum with specular and emission is not color"),
    ("roughness", 255.0, "above 1"),
    ("roughness", -0.5, "negative"),
    ("hit_distance", -1.0, "negative"),
    ("hit_distance", -np.inf, "NaN or infinity"),
    ("hit_distance", np.nan, "NaN or infinity"),
]


@pytest.fixture(scope="module")
def frame() -> Frame:
    return next(room_frames(SHAPE, 1))


@pytest.mark.parametrize(("field", "change", "what", "severity"), MISTAKES)
def test_a_wrong_value_is_found(
    frame: Frame, field: str, change: Callable[[np.ndarray], np.ndarray], what: str, severity: str
) -> None:
    given = getattr(frame, field)
    report = check_frame(replace(frame, **{field: change(given).astype(given.dtype)}))
    assert (field, what, severity) in [(f.field, f.what, f.severity) for f in report.findings]


@pytest.fixture(scope="module")
def split(frame: Frame) -> Frame:
    """The frame with its light in two parts, in both ways, and all else that is carried."""
    distance = np.full((*SHAPE, 2), np.inf, np.float32)
    half = 0.5 * frame.color
    roughness = np.full(SHAPE, 0.3, np.float32)
    return replace(
        frame, direct=half, indirect=half, diffuse=half, specular=half, roughness=roughness, hit_distance=distance
    )


def test_fields_that_are_carried_raise_no_alarm(split: Frame) -> None:
    assert not check_frame(split).findings


@pytest.mark.parametrize(("field", "value", "what"), CARRIED)
def test_a_wrong_value_of_what_is_carried_is_a_warning(split: Frame, field: str, value: float, what: str) -> None:
    report = check_frame(replace(split, **{field: at(value)(getattr(split, field))}))
    assert (field, what, "warning") in [(f.field, f.what, f.severity) for f in report.findings]


def test_light_that_is_split_is_whole(split: Frame) -> None:
    (found,) = check_frame(replace(split, direct=0 * split.direct)).findings
    assert (found.field, found.what) == ("direct", "the sum with indirect and emission is not color")
    (found,) = check_frame(replace(split, color=None, diffuse=2 * split.diffuse)).findings
    assert (found.field, found.severity) == ("diffuse", "warning")
    rounded = split.diffuse.astype(np.float16).astype(np.float32)
    assert not check_frame(replace(split, diffuse=rounded)).findings


@pytest.mark.parametrize("number", [np.inf, np.nan, 0.0, -1.0, 1e10, 1e20, 3e38])
def test_where_there_is_no_normal_any_depth_is_a_miss(frame: Frame, number: float) -> None:
    missed = frame.id == 1
    normal = np.where(missed[..., None], 0, frame.normal).astype(np.float32)
    depth = np.where(missed, number, frame.depth).astype(np.float32)
    nan = [("depth", "NaN or infinity")] if np.isnan(number) else []
    assert [(f.field, f.what) for f in check_frame(replace(frame, normal=normal, depth=depth)).findings] == nan


@pytest.mark.parametrize("number", [np.inf, 1e20, 3e38])
def test_an_empty_depth_is_found(frame: Frame, number: float) -> None:
    found = check_frame(replace(frame, depth=np.full(SHAPE, number, np.float32))).findings
    assert ("depth", "empty everywhere") in [(f.field, f.what) for f in found]


def test_nothing_but_sky_is_no_mistake_and_not_passed(frame: Frame) -> None:
    sky = replace(frame, depth=np.full(SHAPE, np.inf, np.float32), normal=0 * frame.normal)
    report = check_frame(sky)
    assert not [found for found in report.findings if found.field in ("depth", "normal")]
    assert "depth: not empty" in {unknown.topic for unknown in report.unknown}


def test_the_denoiser_s_range_of_depth_is_known() -> None:
    assert view.DEPTH_RANGE == temporal.DEPTH_RANGE
    assert np.isclose(view.SHORTEST_NORMAL**2, temporal.NORMAL_FLOOR)


def test_a_sky_is_right(frame: Frame) -> None:
    missed = frame.id == 1
    normal = np.where(missed[..., None], 0, frame.normal).astype(np.float32)
    depth = np.where(missed, np.inf, frame.depth).astype(np.float32)
    assert not check_frame(replace(frame, normal=normal, depth=depth)).findings


def test_short_normals_along_edges_are_right(frame: Frame) -> None:
    """The mean of several samples is shorter than each."""
    normal = frame.normal.copy()
    normal[:, 40:50] *= 0.7
    assert not check_frame(replace(frame, normal=normal)).findings

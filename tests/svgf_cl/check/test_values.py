"""What single numbers tell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl import Frame, check_frame
from svgf_cl.io.synthetic import room_frames

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
    ("depth", at(0.0), "0 where nothing was hit", "error"),
    ("depth", at(1e10), "a finite number where nothing was hit", "error"),
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

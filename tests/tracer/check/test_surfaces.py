"""What becomes of surfaces from frame to frame: ids, depth, directions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from svgf_cl.check.surfaces import DEEPER, NAMES, WORLD, rotation_between
from svgf_cl.frame import Frame
from tests.tracer.check.scenes import asked, good

RNG = np.random.default_rng(1)
AHEAD = [taken.frame for taken in good("contrast")]  # the camera walks ahead
AROUND = [taken.frame for taken in good("cornell")]  # the camera swings around


def with_third(frame: Frame, change: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Frame:
    """A frame whose third component of motion is made of that and of depth."""
    motion = frame.motion.copy()
    motion[..., 2] = change(motion[..., 2], np.where(np.isfinite(frame.depth), frame.depth, 0))
    return replace(frame, motion=motion)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda change, depth: -change, "third component of the wrong sign"),
        (lambda change, depth: depth + change, "third component is the previous depth itself"),
    ],
)
def test_a_wrong_third_component(change: Callable, what: str) -> None:
    assert [found.what for found in asked(DEEPER, [with_third(frame, change) for frame in AHEAD])] == [what]


def test_the_right_third_component() -> None:
    assert not asked(DEEPER, AHEAD)


def test_a_missing_third_component_counts_where_depth_changes_by_more_than_history_bears() -> None:
    bare = [replace(frame, motion=frame.motion[..., :2]) for frame in AHEAD]
    (little,) = asked(DEEPER, bare)
    assert "it was not given" in little.why
    skipping = [
        replace(AHEAD[index], depth=AHEAD[index].depth * 1.05**index, motion=bare[index].motion) for index in range(4)
    ]
    (finding,) = asked(DEEPER, skipping)
    assert (finding.what, finding.severity) == ("without third component", "warning")


def test_ids_of_pixels() -> None:
    noise = [replace(frame, id=RNG.integers(1, 1000, frame.id.shape, np.uint32)) for frame in AROUND]
    assert [found.what for found in asked(NAMES, noise)] == ["changes from pixel to pixel"]


def test_ids_that_are_swapped_between_frames() -> None:
    swapped = [replace(frame, id=(frame.id + index % 2).astype(np.uint32)) for index, frame in enumerate(AROUND)]
    assert [found.what for found in asked(NAMES, swapped)] == ["the same object changes its id between frames"]


def test_ids_and_normals_as_they_should_be() -> None:
    assert not asked(NAMES, AROUND)
    assert not asked(WORLD, AROUND)


def test_the_rotation_between_normals_in_spite_of_outliers() -> None:
    turn, _ = np.linalg.qr(RNG.normal(size=(3, 3)))
    normal = RNG.normal(size=(500, 3))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    past = normal @ turn.T
    past[:100] = normal[100:200]
    np.testing.assert_allclose(rotation_between(normal, past), turn, atol=1e-4)

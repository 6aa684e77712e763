"""The camera's path, told from motion."""

from __future__ import annotations

import numpy as np
import pytest

from svgf_cl import Frame
from svgf_cl.check.camera import FOCAL_LENGTHS, JITTER, offsets, path
from svgf_cl.check.view import View, pixel_centers

SHAPE = (90, 160)
FOCAL = 100.0  # pixels


def rotation(pan: float, tilt: float, roll: float) -> np.ndarray:
    """About y, x and z of a camera that looks along z, in radians."""
    (c, s), (d, t), (e, u) = ((np.cos(angle), np.sin(angle)) for angle in (pan, tilt, roll))
    about_y = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    about_x = np.array([[1, 0, 0], [0, d, -t], [0, t, d]])
    about_z = np.array([[e, -u, 0], [u, e, 0], [0, 0, 1]])
    return about_y @ about_x @ about_z


def seen(turn: np.ndarray, move: tuple[float, float, float], added: tuple[float, float] = (0, 0)) -> View:
    """What a camera that has turned and moved sees of a bumpy landscape, a pixel offset being added to all motion."""
    x, y = pixel_centers(SHAPE)
    depth = 4 + np.sin(x / 9) + np.cos(y / 7)
    past = np.stack([x / FOCAL * depth, y / FOCAL * depth, depth], axis=-1) @ turn.T + move
    motion = FOCAL * past[..., :2] / past[..., 2:] - np.stack([x, y], axis=-1) + added
    tilt = np.where(np.arange(SHAPE[1]) % 2, 0.6, -0.6)  # so that no pixels in a row are on a plane
    normal = np.stack(np.broadcast_arrays(tilt, 0.0, np.full(SHAPE, 0.8)), axis=-1).astype(np.float32)
    return View.of(Frame(color=normal, normal=normal, depth=depth, motion=motion))


@pytest.mark.parametrize("turn", [(0, 0, 0), (0.02, 0, 0), (0.01, -0.02, 0.03)])
@pytest.mark.parametrize("move", [(0, 0, 0), (0.1, 0, 0), (0.02, -0.03, 0.2)])
@pytest.mark.parametrize("added", [(0.0, 0.0), (0.3, -0.2)])
def test_the_path_is_a_rotation_and_an_offset(turn: tuple, move: tuple, added: tuple) -> None:
    found = path(seen(rotation(*turn), move, added))
    assert found is not None
    # Rounding of motion in this scene is of the order of 1e-10 pixels; what is left is the fit's.
    np.testing.assert_allclose(found.offset(np.array([FOCAL]))[0], added, atol=1e-4)
    np.testing.assert_allclose(found.turn(FOCAL), np.hypot(*turn[:2]) + abs(turn[2]), rtol=0.05, atol=1e-5)


def test_jitter_is_told_from_a_pan_whose_focal_length_is_unknown() -> None:
    rng = np.random.default_rng(1)
    pans = [rotation(0.02, 0.01 * frame, 0) for frame in range(6)]
    still = sum(offsets(None, seen(turn, (0.05, 0, 0))) for turn in pans)
    assert not JITTER.judge(still)
    jittered = sum(offsets(None, seen(turn, (0.05, 0, 0), tuple(rng.uniform(-0.5, 0.5, 2)))) for turn in pans)
    (finding,) = JITTER.judge(jittered)
    assert finding.what == "contains jitter"


def test_the_focal_length_that_fits_is_the_camera_s() -> None:
    sums = sum(offsets(None, seen(rotation(0.02, 0.01, 0), (0.1, 0, 0))) for _ in range(2))
    found = FOCAL_LENGTHS[np.argmin(sums[3])] * SHAPE[0]
    assert found == pytest.approx(FOCAL, rel=0.02)


def test_a_thing_that_slides_is_not_jitter() -> None:
    """The same offset in every frame, as a wall makes that slides past."""
    sums = sum(offsets(None, seen(np.eye(3), (0, 0, 0), (0.5, 0))) for _ in range(4))
    (unknown,) = JITTER.judge(sums)
    assert "same offset in every frame" in unknown.why


def test_a_flat_scene_tells_nothing() -> None:
    flat = np.broadcast_to(np.float32([0, 0, 1]), (*SHAPE, 3))
    assert path(View.of(Frame(color=flat, normal=flat, depth=np.full(SHAPE, 3.0), motion=flat[..., :2]))) is None

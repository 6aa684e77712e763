"""Where a tile's motion leads: every tap that a pixel reads inside the image lies in the window that it is led to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from svgf_cl.device.past_windows import Reach, past_windows
from svgf_cl.filters import Accumulation
from svgf_cl.filters.signals import Inputs

SHAPE = (90, 130)
REACH = Reach(1, 2, 0)


def region(seed: int, spread: float, shape: tuple[int, int] = (20, 30)) -> np.ndarray:
    """Motion that differs by `spread` pixels, with some that is no number, and some out of the image."""
    rng = np.random.default_rng(seed)
    motion = rng.uniform(-spread, spread, (*shape, 3)).astype(np.float32) + np.float32(rng.uniform(-40, 40))
    for odd in (np.nan, np.inf, -np.inf, 3e38):
        motion[rng.random(shape) < 0.01, rng.integers(3)] = odd
    return motion


@given(
    st.integers(0, 2**32),
    st.sampled_from([0.0, 0.4, 8.0, 60.0, 1e4]),
    st.tuples(st.integers(8, 90), st.integers(8, 130)),
    st.tuples(st.integers(0, 70), st.integers(0, 100)),
)
def test_every_tap_in_the_image_lies_in_the_window(
    seed: int, spread: float, window: tuple[int, int], first: tuple[int, int]
) -> None:
    motion = region(seed, spread)
    windows = past_windows(motion, first, SHAPE, window, REACH)
    led = np.zeros(motion.shape[:2], int)
    for each in windows:
        for axis in (0, 1):
            assert 0 <= each.origin[axis] <= SHAPE[axis] - window[axis]
            assert each.origin[axis] <= each.corner[axis]
            assert each.corner[axis] + each.size[axis] <= each.origin[axis] + window[axis]
        readers = np.ones(led.shape, bool) if each.readers is None else each.readers
        led += readers
        for y, x in np.argwhere(readers & np.isfinite(motion).all(axis=-1)):
            begin = [first[0] + y + np.floor(motion[y, x, 1]), first[1] + x + np.floor(motion[y, x, 0])]
            taps = [[tap for tap in begin[axis] + np.arange(-1, 3) if 0 <= tap < SHAPE[axis]] for axis in (0, 1)]
            if all(taps):
                for axis in (0, 1):
                    corner, size = each.corner[axis], each.size[axis]
                    assert all(corner <= tap < corner + size for tap in taps[axis])
    assert led.max() == 1


def test_a_pan_takes_one_window_however_far_it_goes() -> None:
    for speed in (0.0, 3.25, -70.5, 1e5):
        assert len(past_windows(np.full((20, 30, 2), speed, np.float32), (40, 60), SHAPE, (24, 34), REACH)) == 1


def test_motion_that_leads_anywhere_takes_several() -> None:
    assert len(past_windows(region(1, 60.0), (30, 40), SHAPE, (24, 34), REACH)) > 4


@pytest.mark.parametrize(("kernel", "reach"), [("temporal", Reach(1, 2, 0)), ("taa", Reach(2, 3, 1))])
def test_reach_follows_from_the_taps(kernel: str, reach: Reach) -> None:
    passes = Accumulation(taa=True).pipeline(Inputs()).passes
    assert Reach.of(next(entry for entry in passes if entry.kernel == kernel)) == reach

"""Where taps lie, and how far the farthest."""

from __future__ import annotations

import pytest

from svgf_cl.filters.taps import CROSS, HERE, Taps, footprint, grid


@pytest.mark.parametrize(
    ("taps", "count", "reach"),
    [(HERE, 1, 0), (CROSS, 5, 1), (grid(1), 9, 1), (grid(2, 16), 25, 32), (grid(1, 4) | grid(1), 17, 4)],
)
def test_grids(taps: Taps, count: int, reach: int) -> None:
    assert (len(taps.offsets), taps.reach) == (count, reach)


def test_footprints_follow_motion_and_need_no_halo() -> None:
    taps = footprint(4)
    assert taps.follow_motion
    assert (len(taps.offsets), taps.reach) == (16, 0)

"""How much memory makes a given number of tiles."""

from __future__ import annotations

import pytest

from benchmarks.tiled import limit
from svgf_cl import Inputs, Kalman, SvgfError
from svgf_cl.device.tiling import Tiling

TILING = Tiling(Kalman().pipeline(Inputs()), (720, 1280), 64)


@pytest.mark.parametrize("tiles", [2, 4, 9])
def test_the_limit_makes_so_many_tiles(tiles: int) -> None:
    window = TILING.window(limit(TILING, tiles), 2**31)
    assert window is not None
    assert len(TILING.tiles(window)) == tiles


def test_a_number_that_cannot_be_is_refused() -> None:
    with pytest.raises(SvgfError, match="--tiles: expected a number that 1280x720 frames can be cut into, got 10007"):
        limit(TILING, 10007)

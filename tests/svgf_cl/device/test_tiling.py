"""How much device memory tiles take."""

from __future__ import annotations

import pytest

from svgf_cl import Inputs
from svgf_cl.device.tiling import Tiling
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from tests.svgf_cl.test_coarse import Coarse

LARGE = (4320, 7680)


@pytest.mark.parametrize("kind", FILTERS.values())
def test_tiles_of_a_large_frame_fit_where_it_does_not(kind: type[Filter]) -> None:
    tiling = Tiling(kind(taa=True).pipeline(Inputs.every()), LARGE, 64)  # type: ignore[call-arg]
    whole = sum(tiling.whole())
    assert tiling.least() < whole / 50
    for share in (2, 5, 20):
        window = tiling.window(whole // share, whole)
        assert window is not None
        assert sum(tiling.sizes(window)) <= whole // share
        assert tiling.indexable(window)
        assert len(tiling.tiles(window)) >= share


def test_no_buffer_is_larger_than_any_may_be() -> None:
    tiling = Tiling(FILTERS["kalman"]().pipeline(Inputs()), LARGE, 64)  # type: ignore[abstract]
    window = tiling.window(2**40, 2**26)
    assert window is not None
    assert max(tiling.sizes(window)) <= 2**26


def test_a_filter_that_cannot_be_cut_is_refused() -> None:
    with pytest.raises(ValueError, match="down: expected to read the previous frame along motion"):
        Tiling(Coarse().pipeline(Inputs()), LARGE, 64)

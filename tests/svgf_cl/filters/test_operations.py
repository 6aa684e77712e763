"""Operations a pixel, where they can be counted by hand."""

from __future__ import annotations

import pytest

from svgf_cl import Inputs
from svgf_cl.filters import operations
from svgf_cl.filters.operations import LightOperations
from svgf_cl.filters.signals import SPLITS


def test_a_pixel_without_albedo_or_emission_is_green_and_a_limit() -> None:
    """Green: two products, two differences, a product; its limit; and one limit a channel."""
    assert operations.modulate(Inputs()) == 2 * 2 + 1 + 1 + 3


@pytest.mark.parametrize("optional", ["albedo", "emission", "id"])
def test_what_a_frame_has_more_costs_no_less(optional: str) -> None:
    more = Inputs(**{optional: True})
    for count in (operations.demodulate, operations.temporal, operations.modulate):
        assert count(more) >= count(Inputs())


def test_signals_share_the_surface() -> None:
    light = LightOperations(weight=5, sums=3, once=7)
    one, two = (operations.wavelet(Inputs(signals=split), 8, light) for split in sorted(SPLITS, key=len))
    assert two - one == 8 * (5 + 3) + 7

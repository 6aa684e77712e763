"""Planes in 32 and in 16 bits: how much they are, and which settings choose them."""

from __future__ import annotations

import pytest

from svgf_cl import Settings
from svgf_cl.filters.formats import Planes, stored
from svgf_cl.filters.pipeline import Inputs

INPUTS = Inputs(signals=2, motion=3, albedo=False, emission=False, id=True)


@pytest.mark.parametrize(("planes", "bits"), [(Planes(3), 96), (Planes(0, 3), 48), (Planes(1, 3), 80)])
def test_depth(planes: Planes, bits: int) -> None:
    assert planes.depth == bits


def test_over_has_room_for_either() -> None:
    assert Planes(1, 4).over(Planes(2, 3)) == Planes(2, 4)


@pytest.mark.parametrize(("planes", "mixed"), [(Planes(3), False), (Planes(0, 3), False), (Planes(1, 3), True)])
def test_mixed(planes: Planes, mixed: bool) -> None:
    assert planes.is_mixed == mixed


@pytest.mark.parametrize(
    ("buffer", "chosen", "expected"),
    [
        ("guide", {}, Planes(5)),
        ("previous guide", {"half_guides": True}, Planes(2, 3)),
        ("guide", {"half_history": True}, Planes(5)),
        ("level 3", {}, Planes(8)),
        ("level 3", {"half_history": True}, Planes(0, 8)),
        ("previous moments", {"half_history": True}, Planes(0, 5)),
        ("modulated", {"half_guides": True, "half_history": True}, Planes(3)),
    ],
)
def test_settings_choose(buffer: str, chosen: dict, expected: Planes) -> None:
    assert stored(buffer, INPUTS, Settings(**chosen)) == expected

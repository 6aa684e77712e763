"""The longest term binds."""

from __future__ import annotations

import pytest

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.cost import Cost, Loads
from svgf_cl.bench.roofline import Bound

CEILINGS = Ceilings([(1000, 100.0), (1000000, 10.0)], aligned_loads=200.0, offset_loads=20.0, flops=50.0)


@pytest.mark.parametrize(
    ("cost", "seconds", "binds"),
    [
        (Cost(1000, Loads(), 100), 10.0, "memory"),
        (Cost(1000, Loads(), 1000), 20.0, "arithmetic"),
        (Cost(1e6, Loads(), 1000), 1e5, "memory"),
        (Cost(1000, Loads(2000, 400), 1000), 30.0, "loads"),
    ],
)
def test_a_bound(cost: Cost, seconds: float, binds: str) -> None:
    bound = Bound.of(cost, cost, CEILINGS)
    assert (bound.seconds, bound.binds) == (pytest.approx(seconds), binds)


def test_what_comes_before_is_in_the_way() -> None:
    """A small pass after a large one finds the cache full of other things."""
    alone, after = (Bound.of(Cost(1000, Loads(), 0), Cost(before, Loads(), 0), CEILINGS) for before in (1000, 2e6))
    assert after.memory == pytest.approx(10 * alone.memory)

"""The longer of both terms binds."""

from __future__ import annotations

import pytest

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.cost import Cost
from svgf_cl.bench.roofline import Bound

CEILINGS = Ceilings([(1000, 100.0), (1000000, 10.0)], flops=50.0)


@pytest.mark.parametrize(
    ("cost", "seconds", "binds"),
    [(Cost(1000, 100), 10.0, "memory"), (Cost(1000, 1000), 20.0, "arithmetic"), (Cost(1e6, 1000), 1e5, "memory")],
)
def test_a_bound(cost: Cost, seconds: float, binds: str) -> None:
    bound = Bound.of(cost, CEILINGS)
    assert (bound.seconds, bound.binds) == (pytest.approx(seconds), binds)

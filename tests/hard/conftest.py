"""Fixtures of the hard cases."""

from __future__ import annotations

import pytest

from tests.hard.variants import VARIANTS, Variant


@pytest.fixture
def variant(request: pytest.FixtureRequest) -> Variant:
    """A way to run the filter, out of those that `tests.hard.variants.on` names."""
    return VARIANTS[request.param]

"""Fixtures of the hard cases."""

from __future__ import annotations

import pytest

from tests.hard.variants import VARIANTS, Variant


@pytest.fixture(params=VARIANTS)
def variant(request: pytest.FixtureRequest) -> Variant:
    """Each way to run the filter: exact, with 16-bit storage, fast; one signal, or two and TAA."""
    return VARIANTS[request.param]

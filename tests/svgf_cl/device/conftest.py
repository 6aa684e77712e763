from __future__ import annotations

import pytest


@pytest.fixture(scope="module", autouse=True)
def narrow_vectors() -> None:
    """No vectors of 4, unlike in the folder above: tests of tunings need each device's own."""

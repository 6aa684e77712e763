from __future__ import annotations

import pytest

pytest.importorskip("embreex")

from benchmarks.tracing.recording import Recording, record
from svgf_cl_tracer import Shot, builtin_scene


@pytest.fixture(scope="session")
def shot() -> Shot:
    """The Cornell box, small: one tree, one batch of rays."""
    return Shot(builtin_scene(), (18, 32), 24)


@pytest.fixture(scope="session")
def recording(shot: Shot) -> Recording:
    """One frame of it."""
    return record(shot, 3)

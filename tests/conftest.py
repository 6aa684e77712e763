"""Fixtures of every test that needs a device. Where no device works the tests fail; they are never skipped."""

from __future__ import annotations

import pyopencl as cl
import pytest

from svgf_cl import devices


@pytest.fixture(scope="session")
def queue() -> cl.CommandQueue:
    """A queue on the default device; choose another with PYOPENCL_CTX."""
    return devices.default_queue()


@pytest.fixture(scope="session")
def context(queue: cl.CommandQueue) -> cl.Context:
    """The context of `queue`."""
    return queue.context

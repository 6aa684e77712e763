"""Fixtures of every test that needs a device. Where no device works the tests fail; they are never skipped."""

from __future__ import annotations

from collections.abc import Iterator

import pyopencl as cl
import pytest

import svgf_cl_tracer  # noqa: F401  # now: what it has compiled lies in the user's own cache folder, not in those below
from svgf_cl.device import devices, tuning
from svgf_cl.io import cache


@pytest.fixture(scope="session", autouse=True)
def untuned(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Every device's default tuning, whatever is stored on this machine."""
    folder = tmp_path_factory.mktemp("untuned")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tuning, "cache_folder", lambda: folder)
        yield


@pytest.fixture(scope="session", autouse=True)
def no_references(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """No reference that an earlier run has kept on this machine, and none left there."""
    folder = tmp_path_factory.mktemp("references")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cache, "cache_folder", lambda: folder)
        yield


@pytest.fixture(scope="session")
def queue() -> cl.CommandQueue:
    """A queue on the default device; choose another with PYOPENCL_CTX."""
    return devices.default_queue()


@pytest.fixture(scope="session")
def context(queue: cl.CommandQueue) -> cl.Context:
    """The context of `queue`."""
    return queue.context

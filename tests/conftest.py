"""Fixtures of every test that needs a device. Where no device works the tests fail; they are never skipped."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pyopencl as cl
import pytest

from svgf_cl.cli import log
from svgf_cl.device import devices, tuning
from svgf_cl.io import cache
from tests.command_line import run

if TYPE_CHECKING:
    from distributed import LocalCluster

# FLIP's threads shall sleep while they have nothing to do: those that spin take half of its CPU time.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")


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


@pytest.fixture(scope="session", autouse=True)
def no_progress() -> Iterator[None]:
    """No lines of progress, however slow this machine is: what else is on stderr is counted."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(log, "SECONDS", float("inf"))
        yield


@pytest.fixture
def untold(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if this process had not tried yet what can be kept, nor told of what cannot."""
    monkeypatch.setattr(cache, "_problems", [])
    monkeypatch.setattr(cache, "_told", [])
    cache.is_usable.cache_clear()


@pytest.fixture(scope="session")
def queue() -> cl.CommandQueue:
    """A queue on the default device; choose another with PYOPENCL_CTX."""
    return devices.default_queue()


@pytest.fixture(scope="session")
def context(queue: cl.CommandQueue) -> cl.Context:
    """The context of `queue`."""
    return queue.context


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """A scheduler with `WORKERS` workers."""
    from tests.cluster import local_cluster  # here: few tests need Dask, which takes a second to import

    with local_cluster() as cluster:
        yield cluster


@pytest.fixture
def frames(rendered: Path, tmp_path: Path) -> Path:
    """A copy of `rendered`, to be broken."""
    return Path(shutil.copytree(rendered, tmp_path / "frames"))


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Callable[..., None]:
    """Check that a command line is refused: exit code 2 and one line on stderr, with these words and no traceback."""

    def check(words: str, *argv: str | Path) -> None:
        capsys.readouterr()
        assert run(*argv) == 2
        said = capsys.readouterr().err
        assert said.startswith("svgf-cl: ")
        assert said.count("\n") == 1, said
        assert words in said

    return check

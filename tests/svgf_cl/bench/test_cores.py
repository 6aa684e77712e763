"""All threads are confined, and let go again."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator

import pytest

from svgf_cl.bench import cores
from svgf_cl.bench.cores import TASKS, confined, core_counts

pytestmark = pytest.mark.skipif(not TASKS.exists(), reason="only Linux lets a process confine all its threads")


@pytest.fixture
def thread() -> Iterator[int]:
    """The number of a thread that waits, as a driver's do."""
    done = threading.Event()
    waiting = threading.Thread(target=done.wait)
    waiting.start()
    yield waiting.native_id or 0
    done.set()
    waiting.join()


def test_every_thread_is_confined_and_let_go(thread: int) -> None:
    before = os.sched_getaffinity(0)
    with confined(1):
        assert os.sched_getaffinity(0) == os.sched_getaffinity(thread) == {min(before)}
    assert os.sched_getaffinity(0) == os.sched_getaffinity(thread) == before


def test_threads_are_let_go_after_an_error() -> None:
    before = os.sched_getaffinity(0)
    with pytest.raises(RuntimeError), confined(1):
        raise RuntimeError
    assert os.sched_getaffinity(0) == before


def test_cores_double_up_to_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(6)))
    assert core_counts() == [1, 2, 4, 6]
    monkeypatch.setattr(cores, "TASKS", TASKS / "nowhere")
    assert core_counts() == []

"""Uploads do not wait for each other, what is in them arrives, and arrays are their owners' again when it says so."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import numpy as np
import pyopencl as cl
import pytest
from numpy.testing import assert_array_equal

from svgf_cl.device.devices import default_queue
from svgf_cl.device.host_copies import HostCopies, PinnedCopies

VALUES = {"depth": np.random.default_rng(0).random((9, 7), np.float32), "id": np.arange(12, dtype=np.uint32)}
DONE = cl.command_execution_status.COMPLETE


@pytest.fixture(scope="module")
def queue() -> cl.CommandQueue:
    return default_queue()


@pytest.fixture
def held_up(queue: cl.CommandQueue) -> Iterator[cl.UserEvent]:
    """An event that all that is put on the queue waits for."""
    go = cl.UserEvent(queue.context)
    cl.enqueue_barrier(queue, wait_for=[go])
    yield go
    if go.command_execution_status != DONE:
        go.set_status(DONE)
    queue.finish()


@pytest.fixture(params=[HostCopies, PinnedCopies])
def copies(request: pytest.FixtureRequest, queue: cl.CommandQueue) -> HostCopies:
    return request.param(queue)


def room(queue: cl.CommandQueue, value: np.ndarray) -> cl.Buffer:
    return cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, value.nbytes)


def assert_holds(queue: cl.CommandQueue, buffer: cl.Buffer, expected: np.ndarray) -> None:
    found = np.empty_like(expected)
    cl.enqueue_copy(queue, found, buffer)
    assert_array_equal(found, expected)


def soon(event: cl.UserEvent) -> None:
    """Let the queue go on while this thread waits for it."""
    threading.Timer(0.1, event.set_status, [DONE]).start()


def test_what_goes_there_comes_back(copies: HostCopies, queue: cl.CommandQueue) -> None:
    for turn in range(3):
        for name, value in VALUES.items():
            buffer = room(queue, value)
            copies.upload(name, value + value.dtype.type(turn), buffer)
            found = np.zeros_like(value)
            copies.download("out", buffer, found)
            assert_array_equal(found, value + value.dtype.type(turn))
    copies.wait()


def test_a_name_may_get_another_size(copies: HostCopies, queue: cl.CommandQueue) -> None:
    for value in (*VALUES.values(), VALUES["depth"][:3], VALUES["depth"]):
        buffer = room(queue, value)
        copies.upload("same", value, buffer)
        copies.forget()
        assert_holds(queue, buffer, value)


def test_the_host_does_not_wait_for_one_upload_before_the_next(
    copies: HostCopies, queue: cl.CommandQueue, held_up: cl.UserEvent
) -> None:
    buffers = {name: room(queue, value) for name, value in VALUES.items()}
    for name, value in VALUES.items():
        copies.upload(name, value, buffers[name])  # else would never return
    soon(held_up)
    copies.wait()
    for name, value in VALUES.items():
        assert_holds(queue, buffers[name], value)


def test_an_array_may_be_changed_after_the_wait(
    copies: HostCopies, queue: cl.CommandQueue, held_up: cl.UserEvent
) -> None:
    value, buffer = VALUES["depth"].copy(), room(queue, VALUES["depth"])
    copies.upload("depth", value, buffer)
    soon(held_up)
    copies.wait()
    value.fill(0)
    assert_holds(queue, buffer, VALUES["depth"])


def test_an_array_that_nobody_else_keeps_arrives(
    copies: HostCopies, queue: cl.CommandQueue, held_up: cl.UserEvent
) -> None:
    buffer = room(queue, VALUES["depth"])
    copies.upload("depth", VALUES["depth"].copy(), buffer)
    others = [np.zeros_like(VALUES["depth"]) for _ in range(99)]  # where the copy was, if it is gone
    held_up.set_status(DONE)
    assert_holds(queue, buffer, VALUES["depth"])
    del others


def test_arrays_are_let_go(copies: HostCopies, queue: cl.CommandQueue) -> None:
    value = VALUES["depth"].copy()
    before = sys.getrefcount(value)
    copies.upload("depth", value, room(queue, value))
    copies.wait()
    assert sys.getrefcount(value) == before


def test_from_pinned_memory_an_array_may_be_changed_at_once(queue: cl.CommandQueue, held_up: cl.UserEvent) -> None:
    value, buffer = VALUES["depth"].copy(), room(queue, VALUES["depth"])
    copies = PinnedCopies(queue)
    copies.upload("depth", value, buffer)
    value.fill(0)
    held_up.set_status(DONE)
    assert_holds(queue, buffer, VALUES["depth"])


def test_pinned_memory_is_not_filled_again_before_it_is_copied(queue: cl.CommandQueue, held_up: cl.UserEvent) -> None:
    first, second = VALUES["depth"], 1 + VALUES["depth"]
    buffers = room(queue, first), room(queue, second)
    copies = PinnedCopies(queue)
    copies.upload("depth", first, buffers[0])
    soon(held_up)
    copies.upload("depth", second, buffers[1])
    assert_holds(queue, buffers[0], first)
    assert_holds(queue, buffers[1], second)


def test_pinned_memory_is_kept_until_it_is_given_back(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    copies, value = PinnedCopies(queue), VALUES["depth"]
    buffer = room(queue, value)
    made: list[int] = []
    usual = cl.Buffer
    monkeypatch.setattr(cl, "Buffer", lambda *arguments: made.append(1) or usual(*arguments))
    for _ in range(3):
        copies.upload("depth", value, buffer)
    assert len(made) == 1
    copies.forget()
    copies.upload("depth", value, buffer)
    assert len(made) == 2

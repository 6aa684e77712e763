"""What a frame waits for: events of its own context that end well."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest

from svgf_cl import ArgumentError, FrameError
from svgf_cl.device.events import pending


def test_events_of_other_queues_are_waited_for(queue: cl.CommandQueue) -> None:
    given, other = (cl.UserEvent(queue.context) for _ in range(2))
    own = cl.enqueue_marker(queue)
    array = cl_array.empty(queue, (1,), np.float32)
    array.events[:] = [own, other]
    assert pending([given], {"depth": array, "color": np.zeros(1)}, queue) == [given, other]


@pytest.mark.parametrize("events", [None, 1])
def test_what_holds_no_events_is_refused(queue: cl.CommandQueue, events: Any) -> None:
    with pytest.raises(ArgumentError, match=r"wait_for\): expected a sequence of pyopencl\.Event, got (NoneType|int)"):
        pending(events, {}, queue)


def test_what_is_no_event_is_refused(queue: cl.CommandQueue) -> None:
    with pytest.raises(ArgumentError, match=r"wait_for\): expected a pyopencl\.Event to wait for, got str"):
        pending(["done"], {}, queue)


def test_an_event_of_another_context_is_refused(queue: cl.CommandQueue) -> None:
    other = cl.Context([queue.device])
    with pytest.raises(ArgumentError, match=r"wait_for\): expected an event, .*, got one of another"):
        pending([cl.UserEvent(other)], {}, queue)


def test_an_event_that_failed_is_refused(queue: cl.CommandQueue) -> None:
    failed = cl.UserEvent(queue.context)
    failed.set_status(cl.status_code.OUT_OF_RESOURCES)
    array = cl_array.empty(queue, (1,), np.float32)
    array.events[:] = [failed]
    with pytest.raises(FrameError, match=r"depth: expected an event that ends well, got one .* failed with status -5"):
        pending([], {"depth": array}, queue)

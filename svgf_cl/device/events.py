"""Collects the events that must complete before a frame's arrays may be read, and reads the times of events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.errors import SvgfError
from svgf_cl.frame import wrong
from svgf_cl.interchange import UserArray


def pending(wait_for: Sequence[cl.Event], arrays: Mapping[str, UserArray], queue: cl.CommandQueue) -> list[cl.Event]:
    """Return the events of `wait_for`, and the events of device arrays that other queues may still be computing.

    Raises
    ------
    FrameError, ArgumentError
        If one is not an event of the queue's context, or its command has failed. Drivers would hang, or not report it.
    """
    try:
        events = [("wait_for", event) for event in wait_for]
    except TypeError as error:
        raise wrong("wait_for", "a sequence of pyopencl.Event", type(wait_for).__name__) from error
    events += [(name, event) for name, value in arrays.items() for event in unfinished(value, queue)]
    for name, event in events:
        check_event(name, event, queue.context)
    return [event for _, event in events]


def unfinished(value: UserArray, queue: cl.CommandQueue) -> Iterator[cl.Event]:
    """Yield the events of a device array on other queues; this queue runs its commands in order anyway."""
    if isinstance(value, cl_array.Array):
        yield from (event for event in value.events if event.command_queue != queue)


def times(queue: cl.CommandQueue, events: Iterable[tuple[str, cl.Event]]) -> Iterator[tuple[str, float]]:
    """Yield the label and the milliseconds of each event, after all commands on the queue.

    Raises
    ------
    SvgfError
        If the queue does not profile.
    """
    if not queue.properties & cl.command_queue_properties.PROFILING_ENABLE:
        raise SvgfError("profile(): the queue was made without PROFILING_ENABLE")
    queue.finish()
    for label, event in events:
        yield label, 1e-6 * (event.profile.end - event.profile.start)


def check_event(name: str, event: cl.Event, context: cl.Context) -> None:
    """Raise the error of `wrong` unless commands of this context can wait for an event."""
    if not isinstance(event, cl.Event):
        raise wrong(name, "a pyopencl.Event to wait for", type(event).__name__)
    if event.get_info(cl.event_info.CONTEXT) != context:
        raise wrong(name, "an event, or an Array, in the context of Denoiser(queue=...)", "one of another context")
    if (status := event.command_execution_status) < 0:
        raise wrong(name, "an event that ends well", f"one whose command failed with status {status}")

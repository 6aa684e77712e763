"""Arrays in buffers of OpenGL: acquired around the passes, refused where a device cannot share them.

No driver that this is tested on shares buffers with OpenGL, so buffers of OpenCL stand in for them, and the commands
that acquire and release them are markers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, DeviceError, Frame, FrameError
from svgf_cl.device import gl_objects
from tests.faults import broken_launch
from tests.frames import FULL, SHAPE, bumpy_sequence

FRAME = bumpy_sequence(FULL, count=1)[0]
OUT = (*SHAPE, 3)


class GLBuffer(cl.Buffer):
    """Stands in for `pyopencl.GLBuffer`."""


class Calls(list[tuple[str, list[int]]]):
    """What was acquired and released, in order."""

    def command(self, name: str) -> Callable[[cl.CommandQueue, Sequence[cl.Buffer]], cl.Event]:
        def call(queue: cl.CommandQueue, objects: Sequence[cl.Buffer]) -> cl.Event:
            self.append((name, [each.int_ptr for each in objects]))
            return cl.enqueue_marker(queue)

        return call


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    """As if pyopencl knew OpenGL."""
    calls = Calls()
    monkeypatch.setattr(gl_objects, "GL_BUFFER", (GLBuffer,))
    for name in ("acquire", "release"):
        monkeypatch.setattr(cl, f"enqueue_{name}_gl_objects", calls.command(name), raising=False)
    return calls


@pytest.fixture
def den(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> Denoiser:
    """As if the device shared buffers with OpenGL."""
    monkeypatch.setattr(gl_objects, "EXTENSION", queue.device.extensions.split()[0])
    return Denoiser(SHAPE, queue=queue)


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return Denoiser(SHAPE).denoise(FRAME)


def in_gl(queue: cl.CommandQueue, value: np.ndarray) -> cl_array.Array:
    buffer = GLBuffer(queue.context, cl.mem_flags.COPY_HOST_PTR, hostbuf=np.ascontiguousarray(value))
    return cl_array.Array(queue, value.shape, value.dtype, data=buffer)


def all_in_gl(frame: Frame, queue: cl.CommandQueue) -> Frame:
    return replace(frame, **{name: in_gl(queue, value) for name, value in frame.present().items()})


def pointers(*arrays: Any) -> set[int]:
    return {value.base_data.int_ptr for value in arrays}


def test_all_are_acquired_before_the_passes_and_released_after(
    den: Denoiser, calls: Calls, expected: np.ndarray
) -> None:
    frame, out = all_in_gl(FRAME, den.queue), in_gl(den.queue, np.zeros(OUT, np.float32))
    den.denoise(frame, out=out)
    assert [name for name, _ in calls] == ["acquire", "release"]
    for _, objects in calls:
        assert set(objects) == pointers(*frame.present().values(), out)
        assert len(objects) == len(set(objects))
    labels = [label for label, _ in den.events]
    assert (labels[0], labels[-1]) == ("acquire GL", "release GL")
    assert_array_equal(out.get(), expected)


def test_a_result_is_ready_when_opengl_has_it_again(den: Denoiser, calls: Calls) -> None:
    out = in_gl(den.queue, np.zeros(OUT, np.float32))
    den.denoise(FRAME, out=out)
    assert den.events[-1][0] == "release GL"
    assert out.events == [den.events[-1][1]]


def test_views_of_one_buffer_are_one_object(den: Denoiser, calls: Calls, expected: np.ndarray) -> None:
    stack = in_gl(den.queue, np.concatenate([FRAME.color, FRAME.normal], axis=-1))
    found = den.denoise(replace(FRAME, color=stack[..., :3], normal=stack[..., 3:]))
    assert calls == [("acquire", [stack.base_data.int_ptr]), ("release", [stack.base_data.int_ptr])]
    assert [label for label, _ in den.events][:3] == ["acquire GL", "gather color", "gather normal"]
    assert_array_equal(found, expected)


def test_they_are_acquired_only_after_what_the_call_waits_for(den: Denoiser, calls: Calls) -> None:
    go = cl.UserEvent(den.queue.context)
    out = den.denoise(all_in_gl(FRAME, den.queue), wait_for=[go])
    acquired = den.events[0][1]
    assert acquired.command_execution_status > cl.command_execution_status.COMPLETE
    go.set_status(cl.command_execution_status.COMPLETE)
    cl.wait_for_events(out.events)


def test_opengl_gets_them_back_after_an_error(den: Denoiser, calls: Calls) -> None:
    with broken_launch(3), pytest.raises(DeviceError):
        den.denoise(all_in_gl(FRAME, den.queue))
    assert [name for name, _ in calls] == ["acquire", "release"]


def test_without_any_nothing_is_acquired(den: Denoiser, calls: Calls) -> None:
    den.denoise(replace(FRAME, depth=cl_array.to_device(den.queue, FRAME.depth)))
    assert calls == []


def test_a_device_that_cannot_share_them_refuses_them(queue: cl.CommandQueue, calls: Calls) -> None:
    if gl_objects.EXTENSION in queue.device.extensions.split():
        pytest.skip(f"{queue.device.name} shares buffers with OpenGL")
    words = r"Frame\.depth: expected an Array in a buffer of OpenCL, as .* lacks cl_khr_gl_sharing, got one in a buffer"
    with pytest.raises(FrameError, match=words):
        Denoiser(SHAPE, queue=queue).denoise(replace(FRAME, depth=in_gl(queue, FRAME.depth)))
    assert calls == []

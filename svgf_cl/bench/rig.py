"""One denoiser made ready to be timed: its frames lie on the device, its history is long, its caches are warm."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.denoiser import Denoiser
from svgf_cl.device.buffers import Buffers
from svgf_cl.device.launch import Launch
from svgf_cl.filters.pipeline import Inputs
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.synthetic import room_frame
from svgf_cl.settings import Settings

WARM_UP = 5  # frames: kernels are built, memory is touched, history is long enough for the temporal variance

# Clocks: the device's, from OpenCL events; the host's, from the call to the result.
EVENT, HOST = "event", "host"


def there_and_back(shape: Shape, signals: int) -> tuple[Frame, Frame]:
    """Two frames of the built-in room to send in turn: the camera goes to and fro, and each frame fits the other."""
    return room_frame(shape, 0, 1, signals=signals), room_frame(shape, 1, 0, signals=signals)


def on_device(queue: cl.CommandQueue, frame: Frame) -> Frame:
    """The same frame as device arrays, without the fields that the denoiser would not read."""
    return Frame(**{name: cl_array.to_device(queue, getattr(frame, name)) for name in Inputs.of(frame).fields})


class TimedDenoiser(Denoiser):
    """A denoiser that, where asked to, waits for every pass and takes the host's time of it."""

    waits = False

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.waited: dict[str, float] = {}

    def _run(self, launch: Launch, planes: Buffers, user: dict[str, cl.Buffer]) -> cl.Event:
        begin = time.perf_counter()
        event = super()._run(launch, planes, user)
        if self.waits:
            event.wait()
            self.waited[launch.entry.name] = time.perf_counter() - begin
        return event

    def span(self) -> float:
        """Seconds on the device from the first pass's start to the last one's end, in the last frame."""
        return 1e-9 * float(self._events[-1][1].profile.end - self._events[0][1].profile.start)


class Rig:
    """Times one denoiser.

    Parameters
    ----------
    frames : pair of Frame
        As `there_and_back` gives them, in host memory.
    settings : Settings
    queue : pyopencl.CommandQueue
        With profiling.
    passes : bool
        Time every pass and the call with numpy arrays too; else the whole frame alone.

    Attributes
    ----------
    samples : mapping from (stage, clock) to list of float, s
        Stage: a pass's name; "atrous", all its levels; "frame", from the first pass to the last or, by the host's
        clock, from the call to the finished result in device memory; "enqueue", until the call returns; "frame numpy",
        the call with arrays in host memory.
    """

    def __init__(
        self, frames: tuple[Frame, Frame], settings: Settings, queue: cl.CommandQueue, *, passes: bool
    ) -> None:
        shape = frames[0].shape
        self.denoiser = TimedDenoiser(shape, settings=settings, queue=queue)
        self.samples: dict[tuple[str, str], list[float]] = defaultdict(list)
        self._host_frames, self._passes = frames, passes
        self._frames = [on_device(queue, frame) for frame in frames]
        self._out = cl_array.empty(queue, (*shape, 3), np.float32)
        self._host_out = np.empty((*shape, 3), np.float32)
        self._count = 0
        for _ in range(WARM_UP):
            self._frame()

    def sample(self, seconds: float) -> None:
        """Take samples for about so many seconds, at least one of each kind; a first frame does not count."""
        end = time.perf_counter() + seconds
        self._frame()
        while True:
            self._whole_frame()
            if self._passes:
                self._pass_by_pass()
                self._with_numpy()
            if time.perf_counter() > end:
                return

    def _whole_frame(self) -> None:
        begin = time.perf_counter()
        self._frame()
        self.samples["enqueue", HOST].append(self._enqueued - begin)
        self.samples["frame", HOST].append(time.perf_counter() - begin)
        self.samples["frame", EVENT].append(self.denoiser.span())
        if self._passes:
            self._add(EVENT, {name: 1e-3 * ms for name, ms in self.denoiser.profile().items()})

    def _pass_by_pass(self) -> None:
        self.denoiser.waits = True
        self._frame()
        self.denoiser.waits = False
        self._add(HOST, self.denoiser.waited)

    def _with_numpy(self) -> None:
        begin = time.perf_counter()
        self.denoiser.denoise(self._next(self._host_frames), out=self._host_out)
        self.samples["frame numpy", HOST].append(time.perf_counter() - begin)

    def _frame(self) -> None:
        """One frame from device memory to device memory."""
        self.denoiser.denoise(self._next(self._frames), out=self._out)
        self._enqueued = time.perf_counter()
        self.denoiser.queue.finish()

    def _add(self, clock: str, seconds: dict[str, float]) -> None:
        """Add one frame's passes, and all its a-trous levels together."""
        for name, value in seconds.items():
            self.samples[name, clock].append(value)
        levels = [value for name, value in seconds.items() if name.startswith("atrous ")]
        self.samples["atrous", clock].append(sum(levels))

    def _next(self, frames: Sequence[Frame]) -> Frame:
        self._count += 1
        return frames[self._count % 2]

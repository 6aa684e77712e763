"""Times one denoiser, after a warm-up: its frames are on the device, its history is long, and its caches are warm."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.denoiser import Denoiser
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.synthetic import room_frame

WARM_UP = 5  # frames; then kernels are built, memory is in use, and history is long enough for the temporal variance

# A row of the benchmark, as the parts of its name: a pass's path, or one of these.
Row = tuple[str, ...]
FRAME: Row = ("frame",)
FRAME_NUMPY: Row = ("frame", "numpy")
ENQUEUE: Row = ("enqueue",)

# Clocks: the device's time from OpenCL events, and the host's time from the call to the result.
EVENT, HOST = "event", "host"


def levels_together(paths: Iterable[Row]) -> dict[Row, list[Row]]:
    """Return the paths that differ only in their level, by the row that stands for all of them."""
    found: dict[Row, list[Row]] = {}
    for path in paths:
        if len(path) > 1:
            found.setdefault(path[:1], []).append(path)
    return found


def there_and_back(shape: Shape, signals: int) -> tuple[Frame, Frame]:
    """Return two frames of the built-in room to denoise in turn: the camera goes back and forth between them."""
    return room_frame(shape, 0, 1, signals=signals), room_frame(shape, 1, 0, signals=signals)


def on_device(queue: cl.CommandQueue, frame: Frame) -> Frame:
    """Return the frame as device arrays, without the fields that the denoiser would not read."""
    return Frame(**{name: cl_array.to_device(queue, getattr(frame, name)) for name in Inputs.of(frame).fields})


class Rig:
    """Times one denoiser.

    Parameters
    ----------
    frames : pair of Frame
        The result of `there_and_back`, in host memory.
    settings : Filter
    queue : pyopencl.CommandQueue
        With profiling.
    passes : bool
        Time also every pass and the call with numpy arrays; else only the whole frame.

    Attributes
    ----------
    samples : mapping from (row, clock) to list of float, s
        The rows are: a pass's path; ("atrous",) for all its levels; ("frame",) from the first pass to the last, or, by
        the host's clock, from the call to the finished result in device memory; ("enqueue",) until the call returns;
        ("frame", "numpy") for the call with arrays in host memory.
    """

    def __init__(self, frames: tuple[Frame, Frame], settings: Filter, queue: cl.CommandQueue, *, passes: bool) -> None:
        shape = frames[0].shape
        self.denoiser = Denoiser(shape, settings=settings, queue=queue, after_pass=self._after_pass)
        self.samples: dict[tuple[Row, str], list[float]] = defaultdict(list)
        self._paths = {entry.label: entry.path for entry in settings.pipeline(Inputs.of(frames[0])).passes}
        self._waits, self._waited, self._since = False, dict[str, float](), 0.0
        self._host_frames, self._passes = frames, passes
        self._frames = [on_device(queue, frame) for frame in frames]
        self._out = cl_array.empty(queue, (*shape, 3), np.float32)
        self._host_out = np.empty((*shape, 3), np.float32)
        self._count = 0
        for _ in range(WARM_UP):
            self._frame()

    def sample(self, seconds: float) -> None:
        """Take samples for about `seconds`, at least one of each kind; a first frame does not count."""
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
        self.samples[ENQUEUE, HOST].append(self._enqueued - begin)
        self.samples[FRAME, HOST].append(time.perf_counter() - begin)
        self.samples[FRAME, EVENT].append(self._span())
        if self._passes:
            self._add(EVENT, {name: 1e-3 * ms for name, ms in self.denoiser.profile().items()})

    def _pass_by_pass(self) -> None:
        self._waits, self._since = True, time.perf_counter()
        self._frame()
        self._waits = False
        self._add(HOST, self._waited)

    def _after_pass(self, label: str, event: cl.Event) -> None:
        """Wait for the pass and take the host's time, if passes are timed one by one."""
        if self._waits:
            event.wait()
            now = time.perf_counter()
            self._waited[label], self._since = now - self._since, now

    def _span(self) -> float:
        """Return the seconds on the device from the first pass's start to the last one's end, in the last frame."""
        events = self.denoiser.events
        return 1e-9 * float(events[-1][1].profile.end - events[0][1].profile.start)

    def _with_numpy(self) -> None:
        begin = time.perf_counter()
        self.denoiser.denoise(self._next(self._host_frames), out=self._host_out)
        self.samples[FRAME_NUMPY, HOST].append(time.perf_counter() - begin)

    def _frame(self) -> None:
        """Denoise one frame from device memory to device memory."""
        self.denoiser.denoise(self._next(self._frames), out=self._out)
        self._enqueued = time.perf_counter()
        self.denoiser.queue.finish()

    def _add(self, clock: str, seconds: dict[str, float]) -> None:
        """Add the samples of one frame's passes, and the sums over the levels of a pass."""
        by_path = {self._paths[label]: value for label, value in seconds.items()}
        for path, value in by_path.items():
            self.samples[path, clock].append(value)
        for row, paths in levels_together(by_path).items():
            self.samples[row, clock].append(sum(by_path[path] for path in paths))

    def _next(self, frames: Sequence[Frame]) -> Frame:
        self._count += 1
        return frames[self._count % 2]

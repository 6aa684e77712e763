"""`Denoiser`: the pass table of `svgf_cl.passes` put to work on a device."""

from __future__ import annotations

import itertools
import operator
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl import devices, programs
from svgf_cl.buffers import Buffers
from svgf_cl.errors import FrameError, SvgfError
from svgf_cl.frame import Frame, Shape
from svgf_cl.launch import Grid, Launch
from svgf_cl.memory import memory_slots
from svgf_cl.passes import OUT, Inputs, Pass, pipeline
from svgf_cl.planes import Layout
from svgf_cl.settings import Settings
from svgf_cl.stages import StageView, stage_views
from svgf_cl.storage import stored
from svgf_cl.tuning import Tuning, best_tuning
from svgf_cl.user_arrays import UserArray, UserArrays, check_out


@dataclass(frozen=True)
class Plan:
    """The pass table made ready for frames with one set of fields, and the history of the sequence so far."""

    inputs: Inputs
    planes: Buffers
    turns: Iterator[tuple[Launch, ...]]
    views: dict[str, StageView]

    def next_frame(self) -> tuple[Launch, ...]:
        """The launches of the next frame, after what was written in the last one became history."""
        self.planes.begin_frame()
        return next(self.turns)


class Denoiser:
    """Denoises a sequence of frames of one size, one call a frame; for one thread at a time.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels, each >= 1.
    settings : Settings, optional
        Parameters of the filter.
    queue : pyopencl.CommandQueue, optional
        In-order queue to work on; by default one on the fastest working device (`svgf_cl.devices.default_queue`).
    keep_stages : bool
        Copy every stage aside, so that `stage` can read all of them; by default some make room for later ones.
    tuning : Tuning, optional
        How to cut the work on this device; by default what ``svgf-cl tune`` found best, else what suits most.

    Attributes
    ----------
    shape, settings, queue, tuning
        What is in use.

    Raises
    ------
    SvgfError
        If `shape` is no image, `queue` is not in order, no OpenCL device works (`DeviceError`), or `tuning` is not for
        the device.

    Examples
    --------
    >>> den = Denoiser((height, width))
    >>> out = den.denoise(Frame(color=color, normal=normal, depth=depth, motion=motion))
    """

    def __init__(
        self,
        shape: Shape,
        *,
        settings: Settings | None = None,
        queue: cl.CommandQueue | None = None,
        keep_stages: bool = False,
        tuning: Tuning | None = None,
    ) -> None:
        self.shape = check_shape(shape)
        self.settings = check_settings(settings)
        self.queue = check_queue(queue)
        self.tuning = check_tuning(tuning, self.queue.device)
        self._layout = layout_of(self.shape, self.tuning.row_alignment)
        self._keep_stages = keep_stages
        self._arrays = UserArrays(self.queue)
        self._plan: Plan | None = None
        self._events: list[tuple[str, cl.Event]] = []

    def denoise(self, frame: Frame, *, out: Any = None, wait_for: Sequence[cl.Event] = ()) -> Any:
        """Filter the next frame of the sequence.

        Parameters
        ----------
        frame : Frame
            Every field of this denoiser's shape. The set of fields must stay the same until `reset`.
        out : (H, W, 3) float32 C-contiguous ndarray or Array, optional
            Where to put the result.
        wait_for : sequence of pyopencl.Event
            What must be complete before the frame's Arrays are read, beside what the Arrays themselves know of.

        Returns
        -------
        (H, W, 3) float32
            Linear HDR radiance: `out` if given; else an Array, perhaps still being computed on `queue`, if every
            field is an Array; else an ndarray.

        Raises
        ------
        FrameError
            If a field is missing, of another shape or type, or on another context, if the set of fields changed, or if
            `out` is the memory of a field.
        SvgfError
            If the device has no room (on the first frame), or cannot build a kernel (`DeviceError`).
        """
        frame.check(self.shape)
        inputs = Inputs.of(frame)
        result = self._result(frame) if out is None else out
        check_out(result, (*self.shape, 3))
        fields = {name: getattr(frame, name) for name in inputs.fields}
        buffers = self._arrays.buffers(fields, result)
        plan = self._ready(inputs)
        with self._arrays.in_use(buffers, result):
            if pending := [*wait_for, *unfinished([*fields.values(), result], self.queue)]:
                cl.enqueue_barrier(self.queue, wait_for=pending)
            self._events = [
                (launch.entry.name, self._run(launch, plan.planes, buffers)) for launch in plan.next_frame()
            ]
        if isinstance(result, cl_array.Array):
            result.add_event(self._events[-1][1])
            self.queue.flush()  # whoever waits for that event on another queue must not wait for ever
        return result

    def reset(self) -> None:
        """Forget the past: call it at a camera cut, or to send frames with other fields."""
        self._plan = None
        self._events = []

    def profile(self) -> dict[str, float]:
        """Milliseconds on the device of each pass of the last frame, in order, from OpenCL events."""
        if not self.queue.properties & cl.command_queue_properties.PROFILING_ENABLE:
            raise SvgfError("profile(): the queue was made without PROFILING_ENABLE")
        self.queue.finish()
        return {name: 1e-6 * (event.profile.end - event.profile.start) for name, event in self._events}

    @property
    def stages(self) -> list[str]:
        """Names that `stage` understands; empty before the first frame."""
        return list(self._plan.views) if self._plan else []

    def stage(self, name: str) -> np.ndarray:
        """An intermediate result of the last frame, for debugging.

        Parameters
        ----------
        name : str
            One of `stages`, such as "history_length", "variance" or "level_2".

        Returns
        -------
        (H, W), (H, W, 3), or the same with a leading axis of signals; float32

        Raises
        ------
        SvgfError
            If there is no such stage, or its memory went to a later stage of the frame.
        """
        if self._plan is None or name not in self._plan.views:
            raise SvgfError(f"stage: expected one of {', '.join(self.stages) or 'none before a frame'}; got {name!r}")
        view = self._plan.views[name]
        if not self._plan.planes.survives(view.buffer):
            raise SvgfError(f"stage: {name!r} was overwritten by a later pass; use Denoiser(..., keep_stages=True)")
        return view.of(self._layout.crop(self._plan.planes.read(view.buffer).view(view.dtype)))

    @property
    def nbytes(self) -> int:
        """Device memory held for planes, in bytes; 0 before the first frame."""
        return self._plan.planes.nbytes if self._plan else 0

    def _ready(self, inputs: Inputs) -> Plan:
        """The plan for these inputs, made on the first frame: kernels built, history blank."""
        if self._plan is None:
            passes = pipeline(inputs, self.settings)
            planes = self._planes(passes, inputs)
            turns = itertools.cycle(self._turns(passes, inputs, planes))
            self._plan = Plan(inputs, planes, turns, stage_views(passes, inputs, self.settings))
        if inputs != self._plan.inputs:
            raise FrameError("fields", f"{self._plan.inputs} as before, or a call of reset", str(inputs))
        return self._plan

    def _planes(self, passes: tuple[Pass, ...], inputs: Inputs) -> Buffers:
        sizes = {name: stored(name, inputs, self.settings) for entry in passes for name in entry.writes if name != OUT}
        return Buffers(self.queue, self._layout, memory_slots(passes, sizes))

    def _turns(self, passes: tuple[Pass, ...], inputs: Inputs, planes: Buffers) -> list[tuple[Launch, ...]]:
        """The launches of odd and of even frames: this frame's buffers and the history take turns."""
        turns = []
        for _ in range(2):
            planes.begin_frame()
            turns.append(tuple(self._launch(entry, inputs, planes) for entry in passes))
        return turns

    def _launch(self, entry: Pass, inputs: Inputs, planes: Buffers) -> Launch:
        defines = {"VW": self.tuning.vector_width, **inputs.defines, **self.settings.defines}
        program = programs.build(self.queue.context, self.queue.device, entry.stage, defines)
        kernel = cl.Kernel(program, entry.kernel)
        scalars = [] if entry.step is None else [np.int32(entry.step)]
        scalars += [np.float32(getattr(self.settings, name)) for name in entry.settings]
        user = {*inputs.fields, OUT}
        buffers = [name if name in user else planes[name] for name in (*entry.reads, *entry.writes)]
        work_group = fitting(self.tuning.work_group, kernel, self.queue.device)
        work_items = self._layout.work_items(self.tuning.vector_width, work_group, entry.step or 1)
        return Launch(entry, kernel, (self._layout.size, *scalars, *buffers), work_items, work_group)

    def _run(self, launch: Launch, planes: Buffers, user: dict[str, cl.Buffer]) -> cl.Event:
        event = launch.enqueue(self.queue, user)
        for name in launch.entry.writes:
            if self._keep_stages and name != OUT:
                planes.copy_aside(name)
        return event

    def _result(self, frame: Frame) -> Any:
        """A new array for the result, of the same kind as the frame's."""
        shape = (*self.shape, 3)
        if all(isinstance(value, cl_array.Array) for value in frame.present().values()):
            return cl_array.empty(self.queue, shape, np.float32)
        return np.empty(shape, np.float32)


def unfinished(arrays: Sequence[UserArray], queue: cl.CommandQueue) -> Iterator[cl.Event]:
    """Events of device arrays that may still be being computed: on another queue, as this one keeps its order."""
    for value in arrays:
        if isinstance(value, cl_array.Array):
            yield from (event for event in value.events if event.command_queue != queue)


def check_settings(settings: Settings | None) -> Settings:
    """The defaults for None; `SvgfError` for anything that is not `Settings`."""
    if settings is None:
        return Settings()
    if not isinstance(settings, Settings):
        raise SvgfError(f"Denoiser: expected settings=Settings(...), got {settings!r}")
    return settings


def check_queue(queue: cl.CommandQueue | None) -> cl.CommandQueue:
    """A queue on the default device for None; `SvgfError` for one that may run the passes out of order."""
    if queue is None:
        return devices.default_queue()
    if queue.properties & cl.command_queue_properties.OUT_OF_ORDER_EXEC_MODE_ENABLE:
        raise SvgfError("Denoiser: expected an in-order queue, got one with OUT_OF_ORDER_EXEC_MODE_ENABLE")
    return queue


def check_tuning(tuning: Tuning | None, device: cl.Device) -> Tuning:
    """The best known for None; `SvgfError` for one that is not for this device."""
    if tuning is None:
        return best_tuning(device)
    if not isinstance(tuning, Tuning):
        raise SvgfError(f"Denoiser: expected tuning=Tuning(...), got {tuning!r}")
    tuning.check(device)
    return tuning


def fitting(work_group: Grid, kernel: cl.Kernel, device: cl.Device) -> Grid:
    """A work-group cut to what a device can run of one kernel: fewer, where that takes many registers."""
    most = kernel.get_work_group_info(cl.kernel_work_group_info.WORK_GROUP_SIZE, device)
    along = min(work_group[0], most)
    return along, min(work_group[1], most // along)


def layout_of(shape: Shape, row_alignment: int) -> Layout:
    """The layout of an image; `SvgfError` where it is too large for the kernels' indices."""
    layout = Layout(*shape, row_alignment)
    if not layout.indexable:
        raise SvgfError(f"Denoiser: expected an image of at most about 16000 x 16000 pixels, got {shape!r}")
    return layout


def check_shape(shape: Shape) -> Shape:
    """(height, width) as plain integers; `SvgfError` unless both are whole numbers of at least 1."""
    try:
        height, width = (operator.index(side) for side in shape)
    except (TypeError, ValueError) as error:
        raise SvgfError(f"Denoiser: expected shape (height, width), got {shape!r}") from error
    if height < 1 or width < 1:
        raise SvgfError(f"Denoiser: expected a shape of at least 1 x 1 pixel, got {shape!r}")
    return height, width

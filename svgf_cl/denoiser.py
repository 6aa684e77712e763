"""`Denoiser`: the pass table of `svgf_cl.filters.pipeline` put to work on a device."""

from __future__ import annotations

import itertools
import math
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device import programs
from svgf_cl.device.arguments import check_queue, check_settings, check_shape, check_tuning, held, layout_of
from svgf_cl.device.buffers import Buffers
from svgf_cl.device.events import pending
from svgf_cl.device.launch import Grid, Launch
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.device.opencl_errors import allocate, opencl_errors
from svgf_cl.device.tuning import Tuning
from svgf_cl.device.user_arrays import UserArrays, check_out
from svgf_cl.errors import FrameError, SvgfError, shown
from svgf_cl.filters.formats import stored
from svgf_cl.filters.pipeline import OUT, Inputs, Pass, pipeline
from svgf_cl.filters.stages import StageView, stage_views
from svgf_cl.frame import Frame, Shape, UserArray
from svgf_cl.settings import Settings

# What to do after an error of the device.
NOT_BEGUN = "the frame was not begun, so the next one goes on from the last; if this stays, make a new Denoiser"
BROKEN_OFF = "the past is forgotten, as by reset, so the next frame begins anew; if this stays, make a new Denoiser"
NOT_READ = "if this stays, make a new Denoiser"


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
    """Denoises a sequence of frames of one size, one call a frame.

    Threads may share one: a call waits for that of another thread to end. Denoisers do not disturb each other.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels, each >= 1.
    settings : Settings, optional
        Parameters of the filter.
    queue : pyopencl.CommandQueue, optional
        In-order queue to work on; by default one on the fastest working device (`svgf_cl.device.devices.default_queue`).
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
        If `shape` is no image, `queue` is not in order or dead, no OpenCL device works (`DeviceError`), or `tuning` is
        not for the device.

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
        self._queue = held(self.queue)
        self._layout = layout_of(self.shape, self.tuning.row_alignment)
        self._keep_stages = keep_stages
        self._arrays = UserArrays(self._queue)
        self._plan: Plan | None = None
        self._events: list[tuple[str, cl.Event]] = []
        self._turn = threading.RLock()

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
            If a field is missing, of another shape or type, or on another context, if the set of fields changed, if
            `out` is the memory of a field, or if an event failed. The call counts as not made.
        DeviceError
            If the device has no room, or cannot build a kernel: the call counts as not made. If it breaks off in the
            middle of the frame: the past is forgotten, as by `reset`.
        """
        if not isinstance(frame, Frame):
            raise SvgfError(f"denoise(frame): expected a Frame, got {type(frame).__name__}")
        frame.check(self.shape)
        if out is not None:
            check_out(out, (*self.shape, 3))
        inputs = Inputs.of(frame)
        fields = {name: getattr(frame, name) for name in inputs.fields}
        with self._turn:
            with opencl_errors(self._queue.device, "denoise", NOT_BEGUN):
                plan = self._ready(inputs)
                result = self._result(frame) if out is None else out
                events = pending(wait_for, {**fields, OUT: result}, self._queue)
                buffers = self._arrays.buffers(fields, result)
            self._filter(plan, buffers, result, events)
        return result

    def reset(self) -> None:
        """Forget the past: call it at a camera cut, or to send frames with other fields."""
        with self._turn:
            self._plan = None
            self._events = []

    def profile(self) -> dict[str, float]:
        """Milliseconds on the device of each pass of the last frame, in order, from OpenCL events."""
        if not self._queue.properties & cl.command_queue_properties.PROFILING_ENABLE:
            raise SvgfError("profile(): the queue was made without PROFILING_ENABLE")
        with self._turn, opencl_errors(self._queue.device, "profile", NOT_READ):
            self._queue.finish()
            return {name: 1e-6 * (event.profile.end - event.profile.start) for name, event in self._events}

    @property
    def stages(self) -> list[str]:
        """Names that `stage` understands; empty before the first frame."""
        with self._turn:
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
        with self._turn, opencl_errors(self._queue.device, "stage", NOT_READ):
            if self._plan is None or not isinstance(name, str) or name not in self._plan.views:
                known = ", ".join(self.stages) or "none before a frame"
                raise SvgfError(f"stage: expected one of {known}; got {shown(name)}")
            view = self._plan.views[name]
            if not self._plan.planes.survives(view.buffer):
                raise SvgfError(f"stage: {name!r} was overwritten by a later pass; use Denoiser(..., keep_stages=True)")
            return view.of(self._layout.crop(self._plan.planes.read(view.buffer).view(view.dtype)))

    @property
    def nbytes(self) -> int:
        """Device memory held for planes, in bytes; 0 before the first frame."""
        with self._turn:
            return self._plan.planes.nbytes if self._plan else 0

    def _ready(self, inputs: Inputs) -> Plan:
        """The plan for these inputs, made for a first frame: kernels built, history blank."""
        if self._plan is None:
            passes = pipeline(inputs, self.settings)
            planes = self._planes(passes, inputs)
            turns = itertools.cycle(self._turns(passes, inputs, planes))
            return Plan(inputs, planes, turns, stage_views(passes, inputs, self.settings))
        if inputs != self._plan.inputs:
            raise FrameError("fields", f"{self._plan.inputs} as before, or a call of reset", str(inputs))
        return self._plan

    def _filter(self, plan: Plan, buffers: dict[str, cl.Buffer], result: UserArray, events: list[cl.Event]) -> None:
        """Run the passes; where they break off the past is forgotten, as half a frame is no history."""
        self.reset()
        with opencl_errors(self._queue.device, "denoise", BROKEN_OFF):
            with self._arrays.in_use(buffers, result):
                if events:
                    cl.enqueue_barrier(self._queue, wait_for=events)
                done = [(launch.entry.name, self._run(launch, plan.planes, buffers)) for launch in plan.next_frame()]
            if isinstance(result, cl_array.Array):
                result.add_event(done[-1][1])
                self._queue.flush()  # whoever waits for that event on another queue must not wait for ever
        self._plan, self._events = plan, done

    def _planes(self, passes: tuple[Pass, ...], inputs: Inputs) -> Buffers:
        sizes = {name: stored(name, inputs, self.settings) for entry in passes for name in entry.writes if name != OUT}
        return Buffers(self._queue, self._layout, memory_slots(passes, sizes), copies=self._keep_stages)

    def _turns(self, passes: tuple[Pass, ...], inputs: Inputs, planes: Buffers) -> list[tuple[Launch, ...]]:
        """The launches of odd and of even frames: this frame's buffers and the history take turns."""
        turns = []
        for _ in range(2):
            planes.begin_frame()
            turns.append(tuple(self._launch(entry, inputs, planes) for entry in passes))
        return turns

    def _launch(self, entry: Pass, inputs: Inputs, planes: Buffers) -> Launch:
        defines = {"VW": self.tuning.vector_width, **inputs.defines, **self.settings.defines}
        program = programs.build(self._queue.context, self._queue.device, entry.stage, defines)
        kernel = cl.Kernel(program, entry.kernel)
        scalars = [] if entry.step is None else [np.int32(entry.step)]
        scalars += [np.float32(getattr(self.settings, name)) for name in entry.settings]
        user = {*inputs.fields, OUT}
        buffers = [name if name in user else planes[name] for name in (*entry.reads, *entry.writes)]
        work_group = fitting(self.tuning.work_group, kernel, self._queue.device)
        work_items = self._layout.work_items(self.tuning.vector_width, work_group, entry.step or 1)
        return Launch(entry, kernel, (self._layout.size, *scalars, *buffers), work_items, work_group)

    def _run(self, launch: Launch, planes: Buffers, user: dict[str, cl.Buffer]) -> cl.Event:
        event = launch.enqueue(self._queue, user)
        for name in launch.entry.writes:
            if self._keep_stages and name != OUT:
                planes.copy_aside(name)
        return event

    def _result(self, frame: Frame) -> Any:
        """A new array for the result, of the same kind as the frame's."""
        shape = (*self.shape, 3)
        if all(isinstance(value, cl_array.Array) for value in frame.present().values()):
            nbytes = 4 * math.prod(shape)
            return cl_array.Array(self._queue, shape, np.float32, data=allocate(self._queue, nbytes, nbytes))
        return np.empty(shape, np.float32)


def fitting(work_group: Grid, kernel: cl.Kernel, device: cl.Device) -> Grid:
    """A work-group cut to what a device can run of one kernel: fewer, where that takes many registers."""
    most = kernel.get_work_group_info(cl.kernel_work_group_info.WORK_GROUP_SIZE, device)
    along = min(work_group[0], most)
    return along, min(work_group[1], most // along)

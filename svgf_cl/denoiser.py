"""`Denoiser`: checks what it is given, and runs a filter's plan frame by frame."""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, NoReturn

import numpy as np
import pyopencl as cl
import pyopencl.array as cl_array

from svgf_cl.device.arguments import (
    AfterPass,
    check_filter,
    check_hook,
    check_inputs,
    check_queue,
    check_shape,
    check_tuning,
    held,
    layout_of,
)
from svgf_cl.device.array_checks import check_out
from svgf_cl.device.events import pending
from svgf_cl.device.gl_objects import acquired
from svgf_cl.device.opencl_errors import allocate, opencl_errors
from svgf_cl.device.process import check_process, is_forked
from svgf_cl.device.tuning import Tuning
from svgf_cl.device.user_arrays import Exchange, UserArrays
from svgf_cl.errors import ArgumentError, SvgfError, shown
from svgf_cl.filters import DEFAULT
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.pipeline import OUT, Pipeline
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import ALPHA, Frame, Shape, extent
from svgf_cl.interchange import UserArray
from svgf_cl.plan import Plan, Workplace

# What to do after an error of the device.
NOT_BEGUN = "the frame was not begun, so the next one goes on from the last; if this stays, make a new Denoiser"
BROKEN_OFF = "the past is forgotten, as by reset, so the next frame begins anew; if this stays, make a new Denoiser"
UNCHANGED = "nothing was changed; if this stays, make a new Denoiser"


class Denoiser:
    """Denoises a sequence of frames of one size, one call a frame.

    Threads may share one: a call waits for that of another thread to end. Denoisers do not disturb each other. It may
    stand in a ``with``, at whose end it is closed. It does not survive a fork: a process that was forked off gets a
    `DeviceError`, so start processes with multiprocessing's "spawn", and make a denoiser in each.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels, each >= 1.
    settings : Filter, optional
        Which filter, and its parameters: `Kalman`, the default, `Settings` for SVGF, `Eaw`.
    queue : pyopencl.CommandQueue, optional
        In-order queue to work on; by default one on the fastest working device
        (`svgf_cl.device.devices.default_queue`).
    keep_stages : bool
        Copy every stage aside, so that `stage` can read all of them; by default some make room for later ones.
    tuning : Tuning, optional
        How to cut the work on this device; by default what ``svgf-cl tune`` found best, else what suits most.
    after_pass : callable, optional
        Is told the label and the event of every pass as soon as it is on the queue, to watch or time them one by one.
        What it raises breaks off the frame. It may not call the denoiser.

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
        settings: Filter | None = None,
        queue: cl.CommandQueue | None = None,
        keep_stages: bool = False,
        tuning: Tuning | None = None,
        after_pass: AfterPass | None = None,
    ) -> None:
        self._shape = check_shape(shape)
        self._settings = DEFAULT() if settings is None else check_filter(settings)
        self._queue = check_queue(queue)
        self._tuning = check_tuning(tuning, self._queue.device)
        self._after_pass = check_hook(after_pass)
        layout = layout_of(self._shape, self._tuning, self._settings)
        self._workplace = Workplace(held(self._queue), layout, self._tuning, keep_stages)
        self._arrays: UserArrays | None = UserArrays(self._workplace.queue, pinned=self._tuning.pinned_copies)
        self._plan: Plan | None = None
        self._inputs: Inputs | None = None
        self._is_cut = True
        self._is_running = False
        self._events: tuple[tuple[str, cl.Event], ...] = ()
        self._lock = threading.RLock()

    @property
    def shape(self) -> Shape:
        """(height, width) of every frame; `resize` changes it."""
        return self._shape

    @property
    def settings(self) -> Filter:
        """The filter and its parameters; `update` changes them."""
        return self._settings

    @property
    def queue(self) -> cl.CommandQueue:
        """The queue that it works on."""
        return self._queue

    @property
    def tuning(self) -> Tuning:
        """How the work is cut on this device."""
        return self._tuning

    def denoise(self, frame: Frame, *, out: Any = None, wait_for: Sequence[cl.Event] = ()) -> Any:
        """Filter the next frame of the sequence.

        Parameters
        ----------
        frame : Frame
            Every field of this denoiser's shape. The set of fields must stay the same until `reset`.
        out : (H, W, 3) float32 C-contiguous ndarray or Array, optional
            Where to put the result; (H, W, 4) where `color` has alpha. An Array may have strides and an offset.
        wait_for : sequence of pyopencl.Event
            What must be complete before the frame's Arrays are read, beside what the Arrays themselves know of.

        Returns
        -------
        (H, W, 3) float32, or (H, W, 4) where `color` has alpha
            Linear HDR radiance, and the alpha of `color` as it was: `out` if given; else an Array, perhaps still being
            computed on `queue`, if every field is an Array; else an ndarray.

        Raises
        ------
        FrameError
            If a field is missing, of another shape or type, on another context, or in memory that the device cannot
            use (SVM, OpenGL). The call counts as not made.
        ArgumentError
            If the set of fields changed, if `out` is of another shape or type, if as an Array it is the memory of a
            field, or if an event failed. The call counts as not made.
        DeviceError
            If the device has no room, or cannot build a kernel: the call counts as not made. If it breaks off in the
            middle of the frame: the past is forgotten, as by `reset`.
        """
        if not isinstance(frame, Frame):
            raise SvgfError(f"denoise(frame): expected a Frame, got {type(frame).__name__}")
        with self._in_turn() as arrays:
            frame.check(self._shape)
            if out is not None:
                check_out(out, frame.picture_shape)
            with self._opencl_errors("denoise", NOT_BEGUN):
                inputs = Inputs.of(frame)
                plan = self._ready(inputs, "denoise(frame)")
                names = (*plan.pipeline.fields, *([ALPHA] if frame.has_alpha else []))
                fields = {name: frame.layer(name) for name in names}
                result = self._result(frame) if out is None else out
                events = pending(wait_for, {**fields, OUT: result}, self._workplace.queue)
                exchange = arrays.exchange(fields, result)
            self._plan, self._inputs = plan, inputs
            self._run(plan, arrays, exchange, result, events)
        return result

    def warm_up(self, inputs: Inputs) -> None:
        """Build kernels and take memory for frames that supply `inputs`, so that the first is not slower.

        Raises
        ------
        SvgfError
            If `inputs` are none, or not those of the sequence that has begun; `DeviceError` as by `denoise`.
        """
        check_inputs(inputs)
        with self._in_turn(), self._opencl_errors("warm_up", UNCHANGED):
            self._plan, self._inputs = self._ready(inputs, "warm_up(inputs)"), inputs
            self._workplace.queue.finish()

    def reset(self) -> None:
        """Forget the past, but keep kernels and memory: for a camera cut, or to send frames with other fields."""
        with self._in_turn():
            self._cut()

    def update(self, settings: Filter) -> bool:
        """Go on with other settings, or with another filter.

        The past is kept, unless it is another filter's or stored in another way (half_guides, half_history): then the
        next frame begins anew. Where kernels or passes change, both the old memory and the new are held for a moment.

        Returns
        -------
        bool
            Whether kernels were built or memory taken anew, which takes longer than a frame; numbers change without.
        """
        check_filter(settings)
        with self._in_turn(), self._opencl_errors("update", UNCHANGED):
            layout_of(self._shape, self._tuning, settings)  # whose buffers may be larger
            rebuilt = False
            if self._plan and self._inputs:
                pipeline = settings.pipeline(self._inputs)
                rebuilt = not pipeline.differs_in_scalars_alone(self._plan.pipeline)
                if rebuilt:
                    self._rebuild(self._plan, pipeline, same_filter=type(settings) is type(self._settings))
                else:
                    self._plan.set_scalars(pipeline)
            self._settings = settings
            return rebuilt

    def resize(self, shape: Shape) -> None:
        """Go on with frames of another (height, width): a cut, but with the kernels that are built already."""
        shape = check_shape(shape)
        with self._in_turn() as arrays:
            layout = layout_of(shape, self._tuning, self._settings)
            self._workplace = replace(self._workplace, layout=layout)
            self._shape, self._plan = shape, None
            arrays.drop_copies()
            self._cut()

    def close(self) -> None:
        """Give memory back; no call but this one works afterwards. Results still being computed are completed."""
        if not is_forked():  # what was the other process's goes with this one
            with self._lock:
                self._plan, self._arrays, self._events = None, None, ()

    def __enter__(self) -> Denoiser:
        return self

    def __repr__(self) -> str:
        device = self._workplace.queue.device
        place = f"{device.name} ({device.platform.name})"
        return f"<Denoiser of {extent(self._shape)} pixels, {self._settings.name}, on {place}>"

    def __reduce__(self) -> NoReturn:
        raise SvgfError("a Denoiser cannot be copied or sent to another process; make another one there")

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def events(self) -> tuple[tuple[str, cl.Event], ...]:
        """Label and event of every pass of the last frame, and of what is done to Arrays around them, in order."""
        return self._events

    def profile(self) -> dict[str, float]:
        """Milliseconds on the device of each of `events`, in order."""
        queue = self._workplace.queue
        with self._in_turn(), self._opencl_errors("profile", UNCHANGED):
            if not queue.properties & cl.command_queue_properties.PROFILING_ENABLE:
                raise SvgfError("profile(): the queue was made without PROFILING_ENABLE")
            queue.finish()
            return {name: 1e-6 * (event.profile.end - event.profile.start) for name, event in self._events}

    @property
    def stages(self) -> list[str]:
        """Names that `stage` understands; none before the first frame, nor from a cut or rebuild to the next one."""
        check_process()
        with self._lock:
            return list(self._plan.stages) if self._plan and self._events else []

    def stage(self, name: str) -> np.ndarray:
        """An intermediate result of the last frame, for debugging.

        Parameters
        ----------
        name : str
            One of `stages`, such as "inverse_count", "variance" or "level_2".

        Returns
        -------
        (H, W), (H, W, 3), or the same with a leading axis of signals; float32

        Raises
        ------
        SvgfError
            If there is no such stage, or its memory went to a later stage of the frame.
        """
        with self._in_turn(), self._opencl_errors("stage", UNCHANGED):
            return self._plan_with(name).read(name)

    def raw_stage(self, name: str) -> np.ndarray:
        """The whole buffer that holds a stage of the last frame, for debugging kernels.

        Parameters
        ----------
        name : str
            As for `stage`, with the same errors.

        Returns
        -------
        (n,) of the type of the stage's elements
            Plane after plane, rows with their padding, halo included.
        """
        with self._in_turn(), self._opencl_errors("raw_stage", UNCHANGED):
            return self._plan_with(name).raw(name)

    @property
    def nbytes(self) -> int:
        """Device memory held for planes, in bytes; 0 before the first frame or `warm_up`."""
        check_process()
        with self._lock:
            return self._plan.nbytes if self._plan else 0

    @contextmanager
    def _in_turn(self) -> Iterator[UserArrays]:
        """Around what touches the device: one thread at a time, in the process that made it, before it is closed."""
        check_process()
        with self._lock:
            if self._arrays is None:
                raise SvgfError("Denoiser: expected one that is open, got one after close() or the end of its 'with'")
            if self._is_running:
                raise SvgfError("Denoiser: expected no call from after_pass, for the frame is not complete; got one")
            yield self._arrays

    @contextmanager
    def _opencl_errors(self, what: str, then: str) -> Iterator[None]:
        with opencl_errors(self._workplace.queue.device, what, then):
            yield

    def _ready(self, inputs: Inputs, argument: str) -> Plan:
        """The plan for these inputs; a new one where they changed at a cut."""
        if self._plan and inputs == self._inputs:
            return self._plan
        if not self._is_cut:
            raise ArgumentError(argument, f"the fields {self._inputs} as before, or a call of reset", str(inputs))
        self._plan = None  # gives its memory back first
        if self._arrays:
            self._arrays.drop_copies()
        return Plan(self._settings.pipeline(inputs), self._workplace)

    def _rebuild(self, old: Plan, pipeline: Pipeline, *, same_filter: bool) -> None:
        """Make another plan, which takes over the past where it can; until its first frame there is nothing to show."""
        if self._is_cut:
            self._plan = None  # gives its memory back first
        plan = Plan(pipeline, self._workplace)
        if not (same_filter and not self._is_cut and plan.inherit(old)):
            self._cut()
        self._plan, self._events = plan, ()

    def _run(
        self,
        plan: Plan,
        arrays: UserArrays,
        exchange: Exchange,
        result: UserArray,
        events: list[cl.Event],
    ) -> None:
        """Run the passes; where they break off the past is forgotten, as half a frame is no history."""
        first = self._is_cut
        self._cut()
        queue = self._workplace.queue
        done: list[tuple[str, cl.Event]] = []
        with self._opencl_errors("denoise", BROKEN_OFF):
            with arrays.in_use(exchange, result):
                if events:
                    cl.enqueue_barrier(queue, wait_for=events)
                with acquired(queue, exchange.gl_objects, done):
                    done += arrays.copy(exchange.before)
                    done += self._passes(plan, exchange.buffers, first)
                    done += arrays.copy(exchange.after)
            if isinstance(result, cl_array.Array):
                result.add_event(done[-1][1])
                queue.flush()  # whoever waits for that event on another queue must not wait for ever
        self._is_cut, self._events = False, tuple(done)

    def _passes(self, plan: Plan, buffers: dict[str, cl.Buffer], first: bool) -> list[tuple[str, cl.Event]]:
        """Put a frame's passes on the queue."""
        self._is_running = True
        try:
            return plan.run(buffers, first=first, after_pass=self._after_pass)
        finally:
            self._is_running = False

    def _plan_with(self, stage: str) -> Plan:
        """The plan, if it has such a stage of a last frame."""
        known = self.stages
        if self._plan is None or not isinstance(stage, str) or stage not in known:
            raise SvgfError(f"stage: expected one of {', '.join(known) or 'none before a frame'}; got {shown(stage)}")
        return self._plan

    def _cut(self) -> None:
        self._is_cut, self._events = True, ()

    def _result(self, frame: Frame) -> Any:
        """A new array for the result, of the same kind as the frame's."""
        shape = frame.picture_shape
        if all(isinstance(value, cl_array.Array) for value in frame.present().values()):
            nbytes = 4 * math.prod(shape)
            return cl_array.Array(self._queue, shape, np.float32, data=allocate(self._workplace.queue, nbytes, nbytes))
        return np.empty(shape, np.float32)

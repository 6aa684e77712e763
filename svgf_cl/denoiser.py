"""`Denoiser`: denoises a sequence of frames. It checks its arguments, and runs a filter's plan for each frame."""

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
from svgf_cl.device.events import pending, times
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

# Advice after an error of the device.
NOT_BEGUN = "the frame was not started, so the history is unchanged; if this happens again, make a new Denoiser"
BROKEN_OFF = "the history is discarded, as by reset; if this happens again, make a new Denoiser"
UNCHANGED = "nothing was changed; if this happens again, make a new Denoiser"


class Denoiser:
    """Denoises a sequence of frames of one size, one frame for each call.

    Several threads may use one denoiser: each call waits until another thread's call has ended. Several denoisers do
    not affect each other. After a ``with`` block a denoiser is closed. It does not work after a fork: a forked process
    gets a `DeviceError`. So start processes with multiprocessing's "spawn", and make a denoiser in each.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels, each >= 1.
    settings : Filter, optional
        The filter and its parameters, such as `Kalman` (the default), `Settings` (SVGF) or `Eaw`.
    queue : pyopencl.CommandQueue, optional
        The queue to use, which must run commands in order; by default a new one on the fastest working device
        (`svgf_cl.device.devices.default_queue`).
    keep_stages : bool
        Copy every stage, so that `stage` can read all of them; by default later stages reuse the memory of some.
    tuning : Tuning, optional
        Settings for the speed of this device; by default the best ones that ``svgf-cl tune`` found, else those for
        most devices of its kind.
    after_pass : callable, optional
        A function that gets the label and the event of every pass as soon as the pass is on the queue, to watch or
        time single passes. If it raises an error, the frame is not completed. It must not call the denoiser.

    Raises
    ------
    SvgfError
        If `shape` is not the shape of an image, `queue` is dead or may run commands out of order, no OpenCL device
        works (`DeviceError`), or the device cannot use `tuning`.

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
        """The queue that the denoiser uses."""
        return self._queue

    @property
    def tuning(self) -> Tuning:
        """The settings for the speed of this device."""
        return self._tuning

    def denoise(self, frame: Frame, *, out: Any = None, wait_for: Sequence[cl.Event] = ()) -> Any:
        """Filter the next frame of the sequence.

        Parameters
        ----------
        frame : Frame
            Every field has this denoiser's shape. The set of fields must stay the same until `reset`.
        out : (H, W, 3) float32 C-contiguous ndarray or Array, optional
            The array for the result; (H, W, 4) if `color` has alpha. An Array may have strides and an offset.
        wait_for : sequence of pyopencl.Event
            Events that must complete before the frame's Arrays are read, in addition to the Arrays' own events.

        Returns
        -------
        (H, W, 3) float32, or (H, W, 4) if `color` has alpha
            Linear HDR radiance, and the alpha of `color` unchanged. It is `out` if given. Else it is an Array if every
            field is an Array, and `queue` may still be computing it. Else it is an ndarray.

        Raises
        ------
        FrameError
            If a field is missing, has another shape or type, belongs to another context, or is in memory that the
            device cannot use (SVM, OpenGL). The denoiser stays as before the call.
        ArgumentError
            If the set of fields has changed, `out` has another shape or type, `out` is an Array in the memory of a
            field, or an event failed. The denoiser stays as before the call.
        DeviceError
            If the device does not have enough memory, or cannot build a kernel: the denoiser stays as before the call.
            If an error occurs in the middle of the frame, the history is discarded, as by `reset`.
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
        """Build kernels and allocate memory for frames with these fields, so that the first frame is not slower.

        Raises
        ------
        SvgfError
            If `inputs` is no `Inputs`, or differs from the current sequence; `DeviceError` as in `denoise`.
        """
        check_inputs(inputs)
        with self._in_turn(), self._opencl_errors("warm_up", UNCHANGED):
            self._plan, self._inputs = self._ready(inputs, "warm_up(inputs)"), inputs
            self._workplace.queue.finish()

    def reset(self) -> None:
        """Discard the history, but keep kernels and memory: for a camera cut, or before frames with other fields."""
        with self._in_turn():
            self._cut()

    def update(self, settings: Filter) -> bool:
        """Continue with other settings, or with another filter.

        The history is kept, unless the filter changes or stores it in another way (half_guides, half_history); then the
        next frame has no history. If kernels or passes change, the old and the new memory exist for a moment at the
        same time.

        Returns
        -------
        bool
            Whether kernels were built or memory was allocated, which takes longer than a frame. Settings that only
            change numbers need neither.
        """
        check_filter(settings)
        with self._in_turn(), self._opencl_errors("update", UNCHANGED):
            layout_of(self._shape, self._tuning, settings)  # the new filter's buffers may be larger
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
        """Continue with frames of another (height, width), as after a cut, but with the kernels built so far."""
        shape = check_shape(shape)
        with self._in_turn() as arrays:
            layout = layout_of(shape, self._tuning, self._settings)
            self._workplace = replace(self._workplace, layout=layout)
            self._shape, self._plan = shape, None
            arrays.drop_copies()
            self._cut()

    def close(self) -> None:
        """Free the memory; afterwards only this call works. Results that are still being computed are completed."""
        if not is_forked():  # in a forked process the memory belongs to the other process
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
        """Label and event of every pass of the last frame, and of the copies of Arrays before and after, in order."""
        return self._events

    def profile(self) -> dict[str, float]:
        """Return the milliseconds on the device of each of `events`, in order."""
        with self._in_turn(), self._opencl_errors("profile", UNCHANGED):
            return dict(times(self._workplace.queue, self._events))

    @property
    def stages(self) -> list[str]:
        """Names for `stage`; empty before the first frame, and after a cut or rebuild until the next frame."""
        check_process()
        with self._lock:
            return list(self._plan.stages) if self._plan and self._events else []

    def stage(self, name: str) -> np.ndarray:
        """Return an intermediate result of the last frame, for debugging.

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
            If there is no such stage, or a later stage of the frame has overwritten it.
        """
        with self._in_turn(), self._opencl_errors("stage", UNCHANGED):
            return self._plan_with(name).read(name)

    def raw_stage(self, name: str) -> np.ndarray:
        """Return the whole buffer of a stage of the last frame, for debugging kernels.

        Parameters
        ----------
        name : str
            As for `stage`, with the same errors.

        Returns
        -------
        (n,) of the type of the stage's elements
            Plane after plane, with the padding of rows and the halo.
        """
        with self._in_turn(), self._opencl_errors("raw_stage", UNCHANGED):
            return self._plan_with(name).raw(name)

    @property
    def nbytes(self) -> int:
        """Device memory for planes, in bytes; 0 before the first frame or `warm_up`."""
        check_process()
        with self._lock:
            return self._plan.nbytes if self._plan else 0

    @contextmanager
    def _in_turn(self) -> Iterator[UserArrays]:
        """Use the device in a ``with`` block: one thread at a time, not after a fork, and not after `close`."""
        check_process()
        with self._lock:
            if self._arrays is None:
                raise SvgfError("Denoiser: expected one that is open, got one after close() or the end of its 'with'")
            if self._is_running:
                raise SvgfError(
                    "Denoiser: expected no call from after_pass, because the frame is not complete; got one"
                )
            yield self._arrays

    @contextmanager
    def _opencl_errors(self, what: str, then: str) -> Iterator[None]:
        with opencl_errors(self._workplace.queue.device, what, then):
            yield

    def _ready(self, inputs: Inputs, argument: str) -> Plan:
        """Return the plan for these inputs; a new one if they changed at a cut."""
        if self._plan and inputs == self._inputs:
            return self._plan
        if not self._is_cut:
            raise ArgumentError(argument, f"the fields {self._inputs} as before, or a call of reset", str(inputs))
        self._plan = None  # frees its memory first
        if self._arrays:
            self._arrays.drop_copies()
        return Plan(self._settings.pipeline(inputs), self._workplace)

    def _rebuild(self, old: Plan, pipeline: Pipeline, *, same_filter: bool) -> None:
        """Make another plan, which takes over the history if possible; it has no stages until its first frame."""
        if self._is_cut:
            self._plan = None  # frees its memory first
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
        """Run the passes; after an error the history is discarded, as half a frame is no history."""
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
                queue.flush()  # else another queue might wait for that event forever
        self._is_cut, self._events = False, tuple(done)

    def _passes(self, plan: Plan, buffers: dict[str, cl.Buffer], first: bool) -> list[tuple[str, cl.Event]]:
        """Put a frame's passes on the queue."""
        self._is_running = True
        try:
            return plan.run(buffers, first=first, after_pass=self._after_pass)
        finally:
            self._is_running = False

    def _plan_with(self, stage: str) -> Plan:
        """Return the plan if it has this stage of the last frame; else raise `SvgfError`."""
        known = self.stages
        if self._plan is None or not isinstance(stage, str) or stage not in known:
            raise SvgfError(f"stage: expected one of {', '.join(known) or 'none before a frame'}; got {shown(stage)}")
        return self._plan

    def _cut(self) -> None:
        self._is_cut, self._events = True, ()

    def _result(self, frame: Frame) -> Any:
        """Return a new array for the result, of the same kind as the frame's."""
        shape = frame.picture_shape
        if all(isinstance(value, cl_array.Array) for value in frame.present().values()):
            nbytes = 4 * math.prod(shape)
            return cl_array.Array(self._queue, shape, np.float32, data=allocate(self._workplace.queue, nbytes, nbytes))
        return np.empty(shape, np.float32)

"""`Plan`: kernels, memory and launches of a filter, built once for frames with one set of fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyopencl as cl

from svgf_cl.device import programs
from svgf_cl.device.arguments import AfterPass
from svgf_cl.device.buffers import Buffers
from svgf_cl.device.launch import Argument, Grid, Launch
from svgf_cl.device.layout import Layout
from svgf_cl.device.memory import TURNS
from svgf_cl.device.opencl_errors import allocate
from svgf_cl.device.tuning import Tuning
from svgf_cl.errors import SvgfError
from svgf_cl.filters.pipeline import Access, Buffer, Pipeline, Resource
from svgf_cl.filters.stages import Stage, stages
from svgf_cl.schedule import IN_PLACE, Schedule, ScheduledPass, whole_groups


@dataclass(frozen=True)
class Workplace:
    """The queue, layout and tuning with which the kernels of a plan run.

    Parameters
    ----------
    queue : pyopencl.CommandQueue
    layout : Layout
    tuning : Tuning
    keeps_stages : bool
        Whether every stage is copied, so that all can be read after a frame.
    """

    queue: cl.CommandQueue
    layout: Layout
    tuning: Tuning
    keeps_stages: bool = False


class Plan:
    """A pipeline that is ready to run.

    Parameters
    ----------
    pipeline : Pipeline
    workplace : Workplace

    Attributes
    ----------
    stages : dict of str to Stage
        The stages that can be read after a frame, by name.

    Raises
    ------
    DeviceError
        If the device does not have enough memory, or its compiler fails.
    """

    def __init__(self, pipeline: Pipeline, workplace: Workplace) -> None:
        schedule = Schedule(pipeline, workplace.layout, workplace.tuning)
        self.pipeline = pipeline
        self.stages: dict[str, Stage] = stages(pipeline)
        self._at = workplace
        self._buffers = Buffers(workplace.queue, schedule.memory, copies=workplace.keeps_stages)
        self._turns = self._launches(schedule)
        self._frame_number = 0
        self._without_past: list[Resource] = []  # lasting resources whose history is unknown in the next frame

    @property
    def nbytes(self) -> int:
        """Device memory for planes, in bytes."""
        return self._buffers.nbytes

    def run(
        self, user: Mapping[str, cl.Buffer], *, first: bool, after_pass: AfterPass | None
    ) -> list[tuple[str, cl.Event]]:
        """Put the passes of the next frame on the queue.

        Parameters
        ----------
        user : mapping of str to pyopencl.Buffer
            The user's arrays.
        first : bool
            Whether there is no history.
        after_pass : AfterPass, optional

        Returns
        -------
        list of (str, pyopencl.Event)
            Label and event of every pass.
        """
        self._buffers.begin_frame()
        self._buffers.forget(self.pipeline.lasting if first else self._without_past)
        self._without_past = []
        if first:
            self._frame_number = 0
        done = []
        numbers = {"frame_number": self._frame_number, **IN_PLACE}
        for each in self._turns[self._buffers.turn]:
            event = each.enqueue(self._at.queue, user, numbers)
            self._keep(each.entry.writes)
            if after_pass:
                after_pass(each.entry.label, event)
            done.append((each.entry.label, event))
        self._frame_number += 1
        return done

    def set_scalars(self, pipeline: Pipeline) -> None:
        """Use the numbers of a pipeline that differs only in its numbers."""
        for turn in self._turns:
            for each, entry in zip(turn, pipeline.passes, strict=True):
                each.set_scalars(entry)
        self.pipeline = pipeline

    def inherit(self, other: Plan) -> bool:
        """Take over the history of a plan for the same workplace; return False if it is stored in another way."""
        mine, others = self.pipeline.lasting, other.pipeline.lasting
        if any(resource not in others and not resource.tells_unknown for resource in mine):
            return False
        self._buffers.inherit(other._buffers, [resource for resource in mine if resource in others])
        self._without_past = [each for each in mine if each not in others or each in other._without_past]
        self._frame_number = other._frame_number
        return True

    def read(self, name: str) -> np.ndarray:
        """Return a stage of the last frame, ([signals,] H, W[, channels]) float32; errors as in `raw`."""
        stage = self.stages[name]
        planes = self._at.layout.every(stage.resource.spacing).crop(self.raw(name))
        return stage.image(planes)

    def raw(self, name: str) -> np.ndarray:
        """Return the whole buffer of a stage of the last frame, with the halo, in the stage's format.

        Raises
        ------
        SvgfError
            If a later stage has overwritten it.
        """
        stage = self.stages[name]
        buffer = Buffer(stage.resource)
        if not self._buffers.survives(buffer):
            raise SvgfError(f"stage: {name!r} was overwritten by a later pass; use Denoiser(..., keep_stages=True)")
        return self._buffers.read(buffer).view(stage.quantity.format.dtype)

    def _keep(self, writes: Sequence[Access]) -> None:
        for each in writes:
            if self._at.keeps_stages and isinstance(each.of, Buffer):
                self._buffers.copy_aside(each.of)

    def _launches(self, schedule: Schedule) -> list[tuple[Launch, ...]]:
        """Return the launches of each turn."""
        queue, found = self._at.queue, []
        compiled, constants = built(queue, schedule), uploaded(queue, schedule.pipeline)
        for _ in range(TURNS):
            self._buffers.begin_frame()
            bound = [fixed | self._own(each) for each, fixed in zip(schedule.passes, constants, strict=True)]
            found.append(tuple(launch(compiled, *each, self._at) for each in zip(schedule.passes, bound, strict=True)))
        return found

    def _own(self, scheduled: ScheduledPass) -> dict[str, cl.Buffer]:
        return {name: self._buffers[of] for name, of in scheduled.own.items()}


def uploaded(queue: cl.CommandQueue, pipeline: Pipeline) -> list[dict[str, cl.Buffer]]:
    """Copy the constant arrays of each pass to the device, and return their buffers by the kernel's names."""
    found: list[dict[str, cl.Buffer]] = []
    for entry in pipeline.passes:
        found.append({name: allocate(queue, values.nbytes, values.nbytes) for name, values in entry.arrays.items()})
        for name, buffer in found[-1].items():
            cl.enqueue_copy(queue, buffer, entry.arrays[name], is_blocking=True)
    return found


def built(queue: cl.CommandQueue, schedule: Schedule) -> dict[str, cl.Program]:
    """Build the source files of a schedule's passes."""
    sources = dict.fromkeys(scheduled.entry.source for scheduled in schedule.passes)
    return {source: programs.build(queue.context, queue.device, source, schedule.defines) for source in sources}


def launch(
    compiled: Mapping[str, cl.Program], scheduled: ScheduledPass, memory: Mapping[str, cl.Buffer], at: Workplace
) -> Launch:
    """Return the launch of a pass.

    Parameters
    ----------
    compiled : mapping of str to pyopencl.Program
        The source files of the schedule, as `built` returns them.
    scheduled : ScheduledPass
    memory : mapping of str to pyopencl.Buffer
        Its constant arrays and the denoiser's buffers, by the kernel's names.
    at : Workplace
    """
    entry = scheduled.entry
    kernel = cl.Kernel(compiled[entry.source], entry.kernel)
    fixed: dict[str, Argument] = {**scheduled.values, **memory}
    work_group = fitting(at.tuning.work_group, kernel, at.queue.device)
    return Launch(entry, kernel, fixed, whole_groups(scheduled.work_items, work_group), work_group)


def fitting(work_group: Grid, kernel: cl.Kernel, device: cl.Device) -> Grid:
    """Return a work-group that is small enough for a kernel on a device; many registers allow fewer work-items."""
    most = kernel.get_work_group_info(cl.kernel_work_group_info.WORK_GROUP_SIZE, device)
    along = min(work_group[0], most)
    return along, min(work_group[1], most // along)

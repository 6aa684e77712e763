"""`TilePlan`: runs the passes of a filter tile by tile, and keeps the history of the whole image on the host.

Each tile is a small image of its own on the device. What the next frame wants of it is copied to the host, and what the
previous frame left is copied from there to where the tile's motion leads. Both are the same bits as in a whole frame:
a pixel's arithmetic does not depend on where in the image, or in which image, it lies.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from svgf_cl.device.buffers import Buffers
from svgf_cl.device.host_planes import HostPlanes, Place
from svgf_cl.device.launch import Launch
from svgf_cl.device.memory import Memory
from svgf_cl.device.opencl_errors import allocate
from svgf_cl.device.past_windows import Motion, PastWindow, Reach, past_windows
from svgf_cl.device.tiles import Tile
from svgf_cl.device.tiling import Tiling
from svgf_cl.filters.margins import margins
from svgf_cl.filters.pipeline import Buffer, Resource, history_of
from svgf_cl.filters.stages import Stage, stages
from svgf_cl.plan import Workplace, launch, uploaded
from svgf_cl.schedule import Schedule

Events = list[tuple[str, cl.Event]]
UserBuffers = Mapping[str, cl.Buffer]
Bytes = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Step:
    """A pass.

    Parameters
    ----------
    launch : Launch
    past : sequence of Resource
        What it reads as the previous frame left it.
    margin : int
        Pixels around a tile whose motion it goes by.
    reach : Reach, optional
        How far around the place that motion leads to it reads.
    """

    launch: Launch
    past: Sequence[Resource] = ()
    margin: int = 0
    reach: Reach | None = None


class TilePlan:
    """A pipeline made ready to run in tiles.

    Parameters
    ----------
    tiling : Tiling
    workplace : Workplace
        Its layout is that of a window.

    Raises
    ------
    DeviceError
        If the device has no room, or its compiler refuses a kernel.
    """

    def __init__(self, tiling: Tiling, workplace: Workplace) -> None:
        pipeline, queue = tiling.pipeline, workplace.queue
        window = workplace.layout.height, workplace.layout.width
        self.pipeline = pipeline
        self.tiles = tiling.tiles(window)
        self._shape, self._past_shape = tiling.shape, tiling.past_window(window)
        self._at, self._queue = workplace, queue
        self._past_layout = tiling.layout(self._past_shape)
        self._buffers = Buffers(queue, Memory(workplace.layout, tiling.slots))
        self._past = Buffers(queue, Memory(self._past_layout, tiling.past_slots))
        self._motion: cl.Buffer | None = None
        self._steps = list(self._made_ready())
        self._before, self._now = (HostPlanes(tiling.past, tiling.shape) for _ in range(2))
        self._results = HostPlanes(tiling.results, tiling.shape)
        self._stages = {name: stage for name, stage in stages(pipeline).items() if self._kept(stage)}
        self._frame_number = 0
        self._copies: list[cl.Event] = []  # to and from the host's planes, which may be under way

    @property
    def stages(self) -> list[str]:
        """What can be read after a frame."""
        return list(self._stages)

    @property
    def host_nbytes(self) -> int:
        """Host memory held, in bytes."""
        return self._before.nbytes + self._now.nbytes + self._results.nbytes

    @property
    def nbytes(self) -> int:
        """Device memory held, in bytes; the user's arrays aside."""
        return self._buffers.nbytes + self._past.nbytes + (self._motion.size if self._motion else 0)

    def begin_frame(self, *, first: bool) -> None:
        """Before the tiles of a frame; `first` where nothing is known of the past."""
        self._wait()
        if first:
            self._frame_number = 0
            self._before.forget()

    def end_frame(self) -> None:
        """After the tiles of a frame: they are the past of the next. Without it that frame has left nothing."""
        self._wait()
        self._before, self._now = self._now, self._before
        self._frame_number += 1

    def run(self, tile: Tile, motion: Motion, user: UserBuffers) -> Events:
        """Run the passes on a tile of the current frame.

        Parameters
        ----------
        tile : Tile
        motion : (h, w, 2 or 3) float32
            Of the window.
        user : mapping of str to pyopencl.Buffer
            The user's arrays, of the window.
        """
        done: Events = []
        for step in self._steps:
            windows = self._windows(step, tile, motion)
            if len(windows) > 1:
                done += self._run_in_parts(step, tile, motion, user, windows)
            else:
                done.append(self._run_at_once(step, tile, user, windows[0]))
        self._download(tile)
        return done

    def stage(self, name: str) -> NDArray[np.float32]:
        """One of `stages` of the last frame, as `Denoiser.stage` gives it."""
        stage = self._stages[name]
        return stage.decoded(self._kept(stage)[0].of(stage.resource, stage.quantity))

    def _kept(self, stage: Stage) -> list[HostPlanes]:
        """What holds a stage of the last frame, which is the past of the next, if anything does."""
        return [each for each in (self._before, self._results) if each.holds(stage.resource, stage.quantity)]

    def _made_ready(self) -> Iterator[Step]:
        pipeline, at = self.pipeline, self._at
        schedule = Schedule(pipeline, at.layout, at.tuning, self._past_layout)
        constants = uploaded(self._queue, pipeline)
        for scheduled, fixed, margin in zip(schedule.passes, constants, margins(pipeline), strict=True):
            past = pipeline.past_of(scheduled.entry)
            arguments = {each.argument for each in past}
            own = {name: (self._past if name in arguments else self._buffers)[of] for name, of in scheduled.own.items()}
            ready = launch(schedule, scheduled, fixed | own, at)
            if past:
                reach = Reach.of(scheduled.entry)
                yield Step(ready, [each.resource for each in past], margin + reach.beside, reach)
            else:
                yield Step(ready)

    def _windows(self, step: Step, tile: Tile, motion: Motion) -> list[PastWindow]:
        """Where this pass has to look for the past of a tile."""
        if step.reach is None or not self._frame_number:  # a past of which nothing is known is the same everywhere
            return [PastWindow((0, 0), (0, 0), self._past_shape)]
        rows, columns = tile.around(step.margin)
        first = tile.rows.origin + rows.start, tile.columns.origin + columns.start
        return past_windows(motion[rows, columns], first, self._shape, self._past_shape, step.reach)

    def _run_at_once(self, step: Step, tile: Tile, user: UserBuffers, window: PastWindow) -> tuple[str, cl.Event]:
        """Run a pass that needs one window on the past at the most."""
        self._upload(step, window)
        return self._enqueue(step, user, offset(tile, window))

    def _upload(self, step: Step, window: PastWindow) -> None:
        corner = window.corner[0] - window.origin[0], window.corner[1] - window.origin[1]
        for resource in step.past:
            place = Place(self._past[history_of(resource)], self._past_layout, corner)
            self._copies += self._before.upload(self._queue, resource, place, window.corner, window.size)

    def _enqueue(self, step: Step, user: UserBuffers, past: tuple[int, int]) -> tuple[str, cl.Event]:
        numbers = {"frame_number": self._frame_number, "past_y": past[0], "past_x": past[1]}
        return step.launch.entry.label, step.launch.enqueue(self._queue, user, numbers)

    def _run_in_parts(
        self, step: Step, tile: Tile, motion: Motion, user: UserBuffers, windows: Sequence[PastWindow]
    ) -> Events:
        """Run a pass once for every window on the past, and put its results together.

        Each run has the motion of those pixels alone that it leads into this window; that of others is unknown. So a
        pixel comes out as if nothing were known of its past in all runs but one at the most. A first run without any
        motion tells what that is, and a byte that is another in any run is right there.
        """
        written = [self._memory(each.of, user) for each in step.launch.entry.writes]
        before = [self._read(memory) for memory in written]  # of which the pass may read some
        done: Events = []
        base: list[Bytes] = []
        merged: list[Bytes] = []
        nowhere = PastWindow((0, 0), (0, 0), (1, 1), np.zeros((1, 1), bool))
        for window in (nowhere, *windows):
            for memory, values in zip(written, before, strict=True):
                cl.enqueue_copy(self._queue, memory, values)
            self._upload(step, window)
            led = {**user, "motion": self._motion_into(window, step, tile, motion)}
            done.append(self._enqueue(step, led, offset(tile, window)))
            found = [self._read(memory) for memory in written]
            base = base or found
            merged = [
                np.where(new != old, new, kept) for new, old, kept in zip(found, base, merged or found, strict=True)
            ]
        for memory, values in zip(written, merged, strict=True):
            cl.enqueue_copy(self._queue, memory, values)
        return done

    def _motion_into(self, window: PastWindow, step: Step, tile: Tile, motion: Motion) -> cl.Buffer:
        """The motion of a window's readers, and NaN for all others."""
        led = np.full_like(motion, np.nan)
        around = tile.around(step.margin)
        if window.readers is not None:
            led[around] = np.where(window.readers[..., None], motion[around], np.nan)
        self._motion = self._motion or allocate(self._queue, led.nbytes, led.nbytes)
        cl.enqueue_copy(self._queue, self._motion, led)
        return self._motion

    def _memory(self, of: Buffer | str, user: UserBuffers) -> cl.Buffer:
        return user[of] if isinstance(of, str) else self._buffers[of]

    def _read(self, memory: cl.Buffer) -> Bytes:
        values = np.empty(memory.size, np.uint8)
        cl.enqueue_copy(self._queue, values, memory)
        return values

    def _download(self, tile: Tile) -> None:
        """Copy the history and the visible stages of a tile to the host."""
        rows, columns = tile.around()
        size = rows.stop - rows.start, columns.stop - columns.start
        for planes in (self._now, self._results):
            for resource in planes.resources:
                place = Place(self._buffers[Buffer(resource)], self._at.layout, (rows.start, columns.start))
                corner = tile.rows.begin, tile.columns.begin
                self._copies += planes.download(self._queue, resource, place, corner, size)

    def _wait(self) -> None:
        """Have the host's planes be the host's again."""
        if self._copies:
            cl.wait_for_events(self._copies)
        self._copies = []


def offset(tile: Tile, window: PastWindow) -> tuple[int, int]:
    """Rows and columns from a pixel's place in a tile to its place in a window on the past."""
    return tile.rows.origin - window.origin[0], tile.columns.origin - window.origin[1]

"""`TilePlan`: runs the passes of a filter tile by tile, and keeps the history of the whole image on the host.

Each tile is a separate small image on the device. The values that the next frame needs are copied to the host, and the
values of the previous frame are copied from there for the place to which the tile's motion leads. All values are the
same bits as in a whole frame, because a pixel's arithmetic does not depend on its place in the image.
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
from svgf_cl.plan import Workplace, built, launch, uploaded
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
        The resources of the previous frame that it reads.
    margin : int
        The pass uses the motion of this many pixels around a tile.
    reach : Reach, optional
        How far it reads around the place to which motion leads.
    """

    launch: Launch
    past: Sequence[Resource] = ()
    margin: int = 0
    reach: Reach | None = None


class TilePlan:
    """A pipeline that is ready to run in tiles.

    Parameters
    ----------
    tiling : Tiling
    workplace : Workplace
        Its layout is that of a window.

    Raises
    ------
    DeviceError
        If the device does not have enough memory, or its compiler fails.
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
        self._copies: list[cl.Event] = []  # copies to and from the host's planes that may not have ended

    @property
    def stages(self) -> list[str]:
        """Names of the stages that can be read after a frame."""
        return list(self._stages)

    @property
    def host_nbytes(self) -> int:
        """Host memory in use, in bytes."""
        return self._before.nbytes + self._now.nbytes + self._results.nbytes

    @property
    def nbytes(self) -> int:
        """Device memory in bytes, without the user's arrays."""
        return self._buffers.nbytes + self._past.nbytes + (self._motion.size if self._motion else 0)

    def begin_frame(self, *, first: bool) -> None:
        """Prepare for the tiles of a frame; `first` means that there is no history."""
        self._wait()
        if first:
            self._frame_number = 0
            self._before.forget()

    def end_frame(self) -> None:
        """Make the frame the history of the next one. Without this call the frame has no effect."""
        self._wait()
        self._before, self._now = self._now, self._before
        self._frame_number += 1

    def run(self, tile: Tile, motion: Motion, user: UserBuffers) -> Events:
        """Run the passes on a tile of the current frame.

        Parameters
        ----------
        tile : Tile
        motion : (h, w, 2 or 3) float32
            The motion in the window.
        user : mapping of str to pyopencl.Buffer
            The user's arrays in the window.
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
        """Return one of `stages` of the last frame, as `Denoiser.stage` does."""
        stage = self._stages[name]
        return stage.decoded(self._kept(stage)[0].of(stage.resource, stage.quantity))

    def _kept(self, stage: Stage) -> list[HostPlanes]:
        """Return the planes that contain a stage of the last frame, if any do."""
        return [each for each in (self._before, self._results) if each.holds(stage.resource, stage.quantity)]

    def _made_ready(self) -> Iterator[Step]:
        pipeline, at = self.pipeline, self._at
        schedule = Schedule(pipeline, at.layout, at.tuning, self._past_layout)
        compiled, constants = built(self._queue, schedule), uploaded(self._queue, pipeline)
        for scheduled, fixed, margin in zip(schedule.passes, constants, margins(pipeline), strict=True):
            past = pipeline.past_of(scheduled.entry)
            arguments = {each.argument for each in past}
            own = {name: (self._past if name in arguments else self._buffers)[of] for name, of in scheduled.own.items()}
            ready = launch(compiled, scheduled, fixed | own, at)
            if past:
                reach = Reach.of(scheduled.entry)
                yield Step(ready, [each.resource for each in past], margin + reach.beside, reach)
            else:
                yield Step(ready)

    def _windows(self, step: Step, tile: Tile, motion: Motion) -> list[PastWindow]:
        """Return the windows on the previous frame that this pass reads for a tile."""
        if step.reach is None or not self._frame_number:  # unknown history is the same everywhere
            return [PastWindow((0, 0), (0, 0), self._past_shape)]
        rows, columns = tile.around(step.margin)
        first = tile.rows.origin + rows.start, tile.columns.origin + columns.start
        return past_windows(motion[rows, columns], first, self._shape, self._past_shape, step.reach)

    def _run_at_once(self, step: Step, tile: Tile, user: UserBuffers, window: PastWindow) -> tuple[str, cl.Event]:
        """Run a pass that needs at most one window on the previous frame."""
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
        """Run a pass once for every window on the previous frame, and merge the results.

        In each run, only the pixels whose motion leads into the window have motion; for all others it is unknown. So in
        all runs except at most one, a pixel gets the result of unknown history. A first run without any motion gives
        this result for comparison: a byte that differs from it in one run is the right one.
        """
        written = [self._memory(each.of, user) for each in step.launch.entry.writes]
        before = [self._read(memory) for memory in written]  # the pass may also read them
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
        """Return the motion of a window's readers, and NaN for all other pixels."""
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
        """Copy the values of a tile that are kept for the next frame, or only shown, to the host."""
        rows, columns = tile.around()
        size = rows.stop - rows.start, columns.stop - columns.start
        for planes in (self._now, self._results):
            for resource in planes.resources:
                place = Place(self._buffers[Buffer(resource)], self._at.layout, (rows.start, columns.start))
                corner = tile.rows.begin, tile.columns.begin
                self._copies += planes.download(self._queue, resource, place, corner, size)

    def _wait(self) -> None:
        """Wait until all copies to and from the host's planes have ended."""
        if self._copies:
            cl.wait_for_events(self._copies)
        self._copies = []


def offset(tile: Tile, window: PastWindow) -> tuple[int, int]:
    """Return the rows and columns from a pixel's place in a tile to its place in a window on the previous frame."""
    return tile.rows.origin - window.origin[0], tile.columns.origin - window.origin[1]

"""`TiledDenoiser`: denoises frames that are too large for the device's memory. `denoiser_for` chooses a denoiser."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pyopencl as cl

from svgf_cl.denoiser import Denoiser
from svgf_cl.device.arguments import check_filter, check_inputs, check_queue, check_shape, check_tuning, held
from svgf_cl.device.array_checks import check_out
from svgf_cl.device.events import times
from svgf_cl.device.opencl_errors import mebibytes, opencl_errors
from svgf_cl.device.process import check_process
from svgf_cl.device.tiles import Tile
from svgf_cl.device.tiling import Tiling
from svgf_cl.device.tuning import Tuning, best_tuning
from svgf_cl.device.user_arrays import UserArrays, as_read
from svgf_cl.errors import ArgumentError, DeviceError, FrameError, SvgfError, shown
from svgf_cl.filters import DEFAULT
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import ALPHA, Frame, Shape, extent
from svgf_cl.plan import Workplace
from svgf_cl.tile_plan import Events, TilePlan

MOST_OF_MEMORY = 0.9  # of a device's memory: the driver and the screen need some of it
NOT_BEGUN = (
    "the history is kept, so the same frame may be given again; if this happens again, make a new one with a smaller "
    "max_bytes"
)


class TiledDenoiser:
    """Denoises frames that are too large for the device's memory, with the same result as `Denoiser`, bit by bit.

    It works on one tile of the frame after another. The history of the whole frame is in host memory; the part that a
    tile needs is copied to the device and back. So it takes more time, and host memory: see docs/conventions.md.
    Threads, processes and ``with`` blocks are treated as by `Denoiser`.

    Parameters
    ----------
    shape, settings, queue, tuning
        As for `Denoiser`.
    inputs : Inputs
        The fields of all frames.
    max_bytes : int, optional
        Most device memory to use; by default nine tenths of the device's memory.

    Raises
    ------
    SvgfError
        If an argument is wrong.
    DeviceError
        If not even the smallest tiles fit, or as in `Denoiser`.
    """

    def __init__(
        self,
        shape: Shape,
        inputs: Inputs,
        *,
        settings: Filter | None = None,
        queue: cl.CommandQueue | None = None,
        tuning: Tuning | None = None,
        max_bytes: int | None = None,
    ) -> None:
        self._shape, self._inputs = check_shape(shape), check_inputs(inputs)
        self._settings = DEFAULT() if settings is None else check_filter(settings)
        self._queue = check_queue(queue)
        device = self._queue.device
        tuning = check_tuning(tuning, device)
        tiling = Tiling(self._settings.pipeline(inputs), self._shape, tuning.row_alignment)
        limit = check_max_bytes(max_bytes, device)
        window = window_for(tiling, device, limit)
        self._arrays: UserArrays | None = UserArrays(held(self._queue), pinned=tuning.pinned_copies)
        with opencl_errors(device, "TiledDenoiser", "make one with a smaller max_bytes"):
            at = Workplace(held(self._queue), tiling.layout(window), tuning)
            self._plan: TilePlan | None = TilePlan(tiling, at)
        self._reason = (
            f"{extent(self._shape)} frames need {mebibytes(sum(tiling.whole()))} at once, {device.name} has "
            f"{mebibytes(limit)} for them: working in {len(self._plan.tiles)} tiles of {extent(window)}"
        )
        self._picture = np.empty((*window, 3), np.float32)
        self._is_cut = True
        self._events: Events = []
        self._lock = threading.RLock()

    @property
    def shape(self) -> Shape:
        """(height, width) of every frame."""
        return self._shape

    @property
    def settings(self) -> Filter:
        """The filter and its parameters."""
        return self._settings

    @property
    def queue(self) -> cl.CommandQueue:
        """The queue that the denoiser uses."""
        return self._queue

    @property
    def reason(self) -> str:
        """One line that says why it works in tiles, and how many there are."""
        return self._reason

    @property
    def tiles(self) -> int:
        """Number of tiles of a frame."""
        with self._in_turn() as (plan, _):
            return len(plan.tiles)

    @property
    def nbytes(self) -> int:
        """Device memory in bytes, without the frame's arrays."""
        with self._in_turn() as (plan, _):
            return plan.nbytes

    @property
    def host_nbytes(self) -> int:
        """Host memory for the history, in bytes."""
        with self._in_turn() as (plan, _):
            return plan.host_nbytes

    def denoise(self, frame: Frame, *, out: np.ndarray | None = None) -> np.ndarray:
        """Filter the next frame of the sequence.

        Parameters
        ----------
        frame : Frame
            Every field is a numpy array of this denoiser's shape; the fields are those of its `inputs`.
        out : (H, W, 3) float32 C-contiguous ndarray, optional
            The array for the result; (H, W, 4) if `color` has alpha. It must not share memory with a field.

        Returns
        -------
        (H, W, 3) float32, or (H, W, 4) if `color` has alpha
            Linear HDR radiance; `out` if given.

        Raises
        ------
        FrameError, ArgumentError, DeviceError
            As in `Denoiser.denoise`. The history is always kept.
        """
        if not isinstance(frame, Frame):
            raise SvgfError(f"denoise(frame): expected a Frame, got {type(frame).__name__}")
        with self._in_turn() as (plan, arrays):
            self._check(frame, out)
            result = np.empty(frame.picture_shape, np.float32) if out is None else out
            if frame.has_alpha:
                result[..., 3] = frame.layer(ALPHA)
            self._events, events = [], []
            with opencl_errors(self._queue.device, "denoise", NOT_BEGUN):
                plan.begin_frame(first=self._is_cut)
                for tile in plan.tiles:
                    fields = {name: part_of(frame, name, tile) for name in plan.pipeline.fields}
                    exchange = arrays.exchange(fields, self._picture)
                    with arrays.in_use(exchange, self._picture):
                        events += plan.run(tile, fields["motion"], exchange.buffers)
                    result[tile.kept][..., :3] = self._picture[tile.around()]
                plan.end_frame()
            self._is_cut, self._events = False, events
        return result

    def reset(self) -> None:
        """Discard the history, but keep kernels and memory: for a camera cut."""
        with self._in_turn():
            self._is_cut, self._events = True, []

    def close(self) -> None:
        """Free the memory; afterwards only this call works."""
        with self._lock:
            self._plan, self._arrays, self._events = None, None, []

    def __enter__(self) -> TiledDenoiser:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        device = self._queue.device
        place = f"{device.name} ({device.platform.name})"
        return f"<TiledDenoiser of {extent(self._shape)} pixels, {self._settings.name}, on {place}>"

    def profile(self) -> dict[str, float]:
        """Return the milliseconds on the device of each pass of the last frame, summed over all tiles, in order."""
        with self._in_turn():
            total: dict[str, float] = {}
            for name, time in times(self._queue, self._events):
                total[name] = total.get(name, 0.0) + time
            return total

    @property
    def stages(self) -> list[str]:
        """Names for `stage`: those kept for the next frame, or only shown; empty before the first frame."""
        with self._in_turn() as (plan, _):
            return plan.stages if self._events else []

    def stage(self, name: str) -> np.ndarray:
        """Return one of `stages` of the last frame, as `Denoiser.stage` does."""
        with self._in_turn() as (plan, _):
            known = self.stages
            if not isinstance(name, str) or name not in known:
                raise SvgfError(
                    f"stage: expected one of {', '.join(known) or 'none'} in tiles; got {shown(name)}; use a Denoiser"
                )
            return plan.stage(name)

    @contextmanager
    def _in_turn(self) -> Iterator[tuple[TilePlan, UserArrays]]:
        """Use the device in a ``with`` block: one thread at a time, not after a fork, and not after `close`."""
        check_process()
        with self._lock:
            if self._plan is None or self._arrays is None:
                raise SvgfError("TiledDenoiser: expected one that is open, got one after close()")
            yield self._plan, self._arrays

    def _check(self, frame: Frame, out: np.ndarray | None) -> None:
        frame.check(self._shape)
        given = frame.present()
        for name, value in given.items():
            if not isinstance(value, np.ndarray):
                raise FrameError(name, "a numpy.ndarray, because frames in tiles are in host memory", "a device array")
        inputs = Inputs.of(frame)
        if inputs != self._inputs:
            raise ArgumentError("denoise(frame)", f"the fields {self._inputs}", str(inputs))
        if out is None:
            return
        check_out(out, frame.picture_shape)
        if not isinstance(out, np.ndarray):
            raise ArgumentError(
                "denoise(out)", "a numpy.ndarray, because frames in tiles are in host memory", "a device array"
            )
        for name, value in given.items():
            if np.may_share_memory(out, value):
                raise ArgumentError("denoise(out)", "memory of its own", f"that of {name}")


def part_of(frame: Frame, name: str, tile: Tile) -> np.ndarray:
    """Return the part of a frame's field in a tile's window, as kernels read it."""
    part = as_read(name, frame.layer(name)[tile.window])
    assert isinstance(part, np.ndarray)
    return part


def denoiser_for(
    shape: Shape,
    inputs: Inputs,
    *,
    settings: Filter | None = None,
    queue: cl.CommandQueue | None = None,
    max_bytes: int | None = None,
) -> Denoiser | TiledDenoiser:
    """Return a denoiser for frames of this shape; it works in tiles if whole frames do not fit on the device.

    Both kinds give the same pictures. The parameters are those of `TiledDenoiser`.
    """
    queue, filter_ = check_queue(queue), DEFAULT() if settings is None else check_filter(settings)
    alignment = best_tuning(queue.device).row_alignment
    tiling = Tiling(filter_.pipeline(check_inputs(inputs)), check_shape(shape), alignment)
    limit = check_max_bytes(max_bytes, queue.device)
    sizes = tiling.whole()
    if sum(sizes) <= limit and max(sizes) <= queue.device.max_mem_alloc_size and tiling.indexable(tiling.shape):
        return Denoiser(shape, settings=filter_, queue=queue)
    return TiledDenoiser(shape, inputs, settings=filter_, queue=queue, max_bytes=limit)


def check_max_bytes(max_bytes: int | None, device: cl.Device) -> int:
    """Return the number of bytes, or for None most of the device's memory; raise `SvgfError` for any other value."""
    if max_bytes is None:
        return int(MOST_OF_MEMORY * device.global_mem_size)
    if not isinstance(max_bytes, int) or isinstance(max_bytes, bool) or max_bytes < 1:
        raise SvgfError(f"max_bytes: expected a whole number of bytes, at least 1, got {shown(max_bytes)}")
    return max_bytes


def window_for(tiling: Tiling, device: cl.Device, limit: int) -> Shape:
    """Return the shape of the windows; raise `DeviceError` if no window fits on the device."""
    window = tiling.window(limit, device.max_mem_alloc_size)
    if window is None:
        raise DeviceError(
            f"{device.name} has no room for tiles of {extent(tiling.shape)} frames: expected at least "
            f"{mebibytes(tiling.least())}, got {mebibytes(limit)}, of which {mebibytes(device.max_mem_alloc_size)} for "
            "one buffer. Free some, or take smaller frames"
        )
    return window

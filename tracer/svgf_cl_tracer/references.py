"""References: the noise-free pictures of a shot, rendered until their error is small enough.

A reference is rendered in chunks of `CHUNK` samples per pixel, always the same chunks in the same order. After each
chunk it is stored in the user's cache folder. So rendering can be interrupted at any time and continued, also by
another process. The same request always gives the same bits, no matter what was stored and who traced the chunks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import count
from math import ceil, inf
from pathlib import Path

from svgf_cl.frame import Frame
from svgf_cl.io import cache
from svgf_cl.io.exr import write_channels
from svgf_cl.io.frames import channels_of
from svgf_cl.scheduling import Map, here

from .checkpoints import Checkpoints
from .errors import SceneError
from .estimate import Estimate
from .fingerprint import fingerprint, tracer_version
from .paths import Radiance
from .render import REFERENCE, Sampler, in_threads, render_frame, tiles
from .shading import sum_up
from .shot import Shot
from .vectors import Float32

# Samples per pixel between two checkpoints: the most that an interruption loses, and the size of a cluster's task.
CHUNK = 16


@dataclass(frozen=True)
class Goal:
    """When a reference is good enough.

    Parameters
    ----------
    spp : int
        Least number of samples per pixel, >= 1; it is rounded up to whole chunks of `CHUNK`.
    until_error : float
        Largest estimated relative error (`Estimate.error`), > 0.

    Raises
    ------
    SceneError
        If a number is out of its range.
    """

    # With fewer samples, all of them may have missed the main source of noise, and the estimated error would be too
    # small.
    spp: int = 64
    until_error: float = inf

    def __post_init__(self) -> None:
        if self.spp < 1:
            raise SceneError(f"reference: expected at least 1 sample per pixel, got {self.spp}")
        if not self.until_error > 0.0:
            raise SceneError(f"reference: expected an error above 0 to stop at, got {self.until_error}")

    def reached(self, spp: int, error: float) -> bool:
        """Whether this number of samples per pixel with this error is good enough."""
        return spp >= self.spp and error <= self.until_error

    def overshot(self, estimate: Estimate) -> bool:
        """Whether an earlier step of the estimate had reached the goal already."""
        steps = zip(estimate.history[:-1], estimate.errors[:-1], strict=True)
        return any(self.reached(step.spp, error) for step, error in steps)

    def share(self, estimate: Estimate) -> float:
        """How much of the work is done, 0..1; the error falls with the root of the number of samples."""
        share = estimate.spp / self.spp
        if estimate.error > self.until_error:
            share = min(share, (self.until_error / estimate.error) ** 2)
        return min(1.0, share)


@dataclass(frozen=True, eq=False)
class References:
    """The noise-free pictures of the frames of a shot.

    Parameters
    ----------
    shot : Shot
    seed, bounces : int
        As in `render_frame`. They share no noise with frames of the same seed.
    jitter : bool
        True: the mean over each pixel's square. False: the radiance at each pixel's centre, to which frames without
        jitter converge.
    rows : (int, int), optional
        The first row to render and the one after the last; by default all rows.

    Raises
    ------
    SceneError
        If a number is out of its range.
    """

    shot: Shot
    seed: int = 0
    jitter: bool = True
    bounces: int = 1
    rows: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        first, end = self._rows
        if not 0 <= first < end <= self.shot.shape[0]:
            raise SceneError(f"rows: expected 0 <= first < end <= {self.shot.shape[0]}, got {self.rows}")
        if min(self.seed, self.bounces) < 0:
            raise SceneError(f"reference: expected seed and bounces of at least 0, got {self.seed} and {self.bounces}")

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width) of the rendered part."""
        first, end = self._rows
        return end - first, self.shot.shape[1]

    @cached_property
    def folder(self) -> Path:
        """The folder where they are stored; it depends on everything that affects them, including the tracer."""
        settings = (self.seed, self.jitter, self.bounces, self._rows, CHUNK)
        return cache.cache_folder() / "references" / fingerprint([self.shot.identity, settings])[:32]

    def refine(self, number: int, goal: Goal, run: Map = here) -> Iterator[Estimate]:
        """Yield the stored estimate of frame `number`, if there is one, and the estimate after each further chunk.

        It ends with the first estimate that reaches the goal. A stored estimate beyond the goal is not used, so the
        result depends on the goal alone.
        """
        checkpoints = Checkpoints(self.folder, number)
        start = Estimate.nothing(self.shape[0] * self.shape[1])
        estimate = checkpoints.latest(start, lambda kept: not goal.overshot(kept))
        if estimate is not start:
            yield estimate
        if goal.reached(estimate.spp, estimate.error):
            return
        first = estimate.spp // CHUNK
        indices = range(first, chunks(goal.spp)) if goal.until_error == inf else count(first)
        task = partial(
            trace_chunk, number=number, seed=self.seed, jitter=self.jitter, bounces=self.bounces, rows=self._rows
        )
        for part in run(task, self.shot, indices):
            estimate, before = estimate.merged(part), estimate
            checkpoints.replace(before, estimate)
            yield estimate
            if goal.reached(estimate.spp, estimate.error):
                return

    def render(self, number: int, spp: int, advance: Callable[[], None] = lambda: None) -> Estimate:
        """The estimate of frame `number` from `spp` samples per pixel, rounded up to whole chunks.

        `advance` is called `chunks` times: for each chunk, including stored ones.
        """
        done = 0
        for estimate in self.refine(number, Goal(spp)):
            for _ in range(done, estimate.spp // CHUNK):
                advance()
            done = estimate.spp // CHUNK
        return estimate

    def picture(self, estimate: Estimate) -> Float32:
        """The colour of an estimate as an image (H, W, 3), where H is the number of rendered rows."""
        return estimate.color.reshape(*self.shape, 3)

    def write(self, path: Path, number: int, estimate: Estimate) -> None:
        """Write an estimate of frame `number` as an EXR file, completely or not at all.

        It has the channels of a frame, with the G-buffer of the pixel centres. It also has the standard error of the
        colour, ``error.R`` and so on, and attributes that say how it was made.

        Raises
        ------
        FileError
            If the file cannot be written.
        """
        first, end = self._rows
        features = render_frame(self.shot, number, jitter=False, bounces=0).present()
        del features["hit_distance"]  # it is that of a single sample and does not converge
        fields = {name: values[first:end] for name, values in features.items()}
        radiance = Radiance.empty(len(estimate.light))
        sum_up(estimate.light, 1, radiance)
        light = radiance._asdict() | {"color": estimate.color}
        fields |= {name: values.reshape(*self.shape, 3) for name, values in light.items()}
        error = estimate.standard_error.reshape(*self.shape, 3)
        planes = channels_of(path, Frame(**fields)) | {f"error.{c}": error[..., i] for i, c in enumerate("RGB")}
        attributes: dict[str, int | float | str] = {
            "svgf_cl:spp": estimate.spp,
            "svgf_cl:error": estimate.error,
            "svgf_cl:seed": self.seed,
            "svgf_cl:tracer": tracer_version(),
        }
        write_channels(path, planes, attributes)

    @property
    def _rows(self) -> tuple[int, int]:
        return self.rows or (0, self.shot.shape[0])


def chunks(spp: int) -> int:
    """The number of chunks for `spp` samples per pixel."""
    return ceil(spp / CHUNK)


def trace_chunk(
    shot: Shot, index: int, *, number: int, seed: int, jitter: bool, bounces: int, rows: tuple[int, int]
) -> Estimate:
    """The estimate from chunk `index` of the samples of frame `number`, for the pixels of `rows`."""
    sampler = Sampler(shot, number, stream=REFERENCE, seed=seed, jitter=jitter, bounces=bounces)
    first, end = (row * shot.shape[1] for row in rows)

    def gather(tile: slice) -> Estimate:
        pixels = slice(first + tile.start, first + tile.stop)
        return Estimate.of(sampler.trace(pixels, CHUNK * index + sample) for sample in range(CHUNK))

    return Estimate.beside(in_threads(gather, tiles(end - first)))

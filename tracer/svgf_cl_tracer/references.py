"""References: what the noisy frames of a shot converge to, rendered until they are known well enough.

A reference grows by chunks of `CHUNK` samples per pixel, always the same ones in the same order, and after each it is
kept in the user's cache folder. So it can be broken off at any time and gone on with, by another process too; and the
same request has the same result, bit by bit, whatever was kept and whoever traced the chunks.
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

# Samples per pixel between two checkpoints: what a kill costs at most, and what one task of a cluster sends back.
CHUNK = 16


@dataclass(frozen=True)
class Goal:
    """When a reference is good enough.

    Parameters
    ----------
    spp : int
        Samples per pixel at least, >= 1; there are always whole chunks of `CHUNK` of them.
    until_error : float
        Estimated relative error (`Estimate.error`) at most, > 0.

    Raises
    ------
    SceneError
        A number is out of its range.
    """

    # Fewer samples may all have missed what makes most of the noise, and would then call themselves good.
    spp: int = 64
    until_error: float = inf

    def __post_init__(self) -> None:
        if self.spp < 1:
            raise SceneError(f"reference: expected at least 1 sample per pixel, got {self.spp}")
        if not self.until_error > 0.0:
            raise SceneError(f"reference: expected an error above 0 to stop at, got {self.until_error}")

    def reached(self, spp: int, error: float) -> bool:
        """Whether it is met by so many samples per pixel with that error."""
        return spp >= self.spp and error <= self.until_error

    def overshot(self, estimate: Estimate) -> bool:
        """Whether what the estimate grew out of had reached it already."""
        steps = zip(estimate.history[:-1], estimate.errors[:-1], strict=True)
        return any(self.reached(step.spp, error) for step, error in steps)

    def share(self, estimate: Estimate) -> float:
        """How much of the work is done, 0..1: the error falls with the root of the number of samples."""
        share = estimate.spp / self.spp
        if estimate.error > self.until_error:
            share = min(share, (self.until_error / estimate.error) ** 2)
        return min(1.0, share)


@dataclass(frozen=True, eq=False)
class References:
    """What the frames of a shot converge to.

    Parameters
    ----------
    shot : Shot
    seed, bounces : int
        As in `render_frame`. No noise is shared with a frame of the same seed.
    jitter : bool
        True: the mean over each pixel's square. False: what frames without jitter converge to, the radiance at its
        centre.
    rows : (int, int), optional
        First row and the one after the last, of those to render; all by default.

    Raises
    ------
    SceneError
        A number is out of its range.
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
        """(height, width) of what is rendered."""
        first, end = self._rows
        return end - first, self.shot.shape[1]

    @cached_property
    def folder(self) -> Path:
        """Where they are kept: another one as soon as anything differs that they depend on, the tracer included."""
        settings = (self.seed, self.jitter, self.bounces, self._rows, CHUNK)
        return cache.cache_folder() / "references" / fingerprint([self.shot.identity, settings])[:32]

    def refine(self, number: int, goal: Goal, run: Map = here) -> Iterator[Estimate]:
        """The estimate of frame `number`: the kept one where there is one, and after each further chunk.

        It ends with the first that reaches the goal. An estimate that has gone beyond is left alone: the goal alone
        decides what comes out.
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
        """The estimate of frame `number` from `spp` samples per pixel, or so many more as fill the last chunk.

        `advance` is called `chunks` times: for each chunk, kept ones included.
        """
        done = 0
        for estimate in self.refine(number, Goal(spp)):
            for _ in range(done, estimate.spp // CHUNK):
                advance()
            done = estimate.spp // CHUNK
        return estimate

    def picture(self, estimate: Estimate) -> Float32:
        """The colour of an estimate as an image (H, W, 3); H counts the rendered rows."""
        return estimate.color.reshape(*self.shape, 3)

    def write(self, path: Path, number: int, estimate: Estimate) -> None:
        """Write an estimate of frame `number` as an EXR file, whole or not at all.

        It has the channels of a frame, whose G-buffer is that of the pixel centres; those of the standard error of the
        colour, ``error.R`` and so on; and what it was made with, as attributes.

        Raises
        ------
        FileError
            The file cannot be written.
        """
        first, end = self._rows
        features = render_frame(self.shot, number, jitter=False, bounces=0).present()
        del features["hit_distance"]  # a single sample's, nothing that converges
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
    """How many chunks hold `spp` samples per pixel."""
    return ceil(spp / CHUNK)


def trace_chunk(
    shot: Shot, index: int, *, number: int, seed: int, jitter: bool, bounces: int, rows: tuple[int, int]
) -> Estimate:
    """What chunk `index` of the samples of frame `number` says of the pixels of `rows`."""
    sampler = Sampler(shot, number, stream=REFERENCE, seed=seed, jitter=jitter, bounces=bounces)
    first, end = (row * shot.shape[1] for row in rows)

    def gather(tile: slice) -> Estimate:
        pixels = slice(first + tile.start, first + tile.stop)
        return Estimate.of(sampler.trace(pixels, CHUNK * index + sample) for sample in range(CHUNK))

    return Estimate.beside(in_threads(gather, tiles(end - first)))

"""Renders the frames of a shot, and the samples of frames and references."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import NamedTuple, TypeVar

import numpy as np

from svgf_cl.frame import Frame

from .camera import Lens
from .errors import SceneError
from .fingerprint import fingerprint
from .integrator import trace
from .paths import Aim, Before, Draws, Features, Radiance
from .sampling import pixel_jitter, stream_key
from .shading import pick_moments, sum_up
from .shot import Shot
from .surroundings import Moment
from .vec3 import Vec3
from .vectors import Float32

# Pixels that one task traces at once: few enough that the data between Embree and the compiled loops fits in a core's
# cache, and enough to amortise the calls.
TILE = 1 << 15

# Moments while the shutter is open; each ray chooses one. An object that moves by fewer pixels than this in that time
# shows no gaps.
MOMENTS = 16

# The purpose of a stream of random numbers: a reference shares no noise with the frames that are compared with it.
FRAME, REFERENCE = 0, 1

NO_FEATURES = Features.empty(0)

Item = TypeVar("Item")
Result = TypeVar("Result")


class Exposure(NamedTuple):
    """One moment while a frame's shutter is open, and the same moment one frame earlier."""

    moment: Moment
    lens: Lens
    before: Before


def render_sequence(
    shot: Shot, *, spp: int = 1, seed: int = 0, jitter: bool = True, bounces: int = 1
) -> Iterator[Frame]:
    """Render the frames of a shot, one after another.

    Parameters and errors are those of `render_frame`.
    """
    for number in range(shot.frames):
        yield render_frame(shot, number, spp=spp, seed=seed, jitter=jitter, bounces=bounces)


def render_frame(
    shot: Shot, number: int, *, spp: int = 1, seed: int = 0, jitter: bool = True, bounces: int = 1
) -> Frame:
    """Render one noisy frame with its G-buffer.

    Parameters
    ----------
    shot : Shot
    number : int
        The frame's index in the shot, from 0; it determines the noise and the sub-pixel offset.
    spp : int
        Samples per pixel, >= 1. The G-buffer is the first sample's; radiance is the mean over all.
    seed : int
        >= 0. The same seed gives the same image, with any number of threads.
    jitter : bool
        Move the first sample off the pixel centre by the frame's Halton offset, and place further samples at random
        within the pixel.
    bounces : int
        Surfaces that may scatter a path after the first surface, >= 0.

    Returns
    -------
    Frame
        With all fields, as in `Radiance` and `Features`.

    Raises
    ------
    SceneError
        If a number is out of its range.
    """
    _check(spp=(spp, 1), number=(number, 0), seed=(seed, 0), bounces=(bounces, 0))
    sampler = Sampler(shot, number, stream=FRAME, seed=seed, jitter=jitter, bounces=bounces)
    count = shot.shape[0] * shot.shape[1]
    features, radiance = Features.empty(count), Radiance.empty(count)

    def finish(pixels: slice) -> None:
        light = sampler.trace(pixels, 0, features.part(pixels))
        for sample in range(1, spp):
            light += sampler.trace(pixels, sample)
        sum_up(light, spp, radiance.part(pixels))

    for _ in in_threads(finish, tiles(count)):
        pass
    fields = features._asdict() | radiance._asdict()
    return Frame(**{name: values.reshape(*shot.shape, *values.shape[1:]) for name, values in fields.items()})


def frame_identity(
    shot: Shot, number: int, *, spp: int = 1, seed: int = 0, jitter: bool = True, bounces: int = 1
) -> str:
    """Hash of everything on which `render_frame` with the same arguments depends."""
    return fingerprint([shot.identity, number, spp, seed, jitter, bounces])


class Sampler:
    """Traces single samples of a frame's pixels.

    Parameters
    ----------
    shot, number, seed, bounces
        As in `render_frame`.
    stream : int
        The purpose of the samples: `FRAME` or `REFERENCE`.
    jitter : bool
        Spread the samples over the pixel's square: the first of a frame by the frame's Halton offset, all others at
        random. Otherwise they pass through the pixel's centre.
    """

    def __init__(self, shot: Shot, number: int, *, stream: int, seed: int, jitter: bool, bounces: int) -> None:
        self._exposures = _exposures(shot, number)
        self._key = stream_key(stream, seed, number)
        self._bounces = bounces
        self._further = Aim(shot.shape[1], 0.0, 0.0, 1.0 if jitter else 0.0)
        offset = Aim(shot.shape[1], *pixel_jitter(number), 0.0)
        self._first = offset if jitter and stream == FRAME else self._further

    def trace(self, pixels: slice, sample: int, features: Features = NO_FEATURES) -> Float32:
        """Light (N, 5, 3) of one sample of neighbouring pixels in row order; also fills `features`, unless it is empty.

        The result depends on the number of the sample, >= 0, but not on which other samples are traced, or by whom.
        """
        draws = Draws(self._key, sample, np.arange(pixels.start, pixels.stop))
        aim = self._first if sample == 0 else self._further
        if len(self._exposures) == 1:
            return trace(*self._exposures[0], draws, aim, self._bounces, features)
        count = len(draws.pixels)
        light, moments = np.empty((count, 5, 3), np.float32), np.empty(count, np.int64)
        pick_moments(draws, len(self._exposures), moments)
        for moment, exposure in enumerate(self._exposures):
            chosen = np.flatnonzero(moments == moment)
            part = draws._replace(pixels=draws.pixels[chosen])
            seen = Features.empty(len(chosen) if len(features.depth) else 0)
            light[chosen] = trace(*exposure, part, aim, self._bounces, seen)
            for target, values in zip(features, seen, strict=True) if len(features.depth) else ():
                target[chosen] = values
        return light


def tiles(count: int) -> list[slice]:
    """Divide pixels into groups that are traced at once."""
    return [slice(start, min(start + TILE, count)) for start in range(0, count, TILE)]


def _exposures(shot: Shot, number: int) -> list[Exposure]:
    """The moments of a frame: a single one if nothing is blurred."""
    shutter = shot.camera(number).shutter
    moving = shot.scene.changes or shot.camera(number) != shot.camera(number + shutter)
    opened = [shutter * (index + 0.5) / MOMENTS for index in range(MOMENTS)] if shutter and moving else [0.0]
    origin = shot.origin(number)
    return [_exposure(shot, origin, number + offset, max(number - 1, 0) + offset) for offset in opened]


def _exposure(shot: Shot, origin: Vec3, now: float, before: float) -> Exposure:
    surroundings = shot.scene.around(origin)
    moment, corners_before = surroundings.at(shot.time(now)), surroundings.corners_at(shot.time(before))
    camera, camera_before = (shot.camera(number).relative_to(origin) for number in (now, before))
    lens = camera.lens(shot.shape, moment.trees.clearance(camera.position))
    return Exposure(moment, lens, Before(camera_before.lens(shot.shape), surroundings.first_moving, corners_before))


def in_threads(function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Results in the order of `items`, computed on all cores; only few results wait to be fetched."""
    workers = os.cpu_count() or 1
    with ThreadPoolExecutor(workers) as pool:
        waiting: deque[Future[Result]] = deque()
        try:
            for item in items:
                waiting.append(pool.submit(function, item))
                if len(waiting) > 2 * workers:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            pool.shutdown(cancel_futures=True)


def _check(**numbers: tuple[int, int]) -> None:
    """Raise `SceneError` unless each number is at least its minimum."""
    for name, (value, least) in numbers.items():
        if value < least:
            raise SceneError(f"{name}: expected at least {least}, got {value}")

"""Makes noisy frames of an empty room in closed form, for benchmarks and tests that need no path tracer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import Frame, Shape

Array = NDArray[np.float64]

HALF_SIZE = np.array([4.0, 2.0, 6.0])  # the room reaches from -HALF_SIZE to HALF_SIZE
TILES_PER_UNIT = 2.0
LIGHT = 0.5  # mean of each signal divided by the albedo
FOCAL_LENGTH = 0.9  # in image heights
# The camera looks along -z and moves around a small loop in this many frames, so that they can be repeated.
PERIOD = 8
LOOP = np.array([0.03, 0.01, 0.05])


def room_frames(shape: Shape, count: int, *, signals: int = 1, seed: int = 0) -> Iterator[Frame]:
    """Yield frames of a camera that moves in a tiled room, with exponentially distributed noise in the light.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    count : int, frames
    signals : int, 1 or 2
        With 2, frames have direct and indirect light, too.
    seed : int

    Yields
    ------
    Frame
        It has albedo and id; motion has three components and is exact.
    """
    for index in range(count):
        yield room_frame(shape, index, index - 1, signals=signals, seed=seed)


def room_frame(shape: Shape, index: int, previous: int, *, signals: int = 1, seed: int = 0) -> Frame:
    """Return the frame at position `index` of the camera's loop; its motion leads to position `previous`."""
    view = View.of(shape, eye(index))
    past = view.points - eye(previous)
    deeper = -past[..., 2:] - view.depth[..., None]
    motion = np.concatenate([project(past, shape) - pixels(shape), deeper], axis=-1)
    rng = np.random.default_rng((seed, index))
    lights = [LIGHT * view.albedo * rng.exponential(1.0, (*shape, 1)) for _ in range(signals)]
    split = {} if signals == 1 else {"direct": lights[0], "indirect": lights[1]}
    surface = {"albedo": view.albedo, "normal": view.normal, "depth": view.depth, "motion": motion}
    fields = {"color": sum(lights), **split, **surface}
    single = {name: np.ascontiguousarray(value, np.float32) for name, value in fields.items()}
    return Frame(**single, id=view.wall.astype(np.uint32))


@dataclass(frozen=True, eq=False)
class View:
    """The surfaces that the camera sees: (H, W, 3) points, normal and albedo; (H, W) depth and wall."""

    points: Array
    normal: Array
    albedo: Array
    depth: Array
    wall: Array

    @classmethod
    def of(cls, shape: Shape, origin: Array) -> View:
        """Return the view of the room from `origin`."""
        towards = rays(shape)
        with np.errstate(divide="ignore"):
            distances = (np.copysign(HALF_SIZE, towards) - origin) / towards
        axis = np.argmin(distances, axis=-1)
        t = np.take_along_axis(distances, axis[..., None], axis=-1)
        side = np.take_along_axis(np.sign(towards), axis[..., None], axis=-1)
        points = origin + t * towards
        dark = (np.floor(points * TILES_PER_UNIT + 1e-6).sum(axis=-1) % 2)[..., None]
        return cls(
            points=points,
            normal=-side * np.eye(3)[axis],
            albedo=np.where(dark, (0.25, 0.3, 0.35), (0.8, 0.75, 0.7)),
            depth=t[..., 0],
            wall=1 + 2 * axis + (side[..., 0] > 0),
        )


def eye(index: int) -> Array:
    """Return the camera's position at a frame."""
    turn = 2 * np.pi * index / PERIOD
    return LOOP * (np.sin(turn), np.cos(turn), np.cos(turn))


def pixels(shape: Shape) -> Array:
    """Return x and y of every pixel's centre, (H, W, 2)."""
    height, width = shape
    return np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(np.float64)


def rays(shape: Shape) -> Array:
    """Return the rays' directions, (H, W, 3), scaled so that the distance along them is depth."""
    height, width = shape
    offset = (pixels(shape) - ((width - 1) / 2, (height - 1) / 2)) / (FOCAL_LENGTH * height)
    return np.stack([offset[..., 0], -offset[..., 1], np.full(shape, -1.0)], axis=-1)


def project(points: Array, shape: Shape) -> Array:
    """Return the pixel that shows a point, (H, W, 2); points are relative to the eye, (H, W, 3)."""
    height, width = shape
    seen: Array = points[..., :2] * (1, -1) / -points[..., 2:] * FOCAL_LENGTH * height + (
        (width - 1) / 2,
        (height - 1) / 2,
    )
    return seen

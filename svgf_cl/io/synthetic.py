"""Noisy frames of an empty room, computed in closed form: input for benchmarks and tests that need no path tracer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import Frame, Shape

Array = NDArray[np.float64]

HALF_SIZE = np.array([4.0, 2.0, 6.0])  # the room reaches from -HALF_SIZE to HALF_SIZE
TILES_PER_UNIT = 2.0
LIGHT = 0.5  # mean of each signal over the albedo
FOCAL_LENGTH = 0.9  # in image heights
# The camera looks along -z and goes round a small loop in so many frames: they may be sent over and over.
PERIOD = 8
LOOP = np.array([0.03, 0.01, 0.05])


def room_frames(shape: Shape, count: int, *, signals: int = 1, seed: int = 0) -> Iterator[Frame]:
    """Frames of a camera that moves in a tiled room lit with exponentially distributed noise.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    count : int, frames
    signals : int, 1 or 2
        2 supplies direct and indirect light apart.
    seed : int

    Yields
    ------
    Frame
        With albedo and id; motion has three components and is exact.
    """
    for index in range(count):
        yield room_frame(shape, index, index - 1, signals=signals, seed=seed)


def room_frame(shape: Shape, index: int, previous: int, *, signals: int = 1, seed: int = 0) -> Frame:
    """The frame at place `index` of the camera's loop, as it comes after the one at place `previous`."""
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
    """What the camera sees: (H, W, 3) points, normal, albedo; (H, W) depth, wall."""

    points: Array
    normal: Array
    albedo: Array
    depth: Array
    wall: Array

    @classmethod
    def of(cls, shape: Shape, origin: Array) -> View:
        """The room from `origin`."""
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
    """Where the camera is at a frame."""
    turn = 2 * np.pi * index / PERIOD
    return LOOP * (np.sin(turn), np.cos(turn), np.cos(turn))


def pixels(shape: Shape) -> Array:
    """(H, W, 2) x and y of every pixel's centre."""
    height, width = shape
    return np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(np.float64)


def rays(shape: Shape) -> Array:
    """(H, W, 3) directions whose component along the view is 1, so that distance along them is depth."""
    height, width = shape
    offset = (pixels(shape) - ((width - 1) / 2, (height - 1) / 2)) / (FOCAL_LENGTH * height)
    return np.stack([offset[..., 0], -offset[..., 1], np.full(shape, -1.0)], axis=-1)


def project(points: Array, shape: Shape) -> Array:
    """(H, W, 2) pixel where a point relative to the eye, (H, W, 3), is seen."""
    height, width = shape
    seen: Array = points[..., :2] * (1, -1) / -points[..., 2:] * FOCAL_LENGTH * height + (
        (width - 1) / 2,
        (height - 1) / 2,
    )
    return seen

"""Images of a scene: one frame, a sequence, a reference."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import Frame

from .camera import Camera, CameraPath
from .errors import SceneError
from .sampling import pixel_jitter, random_stream
from .scene import Scene
from .vectors import Float32, Float64
from .view import Shape, View

# Pixels that one task traces at once: few enough for the temporaries to stay in a core's cache, enough for NumPy and
# Embree to amortise their calls. Each tile has a random stream of its own, so the noise depends on this number.
TILE = 1 << 14

# First number of a random stream's key: a reference shares no noise with the frames that are compared with it.
FRAME, REFERENCE = 0, 1

Item = TypeVar("Item")
Result = TypeVar("Result")


def render_sequence(
    scene: Scene,
    path: CameraPath,
    size: Shape,
    frames: int,
    spp: int = 1,
    jitter: bool = True,
    seed: int = 0,
    bounces: int = 1,
) -> Iterator[Frame]:
    """Render `frames` frames of (height, width) `size` along the whole of `path`, one after another.

    The other parameters, and the errors, are those of `render_frame`.
    """
    previous = None
    for index in range(frames):
        camera = path.at_frame(index, frames)
        yield render_frame(
            scene, camera, previous, size, frame_index=index, spp=spp, jitter=jitter, seed=seed, bounces=bounces
        )
        previous = camera


def render_frame(
    scene: Scene,
    camera: Camera,
    previous_camera: Camera | None,
    shape: Shape,
    *,
    frame_index: int = 0,
    spp: int = 1,
    jitter: bool = True,
    seed: int = 0,
    bounces: int = 1,
) -> Frame:
    """Render one noisy frame with its G-buffer.

    Parameters
    ----------
    scene : Scene
    camera, previous_camera : Camera
        Those of this frame and of the one before; None where there is none, which gives no motion.
    shape : (height, width)
        Size of the image in pixels.
    frame_index : int
        Number of the frame, >= 0; it picks the noise and the sub-pixel offset.
    spp : int
        Samples per pixel, >= 1. The G-buffer is the first sample's; radiance is the mean over all.
    jitter : bool
        Move the first sample off the pixel centre by the frame's Halton offset, and further samples at random
        within the pixel.
    seed : int
        >= 0. The same seed gives the same image, whatever the number of threads.
    bounces : int
        Surfaces a path may visit after the first, >= 0.

    Returns
    -------
    Frame
        With every field; ``color = direct + indirect + emission``.

    Raises
    ------
    SceneError
        A number is out of its range.
    """
    _check(shape, spp=(spp, 1), frame_index=(frame_index, 0), seed=(seed, 0), bounces=(bounces, 0))

    def trace(job: tuple[int, slice]) -> tuple[slice, Float32, dict[str, NDArray[np.generic]]]:
        sample, tile = job
        random = random_stream(FRAME, seed, frame_index, sample, tile.start)
        x, y = _pixels(tile, shape)
        if jitter:
            dx, dy = pixel_jitter(frame_index) if sample == 0 else random.random((2, len(x))) - 0.5
            x, y = x + dx, y + dy
        view = View.through(scene, camera, x, y, shape)
        return tile, view.radiance(random, bounces), {} if sample else view.features(previous_camera or camera)

    light = np.zeros((3, 3, shape[0] * shape[1]), np.float32)
    features: dict[str, list[NDArray[np.generic]]] = {}
    for tile, radiance, part in _in_threads(trace, _jobs(spp, shape)):
        light[:, :, tile] += radiance
        for name, planes in part.items():
            features.setdefault(name, []).append(planes)
    light /= spp
    direct, indirect, emission = light
    fields = {name: np.concatenate(parts, axis=-1) for name, parts in features.items()}
    fields |= {"color": direct + indirect + emission, "direct": direct, "indirect": indirect, "emission": emission}
    return Frame(**{name: _image(planes, shape) for name, planes in fields.items()})


def render_reference(
    scene: Scene,
    camera: Camera,
    shape: Shape,
    *,
    spp: int,
    seed: int = 0,
    bounces: int = 1,
    jitter: bool = True,
    rows: tuple[int, int] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Float32:
    """Render what the frames converge to: the mean radiance over each pixel's square.

    Parameters
    ----------
    scene, camera, shape, seed, bounces
        As in `render_frame`. No noise is shared with a frame of the same seed.
    spp : int
        Samples per pixel, >= 1.
    jitter : bool
        False: what frames without jitter converge to, the radiance at each pixel's centre.
    rows : (int, int), optional
        First row and the one after the last, of those to render; all by default.
    progress : callable, optional
        Called with (samples done, `spp`) after each sample of the image.

    Returns
    -------
    (H, W, 3) float32
        Linear radiance; H counts the rendered rows.

    Raises
    ------
    SceneError
        A number is out of its range.
    """
    first, end = rows or (0, shape[0])
    _check(shape, spp=(spp, 1), seed=(seed, 0), bounces=(bounces, 0))
    if not 0 <= first < end <= shape[0]:
        raise SceneError(f"rows: expected 0 <= first < end <= {shape[0]}, got {rows}")
    window = end - first, shape[1]

    def trace(job: tuple[int, slice]) -> tuple[int, slice, Float32]:
        sample, tile = job
        random = random_stream(REFERENCE, seed, sample, tile.start)
        x, y = _pixels(tile, window) + (random.random((2, tile.stop - tile.start)) - 0.5 if jitter else 0.0)
        return sample, tile, View.through(scene, camera, x, y + first, shape).radiance(random, bounces).sum(0)

    total = np.zeros((3, window[0] * window[1]))
    for sample, tile, radiance in _in_threads(trace, _jobs(spp, window)):
        total[:, tile] += radiance
        if progress and tile.stop == total.shape[1]:
            progress(sample + 1, spp)
    return _image((total / spp).astype(np.float32), window)


def _jobs(spp: int, shape: Shape) -> list[tuple[int, slice]]:
    """(sample, range of pixels) for everything to be traced, sample after sample."""
    count = shape[0] * shape[1]
    tiles = [slice(start, min(start + TILE, count)) for start in range(0, count, TILE)]
    return [(sample, tile) for sample in range(spp) for tile in tiles]


def _in_threads(function: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Results in the order of `items`, computed on all cores: NumPy and Embree let other threads run meanwhile."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            yield from pool.map(function, items)
        finally:
            pool.shutdown(cancel_futures=True)


def _pixels(tile: slice, shape: Shape) -> Float64:
    """Columns and rows (2, N) of a range of pixels."""
    y, x = np.divmod(np.arange(tile.start, tile.stop), shape[1])
    return np.stack([x, y]).astype(np.float64)


def _image(planes: NDArray[Any], shape: Shape) -> NDArray[Any]:
    """(3, N) or (N,) planes as a C-contiguous image (H, W, 3) or (H, W)."""
    return np.ascontiguousarray(planes.T).reshape(*shape, *planes.shape[:-1])


def _check(shape: Shape, **numbers: tuple[int, int]) -> None:
    """Raise `SceneError` unless `shape` is positive and each number reaches its minimum."""
    if min(shape) < 1:
        raise SceneError(f"shape: expected a height and a width of at least 1, got {shape}")
    for name, (value, least) in numbers.items():
        if value < least:
            raise SceneError(f"{name}: expected at least {least}, got {value}")

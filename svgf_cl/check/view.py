"""`View`: a frame as the checks see it, in float64, without values that cannot be used."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from svgf_cl.frame import Frame, Shape

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Whole = NDArray[np.int64]

# Rows that are enough. In a frame with more rows, checks use every second, third... row and column. With 180 of 720
# rows, a slowly moving camera could not be distinguished from a static one.
ENOUGH_ROWS = 240
# A picture with fewer pixels is small: many lie on edges, and edges of different fields coincide by chance.
FEW = 100 * 100
# The denoiser sees a surface where depth is in this range and the normal is longer than this.
DEPTH_RANGE, SHORTEST_NORMAL = (1e-20, 1e20), 1e-6
# A depth beyond this many times the median means that nothing was hit, even if there is a normal.
FAR = 1e4


@dataclass(frozen=True, eq=False)
class View:
    """A frame on the host; the checks look at every `step`-th row and column, (h, w) pixels.

    Parameters
    ----------
    frame : Frame
        All pixels as they were given, in numpy arrays.
    step : int
    color : (h, w, 3)
        All radiance; the sum of `direct`, `indirect` and `emission` if the frame has no color.
    normal : (h, w, 3)
    depth : (h, w)
        0 where depth cannot be used.
    motion : (h, w, 2)
        In pixels of the view.
    deeper : (h, w), optional
        The third component of motion.
    albedo, emission : (h, w, 3), optional
    id : (h, w), optional
    hit : (h, w)
        Where the denoiser sees a surface.
    nearness : (h, w)
        One over depth, which is linear in x and y on a plane; 0 where nothing was hit.
    reflecting : (h, w)
        Where the denoiser sees a surface that emits no light.
    """

    frame: Frame
    step: int
    color: Array
    normal: Array
    depth: Array
    motion: Array
    deeper: Array | None
    albedo: Array | None
    emission: Array | None
    id: Whole | None
    hit: Mask
    nearness: Array
    reflecting: Mask

    @property
    def shape(self) -> Shape:
        """(height, width) of the view."""
        height, width = self.depth.shape
        return height, width

    @property
    def is_small(self) -> bool:
        """Whether there are too few pixels to exclude coincidence."""
        return self.depth.size < FEW

    @classmethod
    def of(cls, frame: Frame) -> View:
        """Make the view of a frame; arrays on a device are copied to the host."""
        given = {name: on_host(frame.layer(name)) for name in frame.present()}
        step = -(-given["depth"].shape[0] // ENOUGH_ROWS)
        some = {name: value[(step - 1) // 2 :: step, (step - 1) // 2 :: step] for name, value in given.items()}
        finite = {name: np.nan_to_num(value.astype(np.float64), posinf=0, neginf=0) for name, value in some.items()}
        parts = [finite[name] for name in ("direct", "indirect", "emission") if name in finite]
        depth, motion, emission = finite["depth"], finite["motion"], finite.get("emission")
        hit = is_hit(depth, finite["normal"])
        depth[~in_range(depth) | (depth > FAR * typical(depth[hit]))] = 0
        hit &= depth > 0
        return cls(
            frame=Frame(**given),
            step=step,
            color=finite["color"] if "color" in finite else np.sum(parts, axis=0),
            normal=finite["normal"],
            depth=depth,
            motion=motion[..., :2] / step,
            deeper=motion[..., 2] if motion.shape[-1] == 3 else None,
            albedo=finite.get("albedo"),
            emission=emission,
            id=some["id"].astype(np.int64) if "id" in some else None,
            hit=hit,
            nearness=np.divide(1, depth, out=np.zeros_like(depth), where=hit),
            reflecting=hit if emission is None else hit & (over_channels(np.maximum, emission) <= 0),
        )


def on_host(value: Any) -> NDArray[Any]:
    """Return an array as numpy.ndarray; for a pyopencl.array.Array, with any strides, its whole buffer is copied."""
    if isinstance(value, np.ndarray):
        return value
    memory = np.empty(value.base_data.size, np.uint8)
    cl.enqueue_copy(cl.CommandQueue(value.context), memory, value.base_data, wait_for=value.events)
    elements: NDArray[Any] = np.ndarray(value.shape, value.dtype, memory, value.offset, value.strides)
    return elements


def in_range(depth: NDArray[Any]) -> Mask:
    """Return whether the denoiser treats a depth as that of a surface."""
    within: Mask = (depth > DEPTH_RANGE[0]) & (depth < DEPTH_RANGE[1])
    return within


def is_hit(depth: NDArray[Any], normal: NDArray[Any]) -> Mask:
    """Return whether the denoiser sees a surface, by its depth (h, w) and finite normal (h, w, 3)."""
    return in_range(depth) & has_normal(normal)


def has_normal(normal: NDArray[Any]) -> Mask:
    """Return whether there is a normal (h, w, 3); NaN is none."""
    long: Mask = over_channels(np.maximum, np.abs(normal)) > SHORTEST_NORMAL
    return long


def over_channels(combine: np.ufunc, values: NDArray[Any]) -> NDArray[Any]:
    """Combine the channels of (h, w, C) to (h, w); NumPy's own reduction of such a short axis is ten times slower."""
    combined: NDArray[Any] = reduce(combine, np.moveaxis(values, -1, 0))
    return combined


def beside(values: NDArray[Any], axis: int, reach: int = 1) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the values `reach` pixels before and behind, (h, w, ...) like `values`; the border is repeated."""
    around = np.pad(values, [(reach, reach) if axis == other else (0, 0) for other in range(values.ndim)], "edge")
    start, end = (0, 2 * reach), (values.shape[axis], values.shape[axis] + 2 * reach)
    before, behind = (around[:, s:e] if axis else around[s:e] for s, e in zip(start, end, strict=True))
    return before, behind


def length(vectors: NDArray[Any]) -> NDArray[Any]:
    """Return the lengths (...) of vectors (..., C); `numpy.linalg.norm` over such a short axis is much slower."""
    lengths: NDArray[Any] = np.sqrt(np.einsum("...c,...c->...", vectors, vectors))
    return lengths


def pixel_centers(shape: Shape) -> tuple[Array, Array]:
    """Return x and y of every pixel, (h, w), from the middle of the image."""
    height, width = shape
    y, x = np.mgrid[:height, :width].astype(np.float64)
    return x - (width - 1) / 2, y - (height - 1) / 2


def sample(mask: Mask, count: int) -> Whole:
    """Return at most `count` places of a mask, always the same ones, as indices into the flattened mask."""
    return np.random.default_rng(0).permutation(np.flatnonzero(mask))[:count]


def typical(depth: Array) -> float:
    """Return the median of the depths above 0; infinite if there are none."""
    usable = depth[depth > 0]
    return float(np.median(usable)) if usable.size else np.inf

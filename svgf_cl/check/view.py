"""`View`: a frame as the checks look at it, in float64, with what cannot be used taken out."""

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

# Rows that suffice. Of a higher frame every second, third... row and column is looked at: those make a frame too.
# Of 720 rows, 180 no longer tell a camera that moves slowly from one that stands still.
ENOUGH_ROWS = 240
# Pixels of a picture; in fewer, much lies on edges, and those of one field fall on those of others by chance.
FEW = 100 * 100
# Where the denoiser sees a surface: between these depths, where the normal is at least so long.
DEPTH_RANGE, SHORTEST_NORMAL = (1e-20, 1e20), 1e-6
# Depth beyond so many times the median was meant to say that nothing was hit, whatever the normal says.
FAR = 1e4


@dataclass(frozen=True, eq=False)
class View:
    """A frame on the host, of which every `step`-th pixel is looked at: (h, w) of them.

    Parameters
    ----------
    frame : Frame
        Of numpy arrays, every pixel, as it was given.
    step : int
    color : (h, w, 3)
        All radiance; the sum of `direct`, `indirect` and `emission` where color was left out.
    normal : (h, w, 3)
    depth : (h, w)
        0 where it cannot be used.
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
        Where a surface was hit that does not shine itself.
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
        """(height, width) of what is looked at."""
        height, width = self.depth.shape
        return height, width

    @property
    def is_small(self) -> bool:
        """Whether there are so few pixels that chance tells as much as they do."""
        return self.depth.size < FEW

    @classmethod
    def of(cls, frame: Frame) -> View:
        """Look at a frame; arrays on a device are copied from there."""
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
    """A numpy.ndarray of it; for a pyopencl.array.Array, whatever its strides, all of its buffer is copied."""
    if isinstance(value, np.ndarray):
        return value
    memory = np.empty(value.base_data.size, np.uint8)
    cl.enqueue_copy(cl.CommandQueue(value.context), memory, value.base_data, wait_for=value.events)
    elements: NDArray[Any] = np.ndarray(value.shape, value.dtype, memory, value.offset, value.strides)
    return elements


def in_range(depth: NDArray[Any]) -> Mask:
    """Whether the denoiser takes a depth for that of a surface."""
    within: Mask = (depth > DEPTH_RANGE[0]) & (depth < DEPTH_RANGE[1])
    return within


def is_hit(depth: NDArray[Any], normal: NDArray[Any]) -> Mask:
    """Whether the denoiser sees a surface, by its depth (h, w) and finite normal (h, w, 3)."""
    return in_range(depth) & has_normal(normal)


def has_normal(normal: NDArray[Any]) -> Mask:
    """Whether there is a normal (h, w, 3) at all, NaN being none."""
    long: Mask = over_channels(np.maximum, np.abs(normal)) > SHORTEST_NORMAL
    return long


def over_channels(combine: np.ufunc, values: NDArray[Any]) -> NDArray[Any]:
    """Combine the channels of (h, w, C): (h, w). NumPy's own reduction of so short an axis takes ten times as long."""
    combined: NDArray[Any] = reduce(combine, np.moveaxis(values, -1, 0))
    return combined


def shifted(values: NDArray[Any], dx: int, dy: int) -> NDArray[Any]:
    """What lies (dx, dy) pixels further, the border repeated: (h, w, ...) like `values`."""
    height, width = values.shape[:2]
    rows = np.clip(np.arange(height) + dy, 0, height - 1)
    columns = np.clip(np.arange(width) + dx, 0, width - 1)
    return values[rows[:, None], columns]


def pixel_centers(shape: Shape) -> tuple[Array, Array]:
    """Columns and rows of every pixel, x and y (h, w), from the middle of the image."""
    height, width = shape
    y, x = np.mgrid[:height, :width].astype(np.float64)
    return x - (width - 1) / 2, y - (height - 1) / 2


def sample(mask: Mask, count: int) -> Whole:
    """At most `count` places of a mask, always the same ones, as indices into the flattened mask."""
    return np.random.default_rng(0).permutation(np.flatnonzero(mask))[:count]


def typical(depth: Array) -> float:
    """The median of a depth where it is above 0; infinite where it never is."""
    usable = depth[depth > 0]
    return float(np.median(usable)) if usable.size else np.inf

"""Light from all directions outside the scene: a constant, or an image.

An image is read with bilinear interpolation, and directions are sampled with a density that is interpolated in the same
way. A texel is chosen in proportion to its luminance and solid angle, and then a point around it under the tent of the
interpolation. So radiance divided by density varies little, even beside a sun that is one texel wide.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import LUMINANCE

from .compiled import compiled
from .errors import SceneError
from .vec3 import Vec3
from .vectors import Float32, Float64


@dataclass(frozen=True, eq=False)
class Environment:
    """An image of all directions, in equirectangular projection.

    Parameters
    ----------
    image : (h, w, 3) float32
        Linear radiance, finite, >= 0; row 0 is straight up. In the image's own frame (+y up), the middle column is in
        the direction +z, and +x is a quarter turn to its left: OpenEXR's convention for latitude-longitude maps.
    to_world : (3, 3) float
        Rotation from the image's frame into the world's.

    Raises
    ------
    SceneError
        If the image has another shape or an invalid radiance, or if `to_world` is not a rotation.
    """

    image: Float32
    to_world: Float64 = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        image: NDArray[np.floating] = np.asarray(self.image)
        if image.ndim != 3 or image.shape[2] != 3 or not image.size:
            raise SceneError(f"sky: expected an image of shape (h, w, 3), got {image.shape}")
        if not (np.isfinite(image).all() and image.min() >= 0.0):
            raise SceneError("sky: expected finite radiance >= 0 in every pixel of the image")
        if not np.allclose(self.to_world @ np.transpose(self.to_world), np.eye(3), atol=1e-4):
            raise SceneError(f"sky: expected a rotation from the image into the world, got {self.to_world}")


class SkyTable(NamedTuple):
    """A sky for compiled code, made by `sky_table`.

    Attributes
    ----------
    mean_radiance : Vec3
        The mean over all directions.
    image : (h, w, 3) float32
        As in `Environment`; one texel for a constant sky.
    rows : (h + 1,) float64
        The cumulative probability before each row; empty if there is nothing to sample.
    columns : (h, w + 1) float32
        Within each row, the cumulative probability before each texel.
    to_world : (3, 3) float64
        As in `Environment`.
    """

    mean_radiance: Vec3
    image: Float32
    rows: Float64
    columns: Float32
    to_world: Float64


def sky_table(sky: Vec3 | Environment | None) -> SkyTable:
    """The table of a constant radiance, an image, or darkness.

    `sample_sky` samples only images, because directions sampled from the surface find a constant sky well enough.
    """
    if not isinstance(sky, Environment):
        red, green, blue = (0.0, 0.0, 0.0) if sky is None else sky
        constant = np.full((1, 1, 3), (red, green, blue), np.float32)
        return SkyTable(
            (float(red), float(green), float(blue)), constant, np.empty(0), np.empty((0, 0), np.float32), np.eye(3)
        )
    image = np.require(sky.image, np.float32, ["C", "W"])
    height = len(image)
    solid_angle = np.sin(np.pi * (np.arange(height) + 0.5) / height)
    red, green, blue = (solid_angle @ image.mean(1, np.float64) / solid_angle.sum()).tolist()
    rows, columns = _distribution((image @ LUMINANCE) * solid_angle[:, None])
    return SkyTable((red, green, blue), image, rows, columns, np.array(sky.to_world, np.float64))


def _distribution(weights: Float64) -> tuple[Float64, Float32]:
    """`rows` and `columns` of a `SkyTable` for texels with `weights` (h, w) >= 0."""
    columns = np.pad(weights.cumsum(1), ((0, 0), (1, 0)))
    rows = np.pad(columns[:, -1].cumsum(), (1, 0))
    if rows[-1] == 0.0:
        return np.empty(0), np.empty((0, 0), np.float32)
    columns /= np.maximum(columns[:, -1:], np.finfo(np.float64).tiny)
    return rows / rows[-1], columns.astype(np.float32)


@compiled
def sky_radiance(table: SkyTable, direction: Vec3) -> Vec3:
    """Radiance that arrives from the unit vector `direction`."""
    if table.rows.size == 0:
        return table.mean_radiance
    column, row, _ = _position(table, direction)
    left, right, u = _neighbours_around(column, table.image.shape[1])
    upper, lower, v = _neighbours(row, table.image.shape[0])
    a, b = (1.0 - u) * (1.0 - v), u * (1.0 - v)
    c, d = (1.0 - u) * v, u * v
    image = table.image
    return (
        a * image[upper, left, 0] + b * image[upper, right, 0] + c * image[lower, left, 0] + d * image[lower, right, 0],
        a * image[upper, left, 1] + b * image[upper, right, 1] + c * image[lower, left, 1] + d * image[lower, right, 1],
        a * image[upper, left, 2] + b * image[upper, right, 2] + c * image[lower, left, 2] + d * image[lower, right, 2],
    )


@compiled
def sky_density(table: SkyTable, direction: Vec3) -> float:
    """Density of `sample_sky` per solid angle; 0 if there is nothing to sample."""
    if table.rows.size == 0:
        return 0.0
    column, row, sine = _position(table, direction)
    return _density(table, column, row, sine)


@compiled
def sample_sky(table: SkyTable, u1: float, u2: float) -> tuple[Vec3, float]:
    """A direction and its density per solid angle, for uniform numbers in [0, 1).

    The density is 0 if there is nothing to sample.
    """
    if table.rows.size == 0:
        return (0.0, 1.0, 0.0), 0.0
    height, width = table.image.shape[0], table.image.shape[1]
    picked, u1 = _pick(table.rows, u1)
    row = abs(picked + 0.5 + _tent(u1))
    row = min(row, 2 * height - row)
    picked, u2 = _pick(table.columns[picked], u2)
    column = picked + 0.5 + _tent(u2)
    polar, azimuth = math.pi * row / height, 2.0 * math.pi * (0.5 - column / width)
    x, y, z = math.sin(polar) * math.sin(azimuth), math.cos(polar), math.sin(polar) * math.cos(azimuth)
    m = table.to_world
    direction = (
        m[0, 0] * x + m[0, 1] * y + m[0, 2] * z,
        m[1, 0] * x + m[1, 1] * y + m[1, 2] * z,
        m[2, 0] * x + m[2, 1] * y + m[2, 2] * z,
    )
    return direction, _density(table, column % width, row, math.sin(polar))


@compiled
def _position(table: SkyTable, direction: Vec3) -> tuple[float, float, float]:
    """Column and row, in texels from the upper left corner of the image, and the sine of the polar angle."""
    m = table.to_world
    x = m[0, 0] * direction[0] + m[1, 0] * direction[1] + m[2, 0] * direction[2]
    y = m[0, 1] * direction[0] + m[1, 1] * direction[1] + m[2, 1] * direction[2]
    z = m[0, 2] * direction[0] + m[1, 2] * direction[1] + m[2, 2] * direction[2]
    sine = math.sqrt(x * x + z * z)
    column = table.image.shape[1] * (0.5 - 0.5 * math.atan2(x, z) / math.pi)
    return column, table.image.shape[0] * math.atan2(sine, y) / math.pi, sine


@compiled
def _neighbours_around(position: float, count: int) -> tuple[int, int, float]:
    """The texels before and after `position` in 0..count, in a row that wraps around, and the second one's weight."""
    before = int(np.floor(position - 0.5))
    return int(before) % count, (int(before) + 1) % count, position - 0.5 - before


@compiled
def _neighbours(position: float, count: int) -> tuple[int, int, float]:
    """The texels before and after `position` in 0..count, in a column, and the weight of the second one."""
    before = int(np.floor(position - 0.5))
    return max(int(before), 0), min(int(before) + 1, count - 1), position - 0.5 - before


@compiled
def _density(table: SkyTable, column: float, row: float, sine: float) -> float:
    """Density per solid angle at a position in the image: the probabilities of the texels, interpolated."""
    height, width = table.image.shape[0], table.image.shape[1]
    left, right, u = _neighbours_around(column, width)
    upper, lower, v = _neighbours(row, height)
    above = (1.0 - u) * _probability(table, upper, left) + u * _probability(table, upper, right)
    below = (1.0 - u) * _probability(table, lower, left) + u * _probability(table, lower, right)
    texel: float = 2.0 * math.pi * math.pi * max(sine, 1e-9) / (height * width)
    return ((1.0 - v) * above + v * below) / texel


@compiled
def _probability(table: SkyTable, row: int, column: int) -> float:
    """Probability of a texel."""
    of_row: float = table.rows[row + 1] - table.rows[row]
    within: float = table.columns[row, column + 1] - table.columns[row, column]
    return of_row * within


@compiled
def _pick(cumulative: Float64, u: float) -> tuple[int, float]:
    """The interval of `cumulative` that contains `u`, and the position of `u` between its ends."""
    index = np.searchsorted(cumulative, u, side="right") - 1
    return index, (u - cumulative[index]) / (cumulative[index + 1] - cumulative[index])


@compiled
def _tent(u: float) -> float:
    """An offset in -1..1 with the density of a tent, for a uniform number."""
    return math.sqrt(2.0 * u) - 1.0 if u < 0.5 else 1.0 - math.sqrt(2.0 - 2.0 * u)

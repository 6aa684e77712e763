"""The textures of the built-in scenes, computed: sRGB images (h, w, 3) uint8, row 0 on top."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..textures import Image
from ..vectors import Float64


def image(colour: ArrayLike) -> Image:
    """An image from sRGB values (h, w, C) in 0..255."""
    return np.clip(colour, 0, 255).astype(np.uint8)


def mixed(weight: Float64, first: ArrayLike, second: ArrayLike) -> Float64:
    """Colours (h, w, 3) between `first` (at weight 0) and `second` (at weight 1); the weight is (h, w)."""
    share = weight[..., None]
    colour: Float64 = (1.0 - share) * np.asarray(first, float) + share * np.asarray(second, float)
    return colour


def clouds(shape: tuple[int, int], seed: int, *, stretch: float = 1.0, slope: float = 1.6) -> Float64:
    """Fractal noise (h, w) in 0..1 that repeats without a seam.

    It is white noise whose spectrum falls with the frequency to the power of `slope`. It is stretched horizontally by
    the factor `stretch`.
    """
    down, across = np.fft.fftfreq(shape[0], 1 / shape[0]), np.fft.rfftfreq(shape[1], 1 / shape[1])
    frequency = np.hypot(down[:, None], stretch * across)
    frequency[0, 0] = np.inf
    noise = np.fft.irfft2(np.fft.rfft2(np.random.default_rng(seed).standard_normal(shape)) / frequency**slope, shape)
    low, high = np.quantile(noise, (0.01, 0.99))
    values: Float64 = ((noise - low) / (high - low)).clip(0.0, 1.0)
    return values


def tiles(columns: int, rows: int, dark: ArrayLike, light: ArrayLike, joint: ArrayLike) -> Image:
    """A floor of tiles in two tones, each tile slightly different, with pale joints."""
    size, width = 32, 1
    random = np.random.default_rng(7)
    y, x = np.mgrid[: rows * size, : columns * size]
    odd = (x // size + y // size) % 2
    colour = mixed(odd, light, dark)
    colour *= random.uniform(0.9, 1.06, (rows, columns, 1))[y // size, x // size]
    colour += random.normal(0.0, 4.0, (*x.shape, 1))
    joints = (np.minimum(x % size, y % size) < width)[..., None]
    return image(np.where(joints, joint, colour))


def bricks(columns: int, rows: int, dark: ArrayLike, light: ArrayLike, mortar: ArrayLike) -> Image:
    """A running bond of bricks, each with its own tone; it repeats if the number of rows is even."""
    wide, high = 48, 16
    random = np.random.default_rng(3)
    y, x = np.mgrid[: rows * high, : columns * wide]
    row = y // high
    x = (x + row % 2 * wide // 2) % (columns * wide)
    tone = random.uniform(0.0, 1.0, (rows, columns))[row, x // wide]
    grain = clouds(y.shape, 5, slope=0.9)
    joints = ((x % wide < 2) | (y % high < 2))[..., None]
    return image(np.where(joints, mortar, mixed(0.6 * tone + 0.4 * grain, dark, light)))


def planks(count: int, dark: ArrayLike, light: ArrayLike) -> Image:
    """`count` wooden boards above each other; the grain runs from left to right."""
    shape, high = (48 * count, 1024), 48
    y, x = np.mgrid[: shape[0], : shape[1]]
    random = np.random.default_rng(11)
    tone, start = random.uniform(0.0, 0.5, count)[y // high], random.integers(0, shape[1], count)[y // high]
    grain = clouds(shape, 13, stretch=24.0, slope=1.1)[y, (x + start) % shape[1]]
    gaps = (y % high < 1) | ((x + start) % (shape[1] // 2) < 1)
    return image(mixed(0.5 * grain + tone, dark, light) * np.where(gaps, 0.45, 1.0)[..., None])


def marble(size: int, seed: int, ground: ArrayLike, vein: ArrayLike) -> Image:
    """Polished stone: thin veins along the level lines of a noise."""
    veins = np.exp(-60.0 * np.abs(clouds((size, size), seed) - 0.5)) * clouds((size, size), seed + 1)
    return image(mixed((veins + 0.25 * clouds((size, size), seed + 2, slope=1.2)).clip(0, 1), ground, vein))


def plaster(size: int, seed: int, dark: ArrayLike, light: ArrayLike) -> Image:
    """Uneven paint on a wall."""
    return image(mixed(clouds((size, size), seed, slope=1.1), dark, light))

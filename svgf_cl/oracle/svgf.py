"""The oracle: docs/algorithm.md restated in float64 NumPy, one function per kernel, written to be read.

Arrays are image-shaped: planes (H, W), pictures (H, W, 3), and whatever exists once per signal has a leading axis S.
The symbols in the docstrings (p, q, c, V, M, N, g, w, h) and the section numbers are those of docs/algorithm.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from svgf_cl.frame import Frame, Shape
from svgf_cl.oracle.taps import (
    Array,
    Indices,
    Mask,
    Offset,
    bilinear_taps,
    catmull_rom_taps,
    depth_gradient,
    dot,
    finite,
    locate,
    luminance,
    nearest_taps,
    reprojected,
    shifted,
    smoothed,
    square,
)
from svgf_cl.settings import Settings

CHANNEL_MAX = 1e10
DEPTH_RANGE = (1e-20, 1e20)
ALBEDO_FLOOR = 0.001
# Whether kept as 16-bit floats.
ILLUMINATION_MAX = {False: 1e13, True: 65504.0}
MOTION_MAX = 1e6
NO_HISTORY = (-MOTION_MAX, -MOTION_MAX, 0.0)
NEARER = float(np.float32(0.9999))
LENGTH_MAX = {False: 1024, True: 32}
# By radius: of B3, and linear.
SPLINES = {2: {-2: 1 / 16, -1: 1 / 4, 0: 3 / 8, 1: 1 / 4, 2: 1 / 16}, 1: {-1: 1 / 4, 0: 1 / 2, 1: 1 / 4}}
YCOCG_OF_RGB = np.array(((1 / 4, 1 / 2, 1 / 4), (1 / 2, 0, -1 / 2), (-1 / 4, 1 / 2, -1 / 4)))
RGB_OF_YCOCG = np.array(((1, 1, -1), (1, 0, 1), (1, -1, -1)))


@dataclass(frozen=True, eq=False)
class Guides:
    """The noise-free part of a frame, made safe by `demodulate`.

    Parameters
    ----------
    normal : (H, W, 3), unit; 0 at a miss.
    depth : (H, W), > 0; 0 at a miss.
    motion : (H, W, 3), previous minus current x, y and depth.
    id : (H, W) integers, or None where the frame has none.
    albedo : (H, W, 3), 0.001..1.
    emission : (H, W, 3), not negative.
    """

    normal: Array
    depth: Array
    motion: Array
    id: NDArray[np.integer] | None
    albedo: Array
    emission: Array

    @property
    def hit(self) -> Mask:
        """Where something was seen, (H, W)."""
        return self.depth > 0


@dataclass(frozen=True, eq=False)
class Accumulated:
    """What temporal accumulation knows of each pixel.

    Parameters
    ----------
    illumination : (S, H, W, 3), c.
    mean : (S, H, W), M, of luminance.
    variance : (S, H, W), V, of luminance, from the moments.
    length : (H, W), N, in frames; 0 at a miss.
    """

    illumination: Array
    mean: Array
    variance: Array
    length: Array


@dataclass(frozen=True, eq=False)
class History:
    """The previous frame: its guides, and what it accumulated, with level 0's output as illumination (c_h)."""

    guides: Guides
    accumulated: Accumulated


def demodulate(frame: Frame, settings: Settings | None = None) -> tuple[Array, Guides]:
    """Section 1: make the input safe, then divide out the albedo.

    Parameters
    ----------
    frame : Frame of numpy arrays.
    settings : Settings, optional
        Say how bright light may be.

    Returns
    -------
    illumination : (S, H, W, 3), c; S is 2 with direct and indirect, else 1.
    guides : Guides
    """
    given = {name: np.asarray(value, np.float64) for name, value in frame.present().items() if name != "id"}
    albedo = given.get("albedo", np.ones((*frame.shape, 3)))
    albedo = np.where(np.isnan(albedo), 1, np.clip(albedo, ALBEDO_FLOOR, 1))
    emission = given.get("emission", np.zeros((*frame.shape, 3)))
    emission = np.maximum(known(emission), 0)
    normal, depth = safe_surface(given["normal"], given["depth"])
    guides = Guides(normal, depth, safe_motion(given["motion"]), frame.id, albedo, emission)

    split = "direct" in given
    reflected = [known(given[name]) for name in ("direct", "indirect")] if split else [known(given["color"]) - emission]
    greatest = ILLUMINATION_MAX[(settings or Settings()).half_history]
    return np.clip(np.stack(reflected) / albedo, 0, greatest), guides


def known(color: Array) -> Array:
    """Section 1: a radiance or normal, (..., 3); 0 where any channel is NaN or beyond 1e10."""
    return np.where((np.abs(color) <= CHANNEL_MAX).all(axis=-1, keepdims=True), color, 0)


def safe_surface(normal: Array, depth: Array) -> tuple[Array, Array]:
    """Section 1: unit normal (H, W, 3) and depth (H, W) of a hit, 0 and 0 of a miss."""
    normal = known(normal)
    squared = dot(normal, normal)
    nearest, farthest = DEPTH_RANGE
    hit = (depth > nearest) & (depth < farthest) & (squared > 1e-12)
    length = np.sqrt(np.where(hit, squared, 1))
    return np.where(hit[..., None], normal / length[..., None], 0), np.where(hit, depth, 0)


def safe_motion(motion: Array) -> Array:
    """Section 2: (H, W, 2) or (H, W, 3) to (H, W, 3), clamped; far outside the image where it is not finite."""
    if motion.shape[-1] == 2:
        motion = np.concatenate((motion, np.zeros_like(motion[..., :1])), axis=-1)
    bound = np.array((MOTION_MAX, MOTION_MAX, np.inf))
    return np.where(finite(motion), np.clip(motion, -bound, bound), NO_HISTORY)


def consistent(x: Indices, y: Indices, guides: Guides, previous: Guides, settings: Settings) -> Mask:
    """Section 2: whether the previous frame's taps (x, y), each (T, H, W), show what the pixel shows now."""
    gradient = depth_gradient(guides.depth)
    expected = guides.depth + guides.motion[..., 2]
    along_surface = dot(gradient, np.stack((x, y), axis=-1) - reprojected(guides.motion))
    tolerance = settings.depth_threshold * expected + np.abs(gradient).sum(axis=-1)

    rows, columns, inside = locate(x, y, guides.depth.shape)
    same = inside & guides.hit & previous.hit[rows, columns]
    same &= np.abs(previous.depth[rows, columns] - (expected + along_surface)) <= tolerance
    same &= dot(guides.normal, previous.normal[rows, columns]) >= settings.normal_threshold
    if guides.id is not None and previous.id is not None:
        same &= guides.id == previous.id[rows, columns]
    return same


def reproject(guides: Guides, history: History, settings: Settings) -> tuple[Accumulated, Mask]:
    """Section 2: the history mean over the consistent taps, and where there is one, (H, W)."""
    position = reprojected(guides.motion)

    # 13 candidates: the bilinear four, and the nearest nine that stand in where those four weigh too little.
    x, y, b = (np.concatenate(pair) for pair in zip(bilinear_taps(position), nearest_taps(position), strict=True))
    b *= consistent(x, y, guides, history.guides, settings)
    enough = b[:4].sum(axis=0) > 0.01
    b[:4] *= enough
    b[4:] *= ~enough
    found = b.sum(axis=0) > 0
    b /= np.where(found, b.sum(axis=0), 1)

    def average(taps: Array) -> Array:
        mean: Array = np.einsum("thw,sthw...->shw...", b, taps)
        return mean

    rows, columns, _ = locate(x, y, guides.depth.shape)
    past = history.accumulated
    mean = average(past.mean[:, rows, columns])
    deviation = past.mean[:, rows, columns] - mean[:, None]
    return Accumulated(
        illumination=average(past.illumination[:, rows, columns]),
        mean=mean,
        variance=average(past.variance[:, rows, columns] + deviation**2),
        length=average(past.length[None, rows, columns])[0],
    ), found


def temporal(illumination: Array, guides: Guides, history: History | None, settings: Settings) -> Accumulated:
    """Section 2: blend the new samples into the reprojected history.

    Parameters
    ----------
    illumination : (S, H, W, 3), this frame's, demodulated.
    guides : Guides, this frame's.
    history : History, or None on the first frame.
    """
    sample = luminance(illumination)
    fresh = Accumulated(illumination, sample, np.zeros_like(sample), guides.hit.astype(np.float64))
    if history is None:
        return fresh
    past, found = reproject(guides, history, settings)
    length = np.minimum(past.length + 1, LENGTH_MAX[settings.half_history])
    alpha_color = np.maximum(1 / length, settings.alpha_color)
    alpha_moments = np.maximum(1 / length, settings.alpha_moments)
    innovation = sample - past.mean
    blended = past.illumination + alpha_color[..., None] * (illumination - past.illumination)
    return Accumulated(
        illumination=np.where(found[..., None], blended, fresh.illumination),
        mean=np.where(found, past.mean + alpha_moments * innovation, fresh.mean),
        variance=np.where(found, (1 - alpha_moments) * (past.variance + alpha_moments * innovation**2), 0),
        length=np.where(found, length, fresh.length),
    )


def surface_weight(guides: Guides, gradient: Array, offset: Offset, step: int, settings: Settings) -> Array:
    """Section 4: w_z w_n for the tap q = p + step * offset, (H, W); 1 at the centre, 0 where p or q is a miss."""
    dx, dy = offset
    y, x, inside = shifted(offset, guides.depth.shape, step)
    hits = inside & guides.hit & guides.hit[y, x]
    if dx == dy == 0:
        return hits.astype(np.float64)
    slope = settings.sigma_depth * np.abs(gradient @ np.array(offset))
    slope += settings.depth_slope_floor * guides.depth * max(abs(dx), abs(dy))
    w_z = np.exp(-np.abs(guides.depth - guides.depth[y, x]) / (step * np.where(hits, slope, 1)))
    w_n = np.exp(settings.sigma_normal * (dot(guides.normal, guides.normal[y, x]) - 1))
    return np.where(hits, w_z * w_n, 0)


def variance(accumulated: Accumulated, guides: Guides, settings: Settings) -> Array:
    """Section 3: variance of luminance, (S, H, W), from the moments or, where history is short, from 7x7 neighbours."""
    gradient = depth_gradient(guides.depth)
    length = accumulated.length
    taps = []
    for offset in square(3):
        y, x, _ = shifted(offset, guides.depth.shape)
        w = surface_weight(guides, gradient, offset, 1, settings)
        taps.append((w, accumulated.mean[:, y, x], accumulated.variance[:, y, x]))
    total = np.where(guides.hit, sum(w for w, _, _ in taps), 1)
    mean = sum(w * m for w, m, _ in taps) / total
    pooled = sum(w * (v + (m - mean) ** 2) for w, m, v in taps) / total
    spatial = 4 / np.maximum(length, 1) * pooled
    return np.where(guides.hit, np.where(length >= 3.5, accumulated.variance, spatial), 0)


def atrous(illumination: Array, var: Array, guides: Guides, level: int, settings: Settings) -> tuple[Array, Array]:
    """Section 4: one level of the edge-avoiding a-trous wavelet filter.

    Parameters
    ----------
    illumination : (S, H, W, 3)
    var : (S, H, W), variance of the illumination's luminance.
    guides : Guides
    level : int, i; the taps lie 2^i pixels apart.

    Returns
    -------
    illumination, var : as given, filtered.
    """
    step = 2**level
    gradient = depth_gradient(guides.depth)
    luma = luminance(illumination)
    tolerance = settings.sigma_luminance * np.sqrt(smoothed(var, guides.hit)) + 1e-3 * luma + 1e-12
    color, squares, total = np.zeros_like(illumination), np.zeros_like(var), np.zeros_like(var)
    spline = SPLINES[settings.radius]
    for dx, dy in square(settings.radius):
        y, x, _ = shifted((dx, dy), guides.depth.shape, step)
        w_l = np.exp(-np.abs(luma - luma[:, y, x]) / tolerance)
        w = spline[dx] * spline[dy] * surface_weight(guides, gradient, (dx, dy), step, settings) * w_l
        color += w[..., None] * illumination[:, y, x]
        squares += w**2 * var[:, y, x]
        total += w
    total = np.where(guides.hit, total, 1)
    return (
        np.where(guides.hit[..., None], color / total[..., None], illumination),
        np.where(guides.hit, squares / total**2, var),
    )


def modulate(illumination: Array, guides: Guides) -> Array:
    """Section 5: out = sum over signals of c * albedo' + emission', (H, W, 3)."""
    # Emission is added once, whatever the number of signals.
    image: Array = illumination.sum(axis=0) * guides.albedo + guides.emission
    return image


def foremost(guides: Guides) -> tuple[Indices, Indices]:
    """Section 6: rows and columns, each (H, W), of the nearest hit among each pixel and its eight neighbours."""
    here = np.indices(guides.depth.shape, dtype=np.int64)
    rows: Indices = here[0]
    columns: Indices = here[1]
    nearest = np.where(guides.hit, guides.depth, np.inf)
    for offset in square(1):
        y, x, inside = shifted(offset, guides.depth.shape)
        nearer = inside & guides.hit[y, x] & (guides.depth[y, x] < NEARER * nearest)
        nearest = np.where(nearer, guides.depth[y, x], nearest)
        rows, columns = np.where(nearer, y, rows), np.where(nearer, x, columns)
    return rows, columns


def taa(image: Array, guides: Guides, length: Array, history: Array | None, settings: Settings) -> tuple[Array, Array]:
    """Section 6: temporal antialiasing with a neighbourhood-clamped history.

    Parameters
    ----------
    image : (H, W, 3), linear HDR.
    guides : Guides
    length : (H, W), N, of `Accumulated`.
    history : (H, W, 3), tone-mapped YCoCg, or None on the first frame.

    Returns
    -------
    image : (H, W, 3), linear HDR.
    history : (H, W, 3), for the next frame.
    """
    shape = guides.depth.shape
    current = image @ YCOCG_OF_RGB.T
    current = current / (1 + current[..., :1])
    result = current
    if history is not None:
        front = foremost(guides)
        position = reprojected(guides.motion[front])
        x, y, weight = catmull_rom_taps(position)
        rows, columns, _ = locate(x, y, shape)
        past = np.einsum("thw,thwc->hwc", weight, history[rows, columns])
        around = np.stack([current[shifted(offset, shape)[:2]] for offset in square(1)])
        past = np.clip(past, around.min(axis=0), around.max(axis=0))
        inside = ((position >= -0.5) & (position < np.array(shape[::-1]) - 0.5)).all(axis=-1, keepdims=True)
        alpha = np.maximum(settings.alpha_taa, np.where(length[front] > 0, 1 / np.maximum(length[front], 1), 0))
        result = np.where(inside, past + alpha[..., None] * (current - past), current)
    color = result @ RGB_OF_YCOCG.T
    return np.maximum(color / np.maximum(1 - result[..., :1], 1e-6), 0), result


class Reference:
    """The whole pipeline over a sequence, as the `Denoiser` runs it on a device.

    Parameters
    ----------
    shape : (height, width)
    settings : Settings

    Attributes
    ----------
    guides : Guides of the last frame.
    history, antialiased : what the next frame will read, or None (`temporal`'s and `taa`'s history).
    stages : every intermediate result of the last frame, named and shaped as by `Denoiser.stage`.
    """

    guides: Guides

    def __init__(self, shape: Shape, settings: Settings | None = None) -> None:
        self.shape = shape
        self.settings = settings or Settings()
        self.stages: dict[str, Array] = {}
        self.reset()

    def reset(self) -> None:
        """Forget the past: the next frame is a first frame."""
        self.history: History | None = None
        self.antialiased: Array | None = None

    def denoise(self, frame: Frame) -> Array:
        """Filter the next frame of the sequence: (H, W, 3), linear HDR."""
        frame.check(self.shape)
        settings = self.settings
        illumination, guides = demodulate(frame, self.settings)
        self.guides = guides
        stages = self.stages = {"demodulated": illumination}

        accumulated = temporal(illumination, guides, self.history, settings)
        illumination, var = accumulated.illumination, variance(accumulated, guides, settings)
        stages.update(accumulated=illumination, mean=accumulated.mean, moment_variance=accumulated.variance)
        stages.update(history_length=accumulated.length, variance=var)

        for level in range(settings.iterations):
            illumination, var = atrous(illumination, var, guides, level, settings)
            stages.update({f"level_{level + 1}": illumination, f"level_{level + 1}_variance": var})
        self.history = History(guides, replace(accumulated, illumination=stages["level_1"]))

        image = stages["modulated"] = modulate(illumination, guides)
        if settings.taa:
            image, self.antialiased = taa(image, guides, accumulated.length, self.antialiased, settings)
            stages["antialiased"] = self.antialiased
        return image

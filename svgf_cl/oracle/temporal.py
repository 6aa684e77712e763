"""Float64 oracle of the temporal filters: docs/algorithm.md in NumPy, one function for each kernel.

Arrays have the shape of the image: planes are (H, W), pictures (H, W, 3). An array with one entry for each signal has a
leading axis S. The symbols in the docstrings (p, q, c, V, M, N, g, w, h) and the section numbers are those of
docs/algorithm.md.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import Frame, Shape
from svgf_cl.oracle.albedo import Codes, albedo_codes, alike, divisor
from svgf_cl.oracle.taps import (
    Array,
    Indices,
    Mask,
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
    square,
)

CHANNEL_MAX = 1e10
DEPTH_RANGE = (1e-20, 1e20)
NORMAL_FLOOR = 1e-12  # the least square of a normal's length
# By whether light is stored as 16-bit floats.
ILLUMINATION_MAX = {False: 5e11, True: 65504.0}
MOTION_MAX = 1e6
NO_HISTORY = (-MOTION_MAX, -MOTION_MAX, 0.0)
NEARER = float(np.float32(0.9999))
HISTORY_WEIGHT = 0.01  # the least sum of the weights of the bilinear taps that is a history
OTHERS_WEIGHT = 1 / 64  # factor for a tap of another albedo
LENGTH_MAX = {False: 1024, True: 32}
YCOCG_OF_RGB = np.array(((1 / 4, 1 / 2, 1 / 4), (1 / 2, 0, -1 / 2), (-1 / 4, 1 / 2, -1 / 4)))
RGB_OF_YCOCG = np.array(((1, 1, -1), (1, 0, 1), (1, -1, -1)))


@dataclass(frozen=True, eq=False)
class Guides:
    """The noise-free fields of a frame, after `demodulate` has replaced invalid values.

    Parameters
    ----------
    normal : (H, W, 3), unit; 0 at a miss.
    depth : (H, W), > 0; 0 at a miss.
    motion : (H, W, 3), previous minus current x, y and depth.
    id : (H, W) integers, or None if the frame has none.
    albedo : (H, W, 3), 0..1, or None if light is not divided by it.
    emission : (H, W, 3), not negative.
    """

    normal: Array
    depth: Array
    motion: Array
    id: NDArray[np.integer] | None
    albedo: Array | None
    emission: Array

    @property
    def divisor(self) -> Array:
        """albedo', by which light is divided: (H, W, 3), or 1 if there is no albedo."""
        return np.ones(1) if self.albedo is None else divisor(self.albedo)

    @cached_property
    def codes(self) -> Codes | None:
        """The codes of albedo, which tell whether two are alike: (H, W, 3)."""
        return None if self.albedo is None else albedo_codes(self.albedo)

    @cached_property
    def hit(self) -> Mask:
        """Whether each pixel is a hit, (H, W)."""
        return self.depth > 0


@dataclass(frozen=True, eq=False)
class Accumulated:
    """The accumulated values of each pixel.

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
    """The previous frame: its guides, and its accumulated values with the colour history c_h as illumination."""

    guides: Guides
    accumulated: Accumulated


def demodulate(frame: Frame, *, half: bool = False) -> tuple[Array, Guides]:
    """Section 1: replace invalid input, then divide light by albedo.

    Parameters
    ----------
    frame : Frame of numpy arrays.
    half : bool
        Whether light is stored in 16 bits, which limits its brightness.

    Returns
    -------
    illumination : (S, H, W, 3), c; S is 2 with direct and indirect, otherwise 1.
    guides : Guides
    """
    given = {name: np.asarray(value, np.float64) for name, value in frame.present().items() if name != "id"}
    albedo = given.get("albedo")
    if albedo is not None:
        albedo = np.where(np.isnan(albedo), 1, np.clip(albedo, 0, 1))
    emission = given.get("emission", np.zeros((*frame.shape, 3)))
    emission = np.maximum(known(emission), 0)
    normal, depth = safe_surface(given["normal"], given["depth"])
    guides = Guides(normal, depth, safe_motion(given["motion"]), frame.id, albedo, emission)

    split = "direct" in given
    reflected = [known(given[name]) for name in ("direct", "indirect")] if split else [known(given["color"]) - emission]
    return np.clip(np.stack(reflected) / guides.divisor, 0, ILLUMINATION_MAX[half]), guides


def known(color: Array) -> Array:
    """Section 1: a radiance or normal, (..., 3); 0 if any channel is NaN or beyond 1e10."""
    return np.where((np.abs(color) <= CHANNEL_MAX).all(axis=-1, keepdims=True), color, 0)


def safe_surface(normal: Array, depth: Array) -> tuple[Array, Array]:
    """Section 1: unit normal (H, W, 3) and depth (H, W); both are 0 at a miss."""
    normal = known(normal)
    squared = dot(normal, normal)
    nearest, farthest = DEPTH_RANGE
    hit = (depth > nearest) & (depth < farthest) & (squared > NORMAL_FLOOR)
    length = np.sqrt(np.where(hit, squared, 1))
    return np.where(hit[..., None], normal / length[..., None], 0), np.where(hit, depth, 0)


def safe_motion(motion: Array) -> Array:
    """Section 2: (H, W, 2) or (H, W, 3) to (H, W, 3), clamped; if it is not finite, it leads far outside the image."""
    if motion.shape[-1] == 2:
        motion = np.concatenate((motion, np.zeros_like(motion[..., :1])), axis=-1)
    bound = np.array((MOTION_MAX, MOTION_MAX, np.inf))
    good = finite(motion) & (np.abs(motion[..., 2:]) <= DEPTH_RANGE[1])
    return np.where(good, np.clip(motion, -bound, bound), NO_HISTORY)


def consistent(x: Indices, y: Indices, guides: Guides, previous: Guides, settings: TemporalFilter) -> Mask:
    """Section 2: whether the previous frame's taps (x, y), each (T, H, W), show the same surface as the pixel."""
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


@dataclass(frozen=True, eq=False)
class Footprint:
    """The pixels of the previous frame that show the same surface as each pixel.

    Parameters
    ----------
    rows, columns : (T, H, W), of T taps.
    weight : (T, H, W), adds up to 1, or to 0 if no tap is found.
    found : (H, W)
    """

    rows: Indices
    columns: Indices
    weight: Array
    found: Mask

    def taps(self, values: Array) -> Array:
        """The previous frame's values, (S, H, W[, 3]), at the taps: (S, T, H, W[, 3])."""
        return values[:, self.rows, self.columns]

    def mean(self, taps: Array) -> Array:
        """The weighted mean over the taps, (S, T, H, W[, 3]): (S, H, W[, 3])."""
        mean: Array = np.einsum("thw,sthw...->shw...", self.weight, taps)
        return mean


def footprint(guides: Guides, previous: Guides, settings: TemporalFilter) -> Footprint:
    """Section 2: the consistent taps."""
    position = reprojected(guides.motion)

    # 13 candidates: the four bilinear taps, and the nearest nine, which are used if the weight of those four is too
    # small.
    x, y, b = (np.concatenate(pair) for pair in zip(bilinear_taps(position), nearest_taps(position), strict=True))
    b *= consistent(x, y, guides, previous, settings)
    rows, columns, _ = locate(x, y, guides.depth.shape)
    if guides.codes is not None and previous.codes is not None:
        b *= np.where(alike(guides.codes, previous.codes[rows, columns], settings.albedo_threshold), 1, OTHERS_WEIGHT)
    enough = b[:4].sum(axis=0) > HISTORY_WEIGHT
    b[:4] *= enough
    b[4:] *= ~enough
    found = b.sum(axis=0) > 0
    return Footprint(rows, columns, b / np.where(found, b.sum(axis=0), 1), found)


def reproject(guides: Guides, history: History, settings: TemporalFilter) -> tuple[Accumulated, Mask]:
    """Section 2: the mean of the history over the consistent taps, and whether there is any, (H, W)."""
    around = footprint(guides, history.guides, settings)
    past = history.accumulated
    mean = around.mean(around.taps(past.mean))
    deviation = around.taps(past.mean) - mean[:, None]
    return Accumulated(
        illumination=around.mean(around.taps(past.illumination)),
        mean=mean,
        variance=around.mean(around.taps(past.variance) + deviation**2),
        length=around.mean(around.taps(past.length[None]))[0],
    ), around.found


def temporal(
    illumination: Array, guides: Guides, history: History | None, settings: TemporalFilter, alpha_moments: float
) -> Accumulated:
    """Section 2: blend the new samples into the reprojected history.

    Parameters
    ----------
    illumination : (S, H, W, 3), demodulated light of this frame.
    guides : Guides, this frame's.
    history : History, or None on the first frame.
    settings : TemporalFilter
    alpha_moments : float
        Smallest share of the new frame in the moments.
    """
    sample = luminance(illumination)
    fresh = Accumulated(illumination, sample, np.zeros_like(sample), guides.hit.astype(np.float64))
    if history is None:
        return fresh
    past, found = reproject(guides, history, settings)
    length = np.minimum(past.length + 1, LENGTH_MAX[settings.half_history])
    alpha_color = np.maximum(1 / length, settings.alpha_color)
    share_of_moments = np.maximum(1 / length, alpha_moments)
    innovation = sample - past.mean
    blended = past.illumination + alpha_color[..., None] * (illumination - past.illumination)
    return Accumulated(
        illumination=np.where(found[..., None], blended, fresh.illumination),
        mean=np.where(found, past.mean + share_of_moments * innovation, fresh.mean),
        variance=np.where(found, (1 - share_of_moments) * (past.variance + share_of_moments * innovation**2), 0),
        length=np.where(found, length, fresh.length),
    )


def modulate(illumination: Array, guides: Guides) -> Array:
    """Section 5: out = sum over signals of c * albedo' + emission', (H, W, 3); green is at least 0."""
    # Emission is added once, whatever the number of signals.
    image: Array = np.maximum(illumination.sum(axis=0), (-np.inf, 0, -np.inf)) * guides.divisor + guides.emission
    return image


def foremost(guides: Guides) -> tuple[Indices, Indices]:
    """Section 6: row and column, each (H, W), of the nearest hit among each pixel and its eight neighbours."""
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


def pixel_filtered(image: Array, share: float) -> Array:
    """Section 6: n, the weighted mean over the 3x3 neighbourhood inside the image, (H, W, 3)."""
    kernel = {-1: share, 0: 1 - 2 * share, 1: share}
    total, weights = np.zeros_like(image), np.zeros(image.shape[:2])
    for dx, dy in square(1):
        y, x, inside = shifted((dx, dy), image.shape[:2])
        weight = kernel[dx] * kernel[dy] * inside
        total += weight[..., None] * image[y, x]
        weights += weight
    return total / weights[..., None]


def taa(
    image: Array, guides: Guides, length: Array, history: Array | None, settings: TemporalFilter
) -> tuple[Array, Array]:
    """Section 6: temporal antialiasing; the history is clamped to the neighbourhood.

    Parameters
    ----------
    image : (H, W, 3), linear HDR.
    guides : Guides
    length : (H, W), N, of `Accumulated`.
    history : (H, W, 3), YCoCg, or None on the first frame.

    Returns
    -------
    image : (H, W, 3), linear HDR.
    history : (H, W, 3), for the next frame.
    """
    shape = guides.depth.shape
    current = image @ YCOCG_OF_RGB.T
    result = filtered = pixel_filtered(current, settings.pixel_filter)
    if history is not None:
        front = foremost(guides)
        position = reprojected(guides.motion[front])
        x, y, weight = catmull_rom_taps(position)
        rows, columns, inside = locate(x, y, shape)
        weight *= inside
        seen: Mask = np.all((position >= -0.5) & (position < np.array(shape[::-1]) - 0.5), axis=-1)
        past = np.einsum("thw,thwc->hwc", weight / np.where(seen, weight.sum(axis=0), 1), history[rows, columns])
        around = np.stack([current[shifted(offset, shape)[:2]] for offset in square(1)])
        past = np.clip(past, around.min(axis=0), around.max(axis=0))
        longest = np.max([length[shifted(offset, shape)[:2]] for offset in square(1)], axis=0)
        alpha = np.maximum(settings.alpha_taa, np.where(longest > 0, 1 / np.maximum(longest, 1), 0))
        result = np.where(seen[..., None], past + alpha[..., None] * (filtered - past), filtered)
    return np.maximum(result @ RGB_OF_YCOCG.T, 0), result


Stages = Mapping[str, Array]
# The name of a kernel, and the stages that it makes, by the names that `Denoiser.stage` has for them.
Made = tuple[str, dict[str, Array]]
Chosen = TypeVar("Chosen", bound=TemporalFilter)


@dataclass(frozen=True, eq=False)
class Past:
    """The previous frame: its guides, and its stages."""

    guides: Guides
    stages: Stages


class FilterOracle(ABC, Generic[Chosen]):
    """A complete filter over a sequence, as `Denoiser` runs it on a device.

    Parameters
    ----------
    shape : (height, width)
    settings : TemporalFilter

    Attributes
    ----------
    past : Past, or None before the first frame
        The last frame, which the next one reads.
    stages : dict of str to array
        Every intermediate result of the last frame, with names and shapes as from `Denoiser.stage`.
    """

    def __init__(self, shape: Shape, settings: Chosen) -> None:
        self.shape: Shape = shape
        self.settings: Chosen = settings
        self.stages: dict[str, Array] = {}
        self.past: Past | None = None

    def reset(self) -> None:
        """Discard the history: the next frame is a first frame."""
        self.past = None

    def denoise(self, frame: Frame) -> Array:
        """Filter the next frame of the sequence: (H, W, 3), linear HDR."""
        frame.check(self.shape)
        now: dict[str, Array] = {}
        for _, made in self.kernels(frame, now, self.past):
            now.update(made)
        self.past = Past(seen_guides(frame, now), now)
        self.stages = {name: values for name, values in now.items() if name != "out"}
        return now["out"]

    def kernels(self, frame: Frame, now: Stages, past: Past | None) -> Iterator[Made]:
        """Yield the result of each kernel for a frame, in order.

        Parameters
        ----------
        frame : Frame of numpy arrays.
        now : mapping of str to array
            The stages of the frame that kernels read: those that this yields, or those of a device.
        past : Past, or None for a first frame.
        """
        settings = self.settings
        illumination, exact = demodulate(frame, half=settings.half_history)
        yield "demodulate", {"normal": exact.normal, "depth": exact.depth, "demodulated": illumination}

        guides = seen_guides(frame, now)
        filtered = yield from self.filtered(now, guides, past)
        image = modulate(now[filtered], guides)
        if not settings.taa:
            yield "modulate", {"out": image}
            return
        yield "modulate", {"modulated": image}
        before = past.stages["antialiased"] if past else None
        resolved, antialiased = taa(now["modulated"], guides, self.length(now), before, settings)
        yield "taa", {"antialiased": antialiased, "out": resolved}

    @abstractmethod
    def length(self, now: Stages) -> Array:
        """N, the length of the history in frames, as antialiasing reads it: (H, W)."""

    @abstractmethod
    def filtered(self, now: Stages, guides: Guides, past: Past | None) -> Generator[Made, None, str]:
        """Yield the results of the kernels between demodulate and modulate; return the last stage."""


class TemporalOracle(FilterOracle[Chosen]):
    """A filter that accumulates over time as in section 2."""

    history: ClassVar[str]  # the stage that is the colour history of the next frame

    def length(self, now: Stages) -> Array:
        """The length that the temporal pass counted."""
        return now["history_length"]

    def filtered(self, now: Stages, guides: Guides, past: Past | None) -> Generator[Made, None, str]:
        """Yield the accumulation, then the spatial part."""
        history = History(past.guides, accumulated(past.stages, past.stages[self.history])) if past else None
        made = temporal(now["demodulated"], guides, history, self.settings, self.alpha_moments)
        yield (
            "temporal",
            {
                "accumulated": made.illumination,
                "history_length": made.length,
                "mean": made.mean,
                "moment_variance": made.variance,
            },
        )
        return (yield from self.spatial(now, guides))

    @property
    def alpha_moments(self) -> float:
        """Smallest share of a new frame in the moments.

        The same as for colour, unless a filter has a setting for it.
        """
        return self.settings.alpha_color

    @abstractmethod
    def spatial(self, now: Stages, guides: Guides) -> Generator[Made, None, str]:
        """Yield the results of the kernels between temporal and modulate; return the last stage."""


def seen_guides(frame: Frame, now: Stages) -> Guides:
    """The guides of a frame, with depth and normal as a device has stored them."""
    _, exact = demodulate(frame)
    return replace(exact, normal=now["normal"], depth=now["depth"])


def accumulated(stages: Stages, illumination: Array) -> Accumulated:
    """The accumulated values, taken from the stages of a frame."""
    return Accumulated(illumination, stages["mean"], stages["moment_variance"], stages["history_length"])

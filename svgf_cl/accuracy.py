"""How far each kernel is from the oracle, when both are given the very same float32 inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from svgf_cl import reference
from svgf_cl.denoiser import Denoiser
from svgf_cl.frame import Frame
from svgf_cl.settings import Settings

Single = NDArray[np.float32]
Array = NDArray[np.float64]

# An error counts against the value plus this share of the stage's mean: a relative error where there is something to be
# relative to, an absolute one near zero. Of a colour, the value is the greatest of its channels: kernels keep luminance
# in place of green, and a green that hardly contributes to it cannot be known as well.
SCALE_SHARE = 1e-3
# A pixel further off than this was decided otherwise (a tap accepted or refused within rounding of a threshold).
DECISION = 1e-3


@dataclass(frozen=True)
class Deviation:
    """Errors of one stage over all pixels of all frames, relative as described at `SCALE_SHARE`.

    Parameters
    ----------
    stage : str
        Name as in `Denoiser.stages`; "out" for the result.
    largest, typical : float
        Greatest and median error over the pixels decided alike.
    decided_otherwise : float
        Share of pixels beyond `DECISION`.
    pixels : int
        How many values were compared.
    """

    stage: str
    largest: float
    typical: float
    decided_otherwise: float
    pixels: int


def deviations(
    frames: Iterable[Frame], settings: Settings | None = None, queue: cl.CommandQueue | None = None
) -> dict[str, Deviation]:
    """Denoise a sequence on the device and hold every kernel, one at a time, against the oracle.

    Parameters
    ----------
    frames : iterable of Frame
        All of one size, numpy arrays.
    settings : Settings, optional
    queue : pyopencl.CommandQueue, optional

    Returns
    -------
    dict of str to Deviation
        By stage, in the order of the pipeline.
    """
    settings = settings or Settings()
    errors: dict[str, list[Array]] = {}
    den: Denoiser | None = None
    past: dict[str, Single] = {}
    guides: reference.Guides | None = None
    for frame in frames:
        den = den or Denoiser(frame.shape, settings=settings, queue=queue, keep_stages=True)
        out = den.denoise(frame)
        now = {name: den.stage(name) for name in den.stages} | {"out": out}
        previous = None if guides is None else History(guides, past)
        guides = seen_guides(frame, now)
        for stage, expected in oracle_stages(frame, guides, now, previous, settings):
            size = largest_channel(expected) if expected.shape[-3:] == (*frame.shape, 3) else np.abs(expected)
            errors.setdefault(stage, []).append(relative_error(now[stage], expected, size).ravel())
        past = now
    return {stage: summary(stage, np.concatenate(parts)) for stage, parts in errors.items()}


@dataclass(frozen=True)
class History:
    """Guides and stages of the previous frame, as the device has them."""

    guides: reference.Guides
    stages: dict[str, Single]

    def accumulated(self) -> reference.History:
        """What `temporal` reads."""
        stages = self.stages
        return reference.History(self.guides, accumulated(stages, illumination=stages["level_1"]))


def seen_guides(frame: Frame, now: dict[str, Single]) -> reference.Guides:
    """The oracle's guides with normal and depth as the device rounded them."""
    _, guides = reference.demodulate(frame)
    return replace(guides, normal=wide(now["normal"]), depth=wide(now["depth"]))


def oracle_stages(
    frame: Frame, guides: reference.Guides, now: dict[str, Single], previous: History | None, settings: Settings
) -> Iterator[tuple[str, Array]]:
    """What the oracle makes of each kernel's actual input, stage by stage."""
    illumination, exact = reference.demodulate(frame, settings)
    yield "normal", exact.normal
    yield "depth", exact.depth
    yield "demodulated", illumination

    history = previous.accumulated() if previous else None
    temporal = reference.temporal(wide(now["demodulated"]), guides, history, settings)
    yield "accumulated", temporal.illumination
    yield "history_length", temporal.length
    yield "mean", temporal.mean
    yield "moment_variance", temporal.variance
    yield "variance", reference.variance(accumulated(now, now["accumulated"]), guides, settings)

    source = "accumulated", "variance"
    for level in range(settings.iterations):
        target = f"level_{level + 1}", f"level_{level + 1}_variance"
        filtered = reference.atrous(wide(now[source[0]]), wide(now[source[1]]), guides, level, settings)
        yield from zip(target, filtered, strict=True)
        source = target

    image = reference.modulate(wide(now[source[0]]), guides)
    if not settings.taa:
        yield "out", image
        return
    yield "modulated", image
    antialiased = wide(previous.stages["antialiased"]) if previous else None
    resolved, tone = reference.taa(wide(now["modulated"]), guides, wide(now["history_length"]), antialiased, settings)
    yield "antialiased", tone
    yield "out", resolved


def accumulated(stages: dict[str, Single], illumination: Single) -> reference.Accumulated:
    """The device's accumulated quantities, as the oracle takes them."""
    return reference.Accumulated(
        wide(illumination), wide(stages["mean"]), wide(stages["moment_variance"]), wide(stages["history_length"])
    )


def wide(values: Single) -> Array:
    """float32 to float64."""
    return values.astype(np.float64)


def largest_channel(colors: Array) -> Array:
    """The greatest |channel| of each colour: (..., 3) to (..., 1)."""
    largest: Array = np.abs(colors).max(axis=-1, keepdims=True)
    return largest


def relative_error(got: Single, expected: Array, size: Array | None = None) -> Array:
    """|got - expected| / (size + `SCALE_SHARE` of its mean), of the same shape; the size is |expected| if not given."""
    size = np.abs(expected) if size is None else size
    scale = SCALE_SHARE * size.mean() or 1.0
    error: Array = np.abs(got - expected) / (size + scale)
    return error


def summary(stage: str, errors: Array) -> Deviation:
    """Condense the errors of all pixels."""
    alike = errors[errors <= DECISION]
    return Deviation(
        stage,
        largest=float(alike.max(initial=0.0)),
        typical=float(np.median(errors)),
        decided_otherwise=float(np.mean(~(errors <= DECISION))),
        pixels=errors.size,
    )

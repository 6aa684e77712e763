"""How far each kernel is from the oracle, when both are given the very same float32 inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from svgf_cl.denoiser import Denoiser
from svgf_cl.frame import Frame
from svgf_cl.oracle import svgf as reference
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
    """How far one stage is off the oracle, over all pixels of all frames.

    Parameters
    ----------
    kernel : str
        Whose work the stage is.
    absolute : float
        Largest error of the pixels decided alike, in the stage's own unit.
    relative : float
        The largest as described at `SCALE_SHARE`.
    ulps : float
        The largest in units in the last place of what the relative error counts against, as float32.
    decided_otherwise : float
        Share of pixels whose relative error is beyond `DECISION`.
    """

    kernel: str
    absolute: float
    relative: float
    ulps: float
    decided_otherwise: float

    @classmethod
    def of(cls, kernel: str, error: Array, size: Array) -> Deviation:
        """Condense |got - expected| of all pixels; `size` is what the relative error counts against, of like shape."""
        alike = error / size <= DECISION
        absolute, relative, ulps = (
            float((error / unit).max(where=alike, initial=0.0))
            for unit in (1.0, size, np.spacing(size.astype(np.float32)))
        )
        return cls(kernel, absolute, relative, ulps, decided_otherwise=float(np.mean(~alike)))


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
        By stage, in the order of the pipeline; "out" is the result.
    """
    settings = settings or Settings()
    found: dict[str, list[Deviation]] = {}
    den: Denoiser | None = None
    past: dict[str, Single] = {}
    guides: reference.Guides | None = None
    for frame in frames:
        den = den or Denoiser(frame.shape, settings=settings, queue=queue, keep_stages=True)
        out = den.denoise(frame)
        now = {name: den.stage(name) for name in den.stages} | {"out": out}
        previous = None if guides is None else History(guides, past)
        guides = seen_guides(frame, now)
        for kernel, stages in oracle_stages(frame, guides, now, previous, settings):
            for stage, expected in stages.items():
                colour = expected.shape[-3:] == (*frame.shape, 3)
                size = counted_against(largest_channel(expected) if colour else np.abs(expected))
                error = np.abs(now[stage] - expected)
                found.setdefault(stage, []).append(Deviation.of(kernel, error, np.broadcast_to(size, error.shape)))
        past = now
    return {stage: worst(frame_by_frame) for stage, frame_by_frame in found.items()}


def worst(found: Sequence[Deviation]) -> Deviation:
    """The largest errors of a kernel's stages or frames, and the mean share of pixels that were decided otherwise."""
    return Deviation(
        found[0].kernel,
        absolute=max(deviation.absolute for deviation in found),
        relative=max(deviation.relative for deviation in found),
        ulps=max(deviation.ulps for deviation in found),
        decided_otherwise=float(np.mean([deviation.decided_otherwise for deviation in found])),
    )


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
) -> Iterator[tuple[str, dict[str, Array]]]:
    """What the oracle makes of each kernel's actual input: kernel by kernel, stage by stage."""
    illumination, exact = reference.demodulate(frame, settings)
    yield "demodulate", {"normal": exact.normal, "depth": exact.depth, "demodulated": illumination}

    history = previous.accumulated() if previous else None
    temporal = reference.temporal(wide(now["demodulated"]), guides, history, settings)
    yield (
        "temporal",
        {
            "accumulated": temporal.illumination,
            "history_length": temporal.length,
            "mean": temporal.mean,
            "moment_variance": temporal.variance,
        },
    )
    yield "variance", {"variance": reference.variance(accumulated(now, now["accumulated"]), guides, settings)}

    source = "accumulated", "variance"
    for level in range(settings.iterations):
        target = f"level_{level + 1}", f"level_{level + 1}_variance"
        filtered = reference.atrous(wide(now[source[0]]), wide(now[source[1]]), guides, level, settings)
        yield "atrous", dict(zip(target, filtered, strict=True))
        source = target

    image = reference.modulate(wide(now[source[0]]), guides)
    if not settings.taa:
        yield "modulate", {"out": image}
        return
    yield "modulate", {"modulated": image}
    antialiased = wide(previous.stages["antialiased"]) if previous else None
    resolved, tone = reference.taa(wide(now["modulated"]), guides, wide(now["history_length"]), antialiased, settings)
    yield "taa", {"antialiased": tone, "out": resolved}


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


def counted_against(size: Array) -> Array:
    """What an error is relative to: the size of a value, and `SCALE_SHARE` of the mean size; never 0."""
    counted: Array = size + (SCALE_SHARE * size.mean() or 1.0)
    return counted


def relative_error(got: Single, expected: Array, size: Array | None = None) -> Array:
    """|got - expected| over what it counts against, of the same shape; the size is |expected| if not given."""
    error: Array = np.abs(got - expected) / counted_against(np.abs(expected) if size is None else size)
    return error

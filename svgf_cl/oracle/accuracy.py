"""The error of each kernel, compared with the oracle, if both get exactly the same float32 input."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from svgf_cl.denoiser import Denoiser
from svgf_cl.filters import Settings
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.frame import Frame
from svgf_cl.oracle import oracle_of
from svgf_cl.oracle.rounding import counted_against, largest_channel
from svgf_cl.oracle.taps import Array
from svgf_cl.oracle.temporal import Past, seen_guides

Single = NDArray[np.float32]

# A pixel with a larger error was decided differently: a tap was accepted or refused because of rounding.
DECISION = 1e-3


@dataclass(frozen=True)
class Deviation:
    """The error of one stage compared with the oracle, over all pixels of all frames.

    Parameters
    ----------
    kernel : str
        The kernel that makes the stage.
    absolute : float
        Largest error of the pixels that were decided alike, in the unit of the stage.
    relative : float
        Largest relative error, as `svgf_cl.oracle.rounding.SCALE_SHARE` describes it.
    ulps : float
        Largest error in units in the last place of the relative error's denominator, as float32.
    decided_otherwise : float
        Share of pixels with a relative error above `DECISION`.
    """

    kernel: str
    absolute: float
    relative: float
    ulps: float
    decided_otherwise: float

    @classmethod
    def of(cls, kernel: str, error: Array, size: Array) -> Deviation:
        """Summarise |got - expected| of all pixels.

        `size`, of the same shape, is the denominator of the relative error.
        """
        alike = error / size <= DECISION
        absolute, relative, ulps = (
            float((error / unit).max(where=alike, initial=0.0))
            for unit in (1.0, size, np.spacing(size.astype(np.float32)))
        )
        return cls(kernel, absolute, relative, ulps, decided_otherwise=float(np.mean(~alike)))


def deviations(
    frames: Iterable[Frame], settings: Filter | None = None, queue: cl.CommandQueue | None = None
) -> dict[str, Deviation]:
    """Denoise a sequence on the device, and compare every kernel, one at a time, with the oracle.

    Parameters
    ----------
    frames : iterable of Frame
        Frames of one size, of numpy arrays.
    settings : Filter, optional
    queue : pyopencl.CommandQueue, optional

    Returns
    -------
    dict of str to Deviation
        By stage, in the order of the pipeline; "out" is the result.
    """
    settings = settings or Settings()
    found: dict[str, list[Deviation]] = {}
    den: Denoiser | None = None
    past: Past | None = None
    for frame in frames:
        den = den or Denoiser(frame.shape, settings=settings, queue=queue, keep_stages=True)
        out = den.denoise(frame)
        now = {name: wide(values) for name, values in stages_of(den).items()} | {"out": wide(out)}
        shown = settings.pipeline(Inputs.of(frame)).shown()
        colours = {"out"} | {name for name, _, quantity in shown if quantity.channels == 3}
        for kernel, made in oracle_of(settings, frame.shape).kernels(frame, now, past):
            for stage, expected in made.items():
                size = largest_channel(expected) if stage in colours else np.abs(expected)
                if (expected < 0).any():  # a difference: add the mean, because its terms may be much larger than itself
                    size = size + size.mean()
                size = counted_against(size)
                error = np.abs(now[stage] - expected)
                found.setdefault(stage, []).append(Deviation.of(kernel, error, np.broadcast_to(size, error.shape)))
        past = Past(seen_guides(frame, now), now)
    return {stage: worst(frame_by_frame) for stage, frame_by_frame in found.items()}


def stages_of(den: Denoiser) -> dict[str, Single]:
    """All stages of a denoiser's last frame."""
    return {name: den.stage(name) for name in den.stages}


def worst(found: Sequence[Deviation]) -> Deviation:
    """The largest errors over several stages or frames of a kernel, and the mean of `decided_otherwise`."""
    return Deviation(
        found[0].kernel,
        absolute=max(deviation.absolute for deviation in found),
        relative=max(deviation.relative for deviation in found),
        ulps=max(deviation.ulps for deviation in found),
        decided_otherwise=float(np.mean([deviation.decided_otherwise for deviation in found])),
    )


def wide(values: Single) -> Array:
    """Convert float32 to float64."""
    return values.astype(np.float64)

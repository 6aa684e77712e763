"""Samples for training LBF: accumulated noisy frames, the statistics of its network, and references."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import svgf_cl_tracer
from benchmarks.training.gradient import Surroundings
from svgf_cl import Denoiser, Frame, Lbf
from svgf_cl.oracle.albedo import albedo_codes, divisor
from svgf_cl.oracle.bilateral import Deviations
from svgf_cl.oracle.lbf import statistics
from svgf_cl.oracle.spatial import luminance_tolerance
from svgf_cl.oracle.taps import Array, luminance, smoothed
from svgf_cl.oracle.temporal import Guides, demodulate
from svgf_cl_tracer.references import chunks

JUDGED = (1, 4, 9)  # frames with a truth: with a short history, a longer one, and nearly the longest
FRAMES = JUDGED[-1] + 1


@dataclass(frozen=True, eq=False)
class Sample:
    """One frame of a shot.

    Parameters
    ----------
    light, truth : (H, W, 3)
        Accumulated light without albedo, and its truth.
    noise : (H, W)
        Variance of luminance.
    seen : (H, W, INPUTS)
        Statistics.
    guides : Guides
    """

    light: Array
    truth: Array
    noise: Array
    seen: Array
    guides: Guides


@dataclass(frozen=True)
class Shots:
    """Scenes as shots, and the quality of their truths.

    Parameters
    ----------
    shape : (int, int)
    spp : int
        Samples per pixel of a truth. Its noise does not matter for training, because it is independent of the frames'
        noise.
    """

    shape: tuple[int, int]
    spp: int

    def chunks(self, count: int) -> int:
        """The number of times that `samples` calls `advance` for `count` scenes."""
        return count * len(JUDGED) * chunks(self.spp)

    def samples(self, scene: svgf_cl_tracer.Scene, advance: Callable[[], None]) -> Iterator[Sample]:
        """The samples of one scene."""
        shot = svgf_cl_tracer.Shot(scene, self.shape, FRAMES)
        references = svgf_cl_tracer.References(shot, jitter=False)
        with Denoiser(self.shape, settings=Lbf(), keep_stages=True) as denoiser:
            for number in range(FRAMES):
                split = svgf_cl_tracer.render_frame(shot, number, jitter=False)
                frame = replace(split, direct=None, indirect=None)  # all light is one signal
                denoiser.denoise(frame)
                if number in JUDGED:
                    truth = references.picture(references.render(number, self.spp, advance))
                    yield sample(frame, denoiser, np.asarray(truth, np.float64))


def sample(frame: Frame, denoiser: Denoiser, truth: Array) -> Sample:
    """A sample of the frame that was denoised last."""
    light, noise, length = (
        denoiser.stage(name).astype(np.float64) for name in ("accumulated", "variance", "history_length")
    )
    _, guides = demodulate(frame)
    wanted = np.maximum(truth - np.asarray(frame.emission, np.float64), 0) / divisor(
        np.asarray(frame.albedo, np.float64)
    )
    return Sample(light[0], wanted, noise[0], statistics(light, noise, length, guides)[0], guides)


def surroundings(samples: Sequence[Sample], slope_floor: float) -> Surroundings:
    """All samples as a stack for compiled code."""
    deviations = [Deviations.of(each.guides, slope_floor) for each in samples]
    luma = [luminance(each.light) for each in samples]
    noise = [smoothed(each.noise[None], each.guides.hit)[0] for each in samples]

    def stack(planes: Sequence[Array]) -> NDArray[np.float32]:
        return np.stack(planes).astype(np.float32)

    return Surroundings(
        light=stack([each.light for each in samples]),
        luminance=stack(luma),
        sharpness=stack([1 / luminance_tolerance(1.0, *pair) for pair in zip(noise, luma, strict=True)]),
        depth=stack([each.guides.depth for each in samples]),
        depth_sharpness=stack([1 / each.depth for each in deviations]),
        normal=stack([each.guides.normal for each in samples]),
        normal_sharpness=stack([1 / each.normal**2 for each in deviations]),
        albedo=np.stack([albedo_codes(_albedo(each.guides)) for each in samples]),
    )


def _albedo(guides: Guides) -> Array:
    return np.ones((*guides.depth.shape, 3)) if guides.albedo is None else guides.albedo

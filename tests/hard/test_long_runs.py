"""Thousands of frames: what stands still converges and stays there, and what moves at random leaves nothing behind."""

from __future__ import annotations

import functools
import gc
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import psutil
import pyopencl as cl
import pyopencl.array as cl_array
import pytest
from numpy.testing import assert_allclose

from svgf_cl import Denoiser, Frame
from svgf_cl.frame import Shape
from svgf_cl.oracle.temporal import LENGTH_MAX
from tests.frames import bumpy_sequence
from tests.hard.variants import VARIANTS, Variant, on

SHAPE: Shape = (8, 16)
PIXELS = SHAPE[0] * SHAPE[1]
LIGHT, NOISE = 0.5, 0.1  # mean and standard deviation of every pixel's light in every frame
SETTLED, COUNT, EVERY = 1000, 2000, 40  # frames

LEAST_NORMAL = np.finfo(np.float32).tiny

# What is kept from frame to frame is kept in 32 bits or in 16, of one signal or two; and fast weights, which are not
# quite symmetrical, might make a picture drift.
STILL = ("precise", "precise, two signals, TAA", "fp16, two signals, TAA", "fast")
# Whichever keeps most in each storage: the levels' weights do not change what a change of light leaves.
storages = on("precise, two signals, TAA", "fp16, two signals, TAA")
# Storage in 16 bits ends far above the denormal numbers of 32, but weights of either kind come near them.
in_32_bits = on("precise, two signals, TAA", "fast, two signals, TAA")
# The host's work: one that keeps all there is to keep.
keeping_most = on("precise, two signals, TAA")


def relit(frame: Frame, light: np.ndarray) -> Frame:
    """The same surface in other light, (H, W)."""
    light = np.repeat(light[..., None].astype(np.float32), 3, axis=-1)
    if frame.direct is None:
        return replace(frame, color=light)
    return replace(frame, direct=0.75 * light, indirect=0.25 * light)


@dataclass(frozen=True, eq=False)
class Run:
    """What a noisy wall that stands still has come to.

    Parameters
    ----------
    alpha : float
        The share that a frame has in the mean once history is as long as it gets.
    rounding : float
        The most by which a value that is stored may be off, relative.
    mean, variance : (S, H, W)
        The device's moments of luminance after all frames.
    exact_mean, exact_variance : (S, H, W)
        The same in float64.
    variances : (S,)
        The device's, averaged over pixels and frames once settled, relative to the noise's.
    pictures : (T, H, W, 3)
        Some of the pictures since then.
    """

    alpha: float
    rounding: float
    mean: np.ndarray
    variance: np.ndarray
    exact_mean: np.ndarray
    exact_variance: np.ndarray
    variances: np.ndarray
    pictures: np.ndarray


@functools.cache
def still(name: str, alpha: float) -> Run:
    """Thousands of frames of the wall, with this for both alphas."""
    variant = VARIANTS[name]
    settings = replace(variant.settings, alpha_color=alpha, alpha_moments=alpha)
    shares = np.array({1: [1.0], 2: [0.75, 0.25]}[variant.signals])[:, None, None]
    longest = LENGTH_MAX[settings.half_history]
    wall = variant.wall(shape=SHAPE)
    rng = np.random.default_rng(5)
    den = Denoiser(SHAPE, settings=settings)
    mean, variance = np.zeros((2, len(shares), *SHAPE))
    pictures, variances = [], []
    for number in range(COUNT):
        light = rng.normal(LIGHT, NOISE, SHAPE).astype(np.float32)
        picture = den.denoise(relit(wall, light))
        share = max(1 / min(number + 1, longest), alpha)
        innovation = shares * light - mean
        mean = mean + share * innovation
        variance = (1 - share) * (variance + share * innovation**2)
        if number >= SETTLED and number % EVERY == 0:
            pictures.append(picture)
            variances.append(den.stage("moment_variance").mean(axis=(1, 2)))
    return Run(
        alpha=share,
        rounding=2.0**-11 if settings.half_history else 2.0**-24,
        mean=den.stage("mean"),
        variance=den.stage("moment_variance"),
        exact_mean=mean,
        exact_variance=variance,
        variances=np.mean(variances, axis=0) / (NOISE * shares[:, 0, 0]) ** 2,
        pictures=np.array(pictures),
    )


@pytest.mark.parametrize("name", STILL)
@pytest.mark.parametrize("alpha", [0.0, 0.2])
class TestStill:
    def test_moments_are_those_of_a_running_mean(self, name: str, alpha: float) -> None:
        """Each frame rounds once more and forgets a share alpha of the rounding before."""
        run = still(name, alpha)
        rounding = run.rounding / run.alpha
        assert_allclose(run.mean, run.exact_mean, rtol=rounding)
        # A mean that is off moves every difference to it.
        assert_allclose(run.variance, run.exact_variance, rtol=2 * rounding + 2 * rounding * LIGHT / NOISE)

    def test_picture_converges_and_does_not_drift(self, name: str, alpha: float) -> None:
        """To within five standard deviations of a mean over so many frames, in every pixel and over all."""
        run = still(name, alpha)
        deviation = NOISE * math.sqrt(run.alpha / (2 - run.alpha))
        rounding = LIGHT * run.rounding / run.alpha
        assert_allclose(run.pictures, LIGHT, rtol=0, atol=5 * deviation + rounding)
        overall = run.pictures.mean(axis=(1, 2, 3))
        assert_allclose(overall, LIGHT, rtol=0, atol=5 * deviation / math.sqrt(PIXELS) + rounding)

    def test_variance_is_that_of_the_noise(self, name: str, alpha: float) -> None:
        """But for what is known to be missing about a mean over few frames: V comes to 2 (1 - a) / (2 - a) of it."""
        run = still(name, alpha)
        expected = 2 * (1 - run.alpha) / (2 - run.alpha)
        samples = run.pictures[..., 0].size * min(EVERY, 2 / run.alpha)  # a variance is the mean over so many frames
        bound = 5 * math.sqrt(2 / samples) + 2 * run.rounding / run.alpha
        assert_allclose(run.variances, expected, rtol=bound)


@storages
def test_history_at_its_longest_follows_a_change_of_light(variant: Variant) -> None:
    """Of a tenth: what is left of it after so many frames, e^-3, and what rounding swallows, 1/64, are 2.1 %."""
    longest = LENGTH_MAX[variant.settings.half_history]
    den = Denoiser(SHAPE, settings=replace(variant.settings, alpha_color=0.0, alpha_moments=0.0))
    for light, count in ((LIGHT, longest), (1.1 * LIGHT, 3 * longest)):
        wall = variant.wall(light, shape=SHAPE)
        for _ in range(count):
            picture = den.denoise(wall)
    assert_allclose(picture, 1.1 * LIGHT, rtol=0.021)


def random_frames(variant: Variant, count: int) -> Iterator[Frame]:
    """Unlike each other in every field, with motion of a thousandth to a thousand pixels."""
    rng = np.random.default_rng(3)
    some = bumpy_sequence(variant.fields, count=16, shape=SHAPE)
    for number in range(count):
        motion = rng.normal(0, 10 ** rng.uniform(-3, 3), (*SHAPE, 3)).astype(np.float32)
        yield replace(some[number % len(some)], motion=motion * np.float32((1, 1, 1e-3)))


def assert_no_denormals(den: Denoiser) -> None:
    """Arithmetic on them takes many times as long. The planes as they are: `stage` works out green anew."""
    for name in ("accumulated", "history_length", "level_1", "level_2", "level_5"):  # with all that lies beside them
        values = np.abs(den.raw_stage(name))
        assert not ((values > 0) & (values < LEAST_NORMAL)).any(), name


@pytest.fixture(scope="module")
def flushing(queue: cl.CommandQueue) -> None:
    """A device to which -cl-denorms-are-zero is more than the hint that it is: to rusticl of Mesa 22 it is not."""
    source = "__kernel void halve(__global float *x) { x[0] *= 0.5f; }"
    program = cl.Program(queue.context, source).build("-cl-denorms-are-zero")
    x = cl_array.to_device(queue, np.array([LEAST_NORMAL]))
    program.halve(queue, (1,), None, x.data)
    if x.get()[0] != 0:
        pytest.skip(f"{queue.device.name} ignores -cl-denorms-are-zero")


def resident() -> int:
    """Bytes of memory that this process holds, the OpenCL devices' on a CPU among them."""
    gc.collect()
    return int(psutil.Process().memory_info().rss)


@keeping_most
def test_memory_does_not_grow_in_10000_frames_of_random_motion(variant: Variant) -> None:
    """Measured: nothing to a few pages. One event a launch that is kept, of some 200 bytes, would come to 13 MB."""
    den = variant.denoiser(SHAPE)
    for number, frame in enumerate(random_frames(variant, 10_000)):
        picture = den.denoise(frame)
        if number == 2000:
            before, planes = resident(), den.nbytes
    assert np.isfinite(picture).all()
    assert den.nbytes == planes
    assert resident() - before <= 4 * 2**20


@in_32_bits
@pytest.mark.usefixtures("flushing")
def test_random_motion_leaves_no_denormals(variant: Variant) -> None:
    den = variant.denoiser(SHAPE, keep_stages=True)
    for frame in random_frames(variant, 200):
        den.denoise(frame)
    assert_no_denormals(den)


@in_32_bits
@pytest.mark.usefixtures("flushing")
def test_light_that_goes_out_leaves_no_denormals(variant: Variant) -> None:
    """What falls to 0.8 of itself in every frame would be a denormal number after some 390 frames, for 70 more."""
    den = variant.denoiser(SHAPE, keep_stages=True)
    for frame in random_frames(variant, 8):
        den.denoise(replace(frame, motion=np.zeros_like(frame.motion)))
    dark = variant.wall(0.0, shape=SHAPE, normal=frame.normal, depth=frame.depth, id=frame.id)
    for number in range(480):
        den.denoise(dark)
        if number >= 370:
            assert_no_denormals(den)

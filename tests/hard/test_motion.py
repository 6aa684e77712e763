"""Motion that is wrong, huge, tiny, or out of the frame costs a pixel its history, and no other pixel anything."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from svgf_cl import Frame
from tests.frames import SHAPE, bumpy_sequence, only
from tests.hard.variants import Variant, on

# Storage in 16 bits fetches history in a way of its own, and so does TAA; weights (fast) know nothing of motion.
variants = on("precise", "precise, two signals, TAA", "fp16, two signals, TAA", "Kalman")
# In Kalman neighbours tell of changes of light, so that a pixel's state depends on theirs.
of_lone_pixels = on("precise", "precise, two signals, TAA", "fp16, two signals, TAA")
# The length of history is kept, and TAA and the signals share it.
of_lengths = on("precise", "fp16")

HEIGHT, WIDTH = SHAPE
LARGEST = float(np.finfo(np.float32).max)
# Whatever comes of it must be far outside the image, and no integer may overflow on the way.
HUGE = (1e30, -1e30, LARGEST, -LARGEST, 1e6, -1e6, 2.0**24, 2.0**31, -(2.0**31), 1e10)
TINY = (1e-30, -1e-30, 1e-40, -1e-40)


def with_motion(frame: Frame, motion: np.ndarray, where: np.ndarray | bool = True) -> Frame:
    return replace(frame, motion=np.where(np.asarray(where)[..., None], motion, frame.motion).astype(np.float32))


def wrong(rng: np.random.Generator) -> np.ndarray:
    """To anywhere in the image, of each pixel apart."""
    return rng.uniform(-1, 1, (*SHAPE, 3)) * (WIDTH, HEIGHT, 1)


def huge(rng: np.random.Generator) -> np.ndarray:
    return rng.choice(HUGE, (*SHAPE, 3))


def tiny(rng: np.random.Generator) -> np.ndarray:
    return rng.choice(TINY, (*SHAPE, 3))


def to_the_border(rng: np.random.Generator) -> np.ndarray:
    """To half a pixel, or next to nothing, inside and outside of the four corners."""
    y, x = np.indices(SHAPE)
    off = rng.choice((-1, -0.75, -0.5, -0.25, 0, 0.25), (*SHAPE, 2))
    left, top = rng.random((2, *SHAPE)) < 0.5
    px = np.where(left, off[..., 0], WIDTH - 1 - off[..., 0])
    py = np.where(top, off[..., 1], HEIGHT - 1 - off[..., 1])
    return np.stack((px - x, py - y, np.zeros(SHAPE)), axis=-1)


every_motion = pytest.mark.parametrize("motion", [wrong, huge, tiny, to_the_border])


@every_motion
@variants
def test_follows_the_oracle(variant: Variant, motion) -> None:
    """In a third of the pixels, so that vectors hold both kinds."""
    rng = np.random.default_rng(11)
    variant.assert_follows_oracle(
        [with_motion(frame, motion(rng), rng.random(SHAPE) < 1 / 3) for frame in bumpy_sequence(variant.fields)]
    )


@every_motion
@variants
def test_even_light_stays_as_it_is(variant: Variant, motion) -> None:
    rng = np.random.default_rng(11)
    frames = [with_motion(variant.wall(0.3), motion(rng)) for _ in range(4)]
    for picture in variant.pictures(frames):
        assert_allclose(picture, 0.3, rtol=3 * variant.rounding)


@every_motion
@of_lone_pixels
def test_other_pixels_keep_their_history(variant: Variant, motion) -> None:
    rng = np.random.default_rng(11)
    first, second = bumpy_sequence(variant.fields, count=2)
    spoiled = rng.random(SHAPE) < 1 / 3
    stages = []
    for last in (second, with_motion(second, motion(rng), spoiled)):
        den = variant.denoiser(keep_stages=True)
        den.denoise(first)
        den.denoise(last)
        stages.append({name: den.stage(name) for name in ("accumulated", "mean", "moment_variance", "history_length")})
    for name, expected in stages[0].items():
        good = np.broadcast_to(~spoiled[..., None] if expected.shape[-1] == 3 else ~spoiled, expected.shape)
        assert_allclose(stages[1][name][good], expected[good], rtol=2 * variant.rounding)


@of_lengths
def test_huge_motion_leaves_no_history(variant: Variant) -> None:
    den = variant.denoiser()
    for _ in range(3):
        den.denoise(with_motion(variant.wall(), huge(np.random.default_rng(11))))
    assert_array_equal(den.stage("history_length"), 1)


@pytest.mark.parametrize("change", [1e30, -1e30, LARGEST, -LARGEST, 1.0, -4.0, -5.0])
@of_lengths
def test_so_does_a_change_of_depth_that_did_not_happen(variant: Variant, change: float) -> None:
    den = variant.denoiser()
    for _ in range(3):
        den.denoise(only(variant.wall(motion=(0, 0, change)), variant.fields))
    assert_array_equal(den.stage("history_length"), 1)

"""Pictures of a single pixel, a single row or column, primes, and 8K."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Frame, SvgfError
from svgf_cl.frame import Shape
from svgf_cl.oracle.svgf import Oracle
from tests.frames import PLAIN, SHAPE, bumpy_sequence
from tests.hard.variants import VARIANTS, Variant, on

# Planes of 16 bits are addressed in a way of their own, and TAA has borders too; fast weights have the same taps.
variants = on("precise", "precise, two signals, TAA", "fp16, two signals, TAA", "Kalman", "Kalman, two signals, TAA")
# Refused by the host: one that keeps all there is to keep.
of_host = on("precise, two signals, TAA")


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 1), (1, 257), (257, 1), (2, 3), (15, 17), (127, 131)], ids=str)
@variants
def test_follows_the_oracle(variant: Variant, shape: Shape) -> None:
    """In a row a tap counts for as much as in a picture three do."""
    frames = bumpy_sequence(variant.fields, shape=shape)
    variant.assert_follows_oracle(frames, shape, error=3 * variant.error)


HEIGHT, WIDTH = 4320, 7680
TILE: Shape = (270, 480)
# What a pixel depends on, over two frames: levels of 31 pixels in all, twice, the spatial variance, and motion.
REACH = 80
WINDOW = 200


def windows() -> Iterator[tuple[slice, slice]]:
    """Rows and columns of a window in each corner of the picture, and in its middle."""
    for top in (0, HEIGHT - WINDOW):
        for left in (0, WIDTH - WINDOW):
            yield np.s_[top : top + WINDOW], np.s_[left : left + WINDOW]
    yield np.s_[2101 : 2101 + WINDOW], np.s_[3701 : 3701 + WINDOW]


def within_reach(window: tuple[slice, slice]) -> tuple[slice, slice]:
    """The part of a window that depends on nothing outside it, as slices of the window."""
    return tuple(
        slice(0 if side.start == 0 else REACH, WINDOW if side.stop == length else WINDOW - REACH)
        for side, length in zip(window, (HEIGHT, WIDTH), strict=True)
    )


def tiled(frame: Frame) -> Frame:
    """An 8K picture made of many times the same."""
    repeats = HEIGHT // TILE[0], WIDTH // TILE[1]
    return Frame(**{name: np.tile(value, (*repeats, 1)[: value.ndim]) for name, value in frame.present().items()})


def cut_out(frame: Frame, window: tuple[slice, slice]) -> Frame:
    return Frame(**{name: np.ascontiguousarray(value[window]) for name, value in frame.present().items()})


def test_8k_follows_the_oracle_in_its_corners_and_its_middle() -> None:
    """Two frames, for the history as well; of 3.0 GB of planes, or 1.8 GB in 16 bits."""
    frame = tiled(bumpy_sequence(PLAIN, count=1, shape=TILE, motion=2)[0])
    expected = [expected_in(window, frame) for window in windows()]
    picture = np.empty((HEIGHT, WIDTH, 3), np.float32)
    for variant in (VARIANTS["precise"], VARIANTS["fp16"]):
        den = variant.denoiser((HEIGHT, WIDTH))
        for _ in range(2):
            den.denoise(frame, out=picture)
        for window, part in zip(windows(), expected, strict=True):
            off = variant.errors(picture[window][within_reach(window)], part)
            assert np.quantile(off, 0.999) <= variant.error
        den.close()  # before the next one takes as much memory


def expected_in(window: tuple[slice, slice], frame: Frame) -> np.ndarray:
    """The oracle's second picture in the part of a window that depends on nothing outside it."""
    small = cut_out(frame, window)
    oracle = Oracle((WINDOW, WINDOW), VARIANTS["precise"].settings)
    return [oracle.denoise(small) for _ in range(2)][-1][within_reach(window)]


@of_host
def test_a_frame_of_another_size_is_refused_and_changes_nothing(variant: Variant) -> None:
    first, second = bumpy_sequence(variant.fields, count=2)
    (other,) = bumpy_sequence(variant.fields, count=1, shape=(SHAPE[0], SHAPE[1] + 1))
    den = variant.denoiser()
    den.denoise(first)
    with pytest.raises(SvgfError, match=r"expected shape \(53, 37.*\), got shape \(53, 38"):
        den.denoise(other)
    _, expected = variant.pictures([first, second])
    assert_array_equal(den.denoise(second), expected)

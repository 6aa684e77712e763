"""What a denoiser is made of: what is refused, and a queue that its owner has left."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pyopencl as cl
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, Inputs, SvgfError
from svgf_cl.filters import DEFAULT
from svgf_cl.frame import Shape
from tests.frames import FULL, TINY, bumpy_sequence

FRAMES = bumpy_sequence(FULL, count=2, shape=TINY)


@pytest.mark.parametrize("shape", [(np.int64(2), np.uint8(3)), [2, 3], np.array([2, 3])], ids=str)
def test_shape_may_be_any_two_whole_numbers(shape: Any) -> None:
    assert Denoiser(shape).shape == (2, 3)


@pytest.mark.parametrize("shape", [None, 5, (5,), (5, 5, 3), (5.0, 5.0), "ab"], ids=str)
def test_shape_must_be_two_whole_numbers(shape: Any) -> None:
    with pytest.raises(SvgfError, match=r"expected shape \(height, width\), got"):
        Denoiser(shape)


@pytest.mark.parametrize("shape", [(0, 5), (5, 0), (-1, 5)])
def test_shape_must_hold_a_pixel(shape: Shape) -> None:
    with pytest.raises(SvgfError, match="at least 1 x 1 pixel, got"):
        Denoiser(shape)


@pytest.mark.parametrize("side", [17_000, 10**6])
def test_image_beyond_32_bit_indices_is_refused(side: int, queue: cl.CommandQueue) -> None:
    with pytest.raises(SvgfError, match="at most about 11000 x 11000"):
        Denoiser((side, side), queue=queue)


@pytest.mark.parametrize("settings", [{"taa": True}, "fast", {}])
def test_settings_must_be_settings(settings: Any, queue: cl.CommandQueue) -> None:
    with pytest.raises(SvgfError, match="expected settings="):
        Denoiser(TINY, queue=queue, settings=settings)


class TestQueue:
    def test_is_the_one_given(self, queue: cl.CommandQueue) -> None:
        assert Denoiser(TINY, queue=queue).queue is queue

    def test_must_be_one(self) -> None:
        with pytest.raises(SvgfError, match=r"expected queue=pyopencl\.CommandQueue\(\.\.\.\), got 'gpu'"):
            Denoiser(TINY, queue="gpu")  # type: ignore[arg-type]

    def test_must_be_in_order(self, queue: cl.CommandQueue) -> None:
        unordered = cl.command_queue_properties.OUT_OF_ORDER_EXEC_MODE_ENABLE
        if not queue.device.queue_properties & unordered:
            pytest.skip(f"{queue.device.name} has no out-of-order queues")
        with pytest.raises(SvgfError, match="in-order"):
            Denoiser(TINY, queue=cl.CommandQueue(queue.context, properties=unordered))

    def test_whose_with_ended_is_refused(self, context: cl.Context) -> None:
        """Drivers crash on such a queue."""
        with cl.CommandQueue(context) as queue:
            pass
        with pytest.raises(
            SvgfError, match=r"expected a queue that is in use, before the end of its 'with' .*; got a dead one"
        ):
            Denoiser(TINY, queue=queue)

    def test_whose_with_ends_later_still_serves(self, context: cl.Context) -> None:
        with cl.CommandQueue(context, properties=cl.command_queue_properties.PROFILING_ENABLE) as queue:
            den = Denoiser(TINY, queue=queue)
            den.denoise(FRAMES[0])
        picture = den.denoise(FRAMES[1])
        assert len(den.profile()) == len(DEFAULT().pipeline(Inputs.of(FRAMES[0])).passes)
        assert den.stage("depth").shape == TINY
        other = Denoiser(TINY)
        assert_array_equal([*map(other.denoise, FRAMES)][1], picture)

    def test_of_a_context_that_nobody_holds_is_refused_or_serves(self, queue: cl.CommandQueue) -> None:
        """On Intel's runtime a queue does not keep its context."""
        orphan = cl.CommandQueue(cl.Context([queue.device]))
        with suppress(SvgfError):
            assert np.isfinite(Denoiser(TINY, queue=orphan).denoise(FRAMES[0])).all()

    def test_keeps_its_context_as_long_as_a_denoiser(self, queue: cl.CommandQueue) -> None:
        context = cl.Context([queue.device])
        den = Denoiser(TINY, queue=cl.CommandQueue(context))
        del context
        assert np.isfinite(den.denoise(FRAMES[0])).all()

"""Threads: denoisers in several do not disturb each other, and several may share one."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from time import sleep

import numpy as np
import pyopencl as cl
import pytest
from numpy.testing import assert_array_equal

from svgf_cl import Denoiser, Frame, Settings
from svgf_cl.device import devices
from tests.frames import FULL, SHAPE, bumpy_sequence

THREADS = 4
SEQUENCES = [bumpy_sequence(FULL, count=4, seed=seed) for seed in range(THREADS)]


def denoised(frames: Sequence[Frame], queue: cl.CommandQueue) -> list[np.ndarray]:
    den = Denoiser(SHAPE, settings=Settings(taa=True), queue=queue)
    return [den.denoise(frame) for frame in frames]


@pytest.mark.parametrize("shared", ["queue", "context", "device"])
def test_denoisers_in_threads_give_the_same_bits_as_in_one(shared: str, queue: cl.CommandQueue) -> None:
    contexts = [cl.Context([queue.device]) if shared == "device" else queue.context for _ in SEQUENCES]
    queues = [queue if shared == "queue" else cl.CommandQueue(context) for context in contexts]
    alone = [denoised(frames, queue) for frames in SEQUENCES]
    with ThreadPoolExecutor(THREADS) as threads:
        together = list(threads.map(denoised, SEQUENCES, queues))
    assert_array_equal(together, alone)


def in_threads(work: Callable[[], object]) -> list[object]:
    """What comes of doing the same in several threads that begin together."""
    start = Barrier(THREADS)

    def begin(_: int) -> object:
        start.wait()
        return work()

    with ThreadPoolExecutor(THREADS) as threads:
        return list(threads.map(begin, range(THREADS)))


def test_one_denoiser_in_threads_takes_whole_frames_in_turn(queue: cl.CommandQueue) -> None:
    """The same frame from all: whoever comes when, it is one sequence."""
    frame, den, alone = SEQUENCES[0][0], Denoiser(SHAPE, queue=queue), Denoiser(SHAPE, queue=queue)
    expected = [alone.denoise(frame) for _ in range(THREADS)]
    together = in_threads(lambda: den.denoise(frame))
    assert {picture.tobytes() for picture in together} == {picture.tobytes() for picture in expected}


def test_one_denoiser_may_be_asked_and_reset_by_threads(queue: cl.CommandQueue) -> None:
    den = Denoiser(SHAPE, settings=Settings(), queue=queue)

    def work() -> bool:
        finite = True
        for frame in SEQUENCES[0]:
            finite &= bool(np.isfinite(den.denoise(frame)).all())
            assert len(den.profile()) in (0, 9)
            assert den.nbytes >= 0
            assert len(den.stages) in (0, 18)
            den.reset()
        return finite

    assert all(in_threads(work))


def test_the_first_queues_of_threads_share_a_context(queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    def slow(device: cl.Device) -> cl.Context:
        sleep(0.1)  # for all threads to ask before the first is answered
        return cl.Context([device])

    monkeypatch.setattr(devices, "_context", functools.cache(slow))
    assert len({made.context for made in in_threads(lambda: devices.create_queue(queue.device))}) == 1

"""A denoiser's memory is free as soon as nobody holds the denoiser, without the garbage collector."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import psutil
import pyopencl as cl
import pytest

from svgf_cl import Denoiser, DeviceError
from tests.faults import broken_launch
from tests.frames import FULL, bumpy_sequence

SHAPE = (270, 480)
FRAME = bumpy_sequence(FULL, count=1, shape=SHAPE)[0]
MANY = 24


@pytest.fixture(autouse=True)
def no_collector() -> Iterator[None]:
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def used(queue: cl.CommandQueue) -> Denoiser:
    den = Denoiser(SHAPE, queue=queue, keep_stages=True)
    den.denoise(FRAME)
    return den


def dropped(queue: cl.CommandQueue) -> None:
    used(queue)


def broken_off(queue: cl.CommandQueue) -> None:
    den = used(queue)
    with broken_launch(5), pytest.raises(DeviceError):
        den.denoise(FRAME)


def refused(queue: cl.CommandQueue) -> None:
    den = used(queue)
    with pytest.raises(ValueError, match=r"Frame\.depth"):
        den.denoise(replace(FRAME, depth=None))


@pytest.mark.parametrize("use", [dropped, broken_off, refused])
def test_nothing_refers_to_itself(use: Callable, queue: cl.CommandQueue, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[weakref.ref] = []
    monkeypatch.setattr(Denoiser, "__init__", watched(Denoiser.__init__, made))
    use(queue)
    assert [reference() for reference in made] == [None]


def watched(init: Callable, made: list[weakref.ref]) -> Callable:
    def watching(self: Denoiser, *arguments: object, **options: object) -> None:
        init(self, *arguments, **options)
        made.append(weakref.ref(self))

    return watching


def test_memory_is_used_again(queue: cl.CommandQueue) -> None:
    """Of many denoisers, one after the other, and of many resets, the process keeps no more than of a few."""
    den = used(queue)
    for _ in range(4):
        used(queue)
    before, rss = psutil.Process().memory_info().rss, den.nbytes
    for _ in range(MANY):
        used(queue)
        den.reset()
        den.denoise(FRAME)
    grown = psutil.Process().memory_info().rss - before
    assert grown < 2 * rss < MANY * rss / 8


def test_arrays_of_the_user_are_let_go(queue: cl.CommandQueue) -> None:
    den = Denoiser(SHAPE, queue=queue)
    frame = replace(FRAME, color=FRAME.color.copy())
    color = weakref.ref(frame.color)
    picture = weakref.ref(den.denoise(frame))
    del frame
    assert color() is None
    assert picture() is None
    assert isinstance(den.denoise(FRAME), np.ndarray)

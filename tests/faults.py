"""Real errors of OpenCL, made to happen where a test wants them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pyopencl as cl
import pytest

Call = Callable[..., Any]


@contextmanager
def no_room(at: int) -> Iterator[None]:
    """Inside, so many buffers are made; the next is asked to be larger than any device, all after that are made."""

    def too_large(buffer: Call, context: cl.Context, *_: Any, **__: Any) -> Any:
        return buffer(context, cl.mem_flags.READ_WRITE, 1 << 62)

    with failing("Buffer", at, too_large):
        yield


@contextmanager
def broken_launch(at: int) -> Iterator[None]:
    """Inside, so many kernels are launched; the next with work-groups larger than any device has."""

    def too_wide(launch: Call, queue: cl.CommandQueue, kernel: cl.Kernel, *_: Any) -> Any:
        return launch(queue, kernel, (1 << 20, 1 << 10), (1 << 20, 1 << 10))

    with failing("enqueue_nd_range_kernel", at, too_wide):
        yield


@contextmanager
def failing(name: str, at: int, otherwise: Call) -> Iterator[None]:
    """Inside, call number `at` of a function of pyopencl is made by `otherwise`, which is given the function first."""
    usual = getattr(cl, name)
    calls = iter(range(at + 1))

    def call(*arguments: Any, **options: Any) -> Any:
        if next(calls, None) == at:
            return otherwise(usual, *arguments, **options)
        return usual(*arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cl, name, call)
        yield

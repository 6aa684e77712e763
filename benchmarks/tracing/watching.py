"""Watches functions of the tracer from outside, so that the tracer needs no hooks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def watched(owner: object, name: str, watcher: Callable[..., Any]) -> Iterator[None]:
    """Within the block, calls of `name` in a module or class go to `watcher`, with the real function as argument."""
    real = getattr(owner, name)
    setattr(owner, name, lambda *arguments, **options: watcher(real, *arguments, **options))
    try:
        yield
    finally:
        setattr(owner, name, real)

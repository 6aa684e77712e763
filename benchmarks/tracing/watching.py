"""Functions of the tracer watched from outside, so that the tracer itself needs no hooks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def watched(owner: object, name: str, watcher: Callable[..., Any]) -> Iterator[None]:
    """While the block lasts, a call of `name` in a module or class calls `watcher`, with the real function first."""
    real = getattr(owner, name)
    setattr(owner, name, lambda *arguments, **options: watcher(real, *arguments, **options))
    try:
        yield
    finally:
        setattr(owner, name, real)

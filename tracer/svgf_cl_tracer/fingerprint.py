"""A hash of everything that a picture depends on: the same in every process, and different if any bit differs."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from svgf_cl.fingerprint import code_version

LIBRARIES = ("embreex", "numba", "numpy")
# These modules request pictures, but do not affect their content.
ASKING = ("cli", "demo.py")


def fingerprint(thing: object) -> str:
    """SHA-256, in hexadecimal digits, of numbers, texts, arrays, sequences and dataclasses of these.

    Objects that are equal in every bit have the same hash, whether or not they share parts.

    Raises
    ------
    TypeError
        If `thing` contains an object of another kind.
    """
    return _digest(thing, {}).hex()


@functools.cache
def tracer_version() -> str:
    """Hash of the tracer's sources and of the libraries it computes with, without the demo and the command line."""
    folder = Path(__file__).parent
    paths = [path for path in sorted(folder.rglob("*.py")) if path.relative_to(folder).parts[0] not in ASKING]
    sources = [(path.name, path.read_text(encoding="utf-8")) for path in paths]
    return code_version(sources, LIBRARIES)


def _digest(thing: object, known: dict[int, bytes]) -> bytes:
    """The hash; `known` has the hashes of earlier objects, because many materials may share a large texture."""
    if id(thing) not in known:
        digest = hashlib.sha256()
        for part in _parts(thing, known):
            digest.update(part)
        known[id(thing)] = digest.digest()
    return known[id(thing)]


def _parts(thing: object, known: dict[int, bytes]) -> Iterator[bytes | memoryview]:
    """The hashed parts of one object: its kind, then its value or the hashes of its parts."""
    if thing is None or isinstance(thing, bool | int | float | str):
        yield f"{type(thing).__name__} {thing!r}".encode()
    elif isinstance(thing, np.ndarray | np.generic) and not thing.dtype.hasobject:
        yield f"array {thing.dtype.str} {thing.shape} ".encode()
        yield np.ascontiguousarray(thing).data
    elif isinstance(thing, tuple | list):
        yield f"sequence {len(thing)} ".encode()
        yield from (_digest(part, known) for part in thing)
    elif dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        names = [field.name for field in dataclasses.fields(thing)]
        yield f"{type(thing).__qualname__} {' '.join(names)} ".encode()
        yield from (_digest(getattr(thing, name), known) for name in names)
    else:
        kinds = "numbers, texts, arrays, sequences and dataclasses"
        raise TypeError(f"fingerprint: expected {kinds}, got {type(thing).__name__}")

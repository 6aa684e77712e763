"""`Reader`: how one renderer writes the fields of a frame, and the light that its picture is the sum of."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from svgf_cl.camera import Camera
from svgf_cl.io.image import Image
from svgf_cl.io.readers.conversions import Array
from svgf_cl.io.readers.passes import Passes, plain

Convert = Callable[[Array], Array]
# What passes hold: fields of `Frame`, or what fields can be computed from, by name.
Values = dict[str, Array]
Complete = Callable[[Values, Camera | None], Values]

# What is no field of a frame, but fields can be computed from. World positions; lengths of the rays from the camera;
# where a pixel is in the next frame, as `motion`. With the number of components.
HELPERS = {"position": 3, "distance": 1, "motion_to_next": 2}


@dataclass(frozen=True)
class Found:
    """What a file has, in one view layer of it."""

    channels: Collection[str]
    passes: Passes


class Source(Protocol):
    """Where a field may come from."""

    @property
    def names(self) -> tuple[str, ...]:
        """What it may be called."""

    @property
    def size(self) -> int:
        """Components that it has at least."""

    @property
    def convert(self) -> Convert | None:
        """What makes ours of its array."""

    def find(self, found: Found) -> tuple[str, ...]:
        """Its channels; none where it is not there, `ValueError` where it is there in part."""

    def read(self, planes: Sequence[Array]) -> Array:
        """Make the field of the planes of its channels."""


@dataclass(frozen=True)
class Pass:
    """A pass, by the names that it may have.

    Parameters
    ----------
    names : tuple of str
        The likeliest first; capitals, spaces and signs do not matter. "" is the picture without a layer.
    size : int
        Components that it has at least.
    convert : callable, optional
        Makes ours of its (H, W, C) array, or (H, W) where `size` is 1; without it the first `size` components are ours.
    """

    names: tuple[str, ...]
    size: int
    convert: Convert | None = None

    def find(self, found: Found) -> tuple[str, ...]:
        """Its channels."""
        for name in map(plain, self.names):
            channels = found.passes.get(name, ())
            if len(channels) >= self.size:
                return self.used(channels)
        return ()

    def used(self, channels: tuple[str, ...]) -> tuple[str, ...]:
        """Those of a pass's channels that `read` takes."""
        return channels if self.convert and self.size > 1 else channels[: self.size]

    def read(self, planes: Sequence[Array]) -> Array:
        """Make the field of its planes."""
        values = planes[0] if self.size == 1 else np.stack(planes, axis=-1)
        return self.convert(values) if self.convert else values


@dataclass(frozen=True)
class Exactly:
    """Channels of these very names.

    Parameters
    ----------
    names : tuple of str
        In the order of the components.
    optional : tuple of str
        Those that may be missing.
    convert : callable, optional
        As of `Pass`.
    """

    names: tuple[str, ...]
    optional: tuple[str, ...] = ()
    convert: Convert | None = None

    @property
    def size(self) -> int:
        """Components that it has at least."""
        return len(self.names) - len(set(self.optional) & set(self.names))

    def find(self, found: Found) -> tuple[str, ...]:
        """Those that are there."""
        there = tuple(name for name in self.names if name in found.channels)
        missing = [name for name in self.names if name not in (*there, *self.optional)]
        if there and missing:
            raise ValueError(f"expected channels {' '.join(self.names)}, found only {' '.join(there)}")
        return there

    def read(self, planes: Sequence[Array]) -> Array:
        """Make the field of its planes."""
        values = planes[0] if len(self.names) == 1 else np.stack(planes, axis=-1)
        return self.convert(values) if self.convert else values


@dataclass(frozen=True)
class LightPasses:
    """Parts of the picture that are stored as passes of their own.

    Parameters
    ----------
    names : tuple of str
        The passes; each is filtered by itself.
    factor : str, optional
        The pass that each of them has to be multiplied by to be light: an albedo that is free of noise.
    filtered : bool
        Whether it is noisy; else it passes through, as light that the camera sees directly does.
    reflects : bool
        Whether it is seen in the surface, as in a mirror, and the albedo of what is seen there is still in it.
    is_background : bool
        Whether it is behind everything: it is no part of a picture with a transparent film, where alpha is below 1.
    """

    names: tuple[str, ...]
    factor: str | None = None
    filtered: bool = True
    reflects: bool = False
    is_background: bool = False


@dataclass(frozen=True, kw_only=True)
class Reader:
    """What is known of one renderer's files.

    Parameters
    ----------
    name : str
        For ``--format``.
    title : str
        What messages call it.
    recognises : callable
        Whether an image was written by it.
    passes : mapping of str to tuple of Source
        Where each field of a frame is, or may be; the best first. Beside the fields there may be `HELPERS`.
    switches : mapping of str to str
        What to do in the renderer to have a field written, for those that users forget.
    lights : tuple of LightPasses
        Their sum is the picture.
    complete : callable, optional
        Makes fields of what the passes hold, where that takes more than one of them.
    """

    name: str
    title: str
    recognises: Callable[[Image], bool]
    passes: Mapping[str, tuple[Source, ...]]
    switches: Mapping[str, str] = field(default_factory=dict)
    lights: tuple[LightPasses, ...] = ()
    complete: Complete | None = None

    def sources(self, found: Found) -> dict[str, tuple[Source, tuple[str, ...]]]:
        """The source of each field that is there, and its channels; `ValueError` where one is there in part."""
        sources = {}
        for name, candidates in self.passes.items():
            there = [(source, channels) for source in candidates if (channels := source.find(found))]
            if there:
                sources[name] = there[0]
        return sources


def has_attribute(image: Image, start: str) -> bool:
    """Whether the header of an image has an attribute whose name begins like that."""
    return any(name.startswith(start) for part in image.parts for name in part.attributes)


def text_attribute(image: Image, name: str) -> str:
    """A text of an image's header; empty where there is none."""
    kind, value = image.parts[0].attributes.get(name, ("", b""))
    return value.decode(errors="replace") if kind == "string" else ""

"""`Reader`: describes how a renderer writes the fields of a frame, and the light passes whose sum is its picture."""

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
# Values of passes by name: fields of `Frame`, or `HELPERS`.
Values = dict[str, Array]
Complete = Callable[[Values, Camera | None], Values]

# Values that are no fields of a frame, but from which fields can be computed, with their number of components: world
# positions; the length of the ray from the camera; the motion to the next frame.
HELPERS = {"position": 3, "distance": 1, "motion_to_next": 2}


@dataclass(frozen=True)
class Found:
    """The channels of a file, and the passes of one of its view layers."""

    channels: Collection[str]
    passes: Passes


class Source(Protocol):
    """A source of a field: a pass, or channels of given names."""

    @property
    def names(self) -> tuple[str, ...]:
        """Its possible names."""

    @property
    def size(self) -> int:
        """Its least number of components."""

    @property
    def convert(self) -> Convert | None:
        """Converts its array to our conventions."""

    def find(self, found: Found) -> tuple[str, ...]:
        """Return its channels; empty if they are missing. Raise `ValueError` if only some are missing."""

    def read(self, planes: Sequence[Array]) -> Array:
        """Make the field from the planes of its channels."""


@dataclass(frozen=True)
class Pass:
    """A pass that may have one of several names.

    Parameters
    ----------
    names : tuple of str
        The most likely first; capitals, spaces and signs do not matter. "" is the picture without a layer.
    size : int
        Least number of components.
    convert : callable, optional
        Converts its (H, W, C) array, or (H, W) if `size` is 1, to our conventions. Without it, the first `size`
        components are used as they are.
    """

    names: tuple[str, ...]
    size: int
    convert: Convert | None = None

    def find(self, found: Found) -> tuple[str, ...]:
        """Return its channels; empty if they are missing."""
        for name in map(plain, self.names):
            channels = found.passes.get(name, ())
            if len(channels) >= self.size:
                return self.used(channels)
        return ()

    def used(self, channels: tuple[str, ...]) -> tuple[str, ...]:
        """Return the channels of a pass that `read` needs."""
        return channels if self.convert and self.size > 1 else channels[: self.size]

    def read(self, planes: Sequence[Array]) -> Array:
        """Make the field from its planes."""
        return joined(planes, self.convert)


@dataclass(frozen=True)
class Exactly:
    """Channels of exactly these names.

    Parameters
    ----------
    names : tuple of str
        In the order of the components.
    optional : tuple of str
        Names that may be missing.
    convert : callable, optional
        As in `Pass`.
    """

    names: tuple[str, ...]
    optional: tuple[str, ...] = ()
    convert: Convert | None = None

    @property
    def size(self) -> int:
        """Its least number of components."""
        return len(self.names) - len(set(self.optional) & set(self.names))

    def find(self, found: Found) -> tuple[str, ...]:
        """Return its channels; empty if they are missing. Raise `ValueError` if only some are missing."""
        there = tuple(name for name in self.names if name in found.channels)
        missing = [name for name in self.names if name not in (*there, *self.optional)]
        if there and missing:
            raise ValueError(f"expected channels {' '.join(self.names)}, found only {' '.join(there)}")
        return there

    def read(self, planes: Sequence[Array]) -> Array:
        """Make the field from its planes."""
        return joined(planes, self.convert)


@dataclass(frozen=True)
class LightPasses:
    """Parts of the picture that are stored as separate passes.

    Parameters
    ----------
    names : tuple of str
        The passes; each is filtered by itself.
    factor : str, optional
        The pass to multiply each of them by, to get light: an albedo without noise.
    filtered : bool
        Whether they are noisy; else they are not filtered, such as light that the camera sees directly.
    reflects : bool
        Whether they are reflections, as in a mirror, which contain the albedo of the reflected surface.
    is_background : bool
        Whether they are behind everything. With a transparent film, the picture lacks them where alpha is below 1.
    """

    names: tuple[str, ...]
    factor: str | None = None
    filtered: bool = True
    reflects: bool = False
    is_background: bool = False


@dataclass(frozen=True, kw_only=True)
class Reader:
    """The description of one renderer's files.

    Parameters
    ----------
    name : str
        Its name for ``--format``.
    title : str
        Its name in messages.
    recognises : callable
        Whether the renderer wrote an image.
    passes : mapping of str to tuple of Source
        The possible sources of each field of a frame, and of `HELPERS`; the best first.
    switches : mapping of str to str
        What to do in the renderer so that it writes a field, for fields that users forget.
    lights : tuple of LightPasses
        Their sum is the picture.
    complete : callable, optional
        Changes the values of the passes, where that needs several of them.
    """

    name: str
    title: str
    recognises: Callable[[Image], bool]
    passes: Mapping[str, tuple[Source, ...]]
    switches: Mapping[str, str] = field(default_factory=dict)
    lights: tuple[LightPasses, ...] = ()
    complete: Complete | None = None

    def sources(self, found: Found) -> dict[str, tuple[Source, tuple[str, ...]]]:
        """Return the source and the channels of each field that is there; raise `ValueError` if one is incomplete."""
        sources = {}
        for name, candidates in self.passes.items():
            there = [(source, channels) for source in candidates if (channels := source.find(found))]
            if there:
                sources[name] = there[0]
        return sources


def joined(planes: Sequence[Array], convert: Convert | None) -> Array:
    """Return planes (H, W) as one array, (H, W) if there is one plane, else (H, W, C); converted, if necessary."""
    values = planes[0] if len(planes) == 1 else np.stack(planes, axis=-1)
    return convert(values) if convert else values


def has_attribute(image: Image, start: str) -> bool:
    """Whether the header of an image has an attribute whose name begins with `start`."""
    return any(name.startswith(start) for part in image.parts for name in part.attributes)


def text_attribute(image: Image, name: str) -> str:
    """Return a text of an image's header; empty if there is none."""
    kind, value = image.parts[0].attributes.get(name, ("", b""))
    return value.decode(errors="replace") if kind == "string" else ""

"""Groups the channels of a file by view layer and pass, for all renderers' names of components."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from svgf_cl.io.look_alikes import split

# The index of a component in its pass. Names of one letter may be capital or small; V-Ray writes words.
PLACES = {
    **dict.fromkeys(("r", "red", "x", "u", "t", "i", ""), 0),
    **dict.fromkeys(("g", "green", "y", "v"), 1),
    **dict.fromkeys(("b", "blue", "z"), 2),
    **dict.fromkeys(("a", "alpha", "w"), 3),
}
# Channels without a layer that are components of the picture.
PICTURE = ("R", "G", "B", "A")

# The channels of a pass, in the order of their components.
Channels = tuple[str, ...]
# Passes by their names in the form of `plain`; the picture without a layer is called "".
Passes = Mapping[str, Channels]


class Place(NamedTuple):
    """The view layer, pass and component of a channel."""

    view_layer: str
    name: str  # of the pass, in the form of `plain`
    component: int


def plain(name: str) -> str:
    """Return a pass's name in small letters, without spaces and signs: ``Denoising Albedo`` is ``denoisingalbedo``."""
    return re.sub(r"[\W_]", "", name.casefold())


def place(channel: str) -> Place:
    """Return view layer, pass and component of a channel's name, such as ``ViewLayer.Combined.R``."""
    if channel in PICTURE:
        return Place("", "", PLACES[channel.casefold()])
    layer, component = split(channel)
    view_layer, _, name = layer.rpartition(".")
    return Place(view_layer, plain(name), PLACES[component.casefold()])


def layer_of(channel: str) -> str:
    """Return the name of a channel's layer as in the file; "" for the picture without a layer."""
    return "" if channel in PICTURE else split(channel)[0]


def by_view_layer(channels: Iterable[str]) -> dict[str, Passes]:
    """Group channels by view layer and pass; a file without view layers gets one, called "".

    If the names of passes differ only in capitals, spaces and signs, the first one in alphabetical order is used. The
    same is true for channels that are the same component of a pass.
    """
    layers: dict[str, dict[int, str]] = {}
    for channel in sorted(channels):
        layers.setdefault(layer_of(channel), {}).setdefault(place(channel).component, channel)
    found: dict[str, dict[str, Channels]] = {}
    for components in layers.values():
        own = tuple(components[index] for index in sorted(components))
        view_layer, name, _ = place(own[0])
        found.setdefault(view_layer, {}).setdefault(name, own)
    return dict(found)


def called(name: str, channels: Iterable[str], view_layer: str) -> Channels:
    """Return the channels that a user's name means: a channel, or a pass's channels in the order of its components.

    The pass is one of `view_layer`, unless its name begins with another view layer.
    """
    channels = list(channels)
    if name in channels:
        return (name,)
    for layer in (f"{view_layer}.{name}", name):
        if own := sorted((*place(channel)[2:], channel) for channel in channels if split(channel)[0] == layer):
            return tuple(channel for _, channel in own)
    return by_view_layer(channels).get(view_layer, {}).get(plain(name), ())

"""Passes of a file: its channels, grouped by view layer and pass, whatever a renderer calls components."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from svgf_cl.io.look_alikes import split

# The place of a component in its pass. Names of one letter are capital or small; V-Ray writes words.
PLACES = {
    **dict.fromkeys(("r", "red", "x", "u", "t", "i", ""), 0),
    **dict.fromkeys(("g", "green", "y", "v"), 1),
    **dict.fromkeys(("b", "blue", "z"), 2),
    **dict.fromkeys(("a", "alpha", "w"), 3),
}
# Channels without a layer that are components all the same, of the picture.
PICTURE = ("R", "G", "B", "A")

# The channels of a pass, in the order of their components.
Channels = tuple[str, ...]
# Passes by their names, as `plain` has them; the picture without a layer is called "".
Passes = Mapping[str, Channels]


class Place(NamedTuple):
    """Where a channel belongs."""

    view_layer: str
    name: str  # of the pass, as `plain` has it
    component: int


def plain(name: str) -> str:
    """A pass's name in small letters, without spaces and signs: ``Denoising Albedo`` is ``denoisingalbedo``."""
    return re.sub(r"[\W_]", "", name.casefold())


def place(channel: str) -> Place:
    """Tell view layer, pass and component from a channel's name, such as ``ViewLayer.Combined.R``."""
    if channel in PICTURE:
        return Place("", "", PLACES[channel.casefold()])
    layer, component = split(channel)
    view_layer, _, name = layer.rpartition(".")
    return Place(view_layer, plain(name), PLACES[component.casefold()])


def layer_of(channel: str) -> str:
    """The name of the layer that a channel is a component of, as the file has it; "" for the picture without one."""
    return "" if channel in PICTURE else split(channel)[0]


def by_view_layer(channels: Iterable[str]) -> dict[str, Passes]:
    """Group channels by view layer and pass; files without view layers have one, called "".

    Of passes whose names differ in capitals, spaces and signs alone, and of channels that are the same component of a
    pass, the first by the alphabet is taken.
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
    """The channels that a user means: one of that name, or a pass's in the order of its components.

    The pass may be one of the view layer, or be given with the view layer that it is of.
    """
    channels = list(channels)
    if name in channels:
        return (name,)
    for layer in (f"{view_layer}.{name}", name):
        if own := sorted((*place(channel)[2:], channel) for channel in channels if split(channel)[0] == layer):
            return tuple(channel for _, channel in own)
    return by_view_layer(channels).get(view_layer, {}).get(plain(name), ())

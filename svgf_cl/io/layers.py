"""Channel names: which of a file's channels are its picture, and what to call those that several parts have."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence

from svgf_cl.frame import CHANNELS

RGB = ("R", "G", "B")
# What tells nothing without a layer: that of a part is called like the part.
ORDER = "RGBAXYZ"
LETTERS = frozenset(ORDER)
# How else renderers call the components of a layer.
COMPONENTS = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}
# How renderers call the layer that is the picture, whatever comes before in names such as ViewLayer.Combined.
PICTURES = ("rgba", "rgb", "beauty", "combined", "color", "colour", "c", "ci", "main")


def picture_channels(names: Collection[str]) -> tuple[str, ...]:
    """Find the red, green and blue channel of the picture among the channels of a file.

    It is ``R G B``; else the layer named like a picture, such as ``Beauty.R G B``; else the only layer of colours; else
    ``Y``, a grey picture.

    Raises
    ------
    ValueError
        There is none, or more than one.
    """
    layers = colour_layers(names)
    if "" in layers:
        return layers[""]
    if not layers and "Y" in names and not {"X", "RY", "BY"} & set(names):
        return ("Y", "Y", "Y")
    named = [layer for layer in layers if is_picture_name(layer)]
    possible = [layer for layer in layers if named or _last(layer) not in CHANNELS]
    for found in (named, possible):
        if len(found) == 1:
            return layers[found[0]]
    raise ValueError(
        f"expected channels R G B, or one layer of them, or one named {' or '.join(PICTURES)}; found {' '.join(names)}"
    )


def colour_layers(names: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Find the layers that have red, green and blue: their channels by the layer's name, which may be empty."""
    layers: dict[str, dict[int, str]] = {}
    for name in names:
        layer, _, component = name.rpartition(".")
        if component.casefold() in COMPONENTS:
            layers.setdefault(layer, {}).setdefault(COMPONENTS[component.casefold()], name)
    return {layer: tuple(found[i] for i in range(3)) for layer, found in layers.items() if len(found) == 3}


def is_picture_name(name: str) -> bool:
    """Whether a layer or part of that name is a picture."""
    return _last(name) in PICTURES


def in_usual_order(names: Iterable[str]) -> list[str]:
    """Sort channels by layer, and those of a layer as people name them: ``R G B A``, ``X Y Z``, then all others."""

    def place(name: str) -> tuple[str, int, str]:
        layer, _, component = name.rpartition(".")
        return layer, ORDER.find(component) if component in LETTERS else len(ORDER), component

    return sorted(names, key=place)


def unique_names(parts: Sequence[tuple[str, Collection[str]]]) -> list[dict[str, str]]:
    """Name the channels of a file so that no two are called the same.

    In a file of several parts the part's name comes before ``R G B A X Y Z``, as a layer's would, and before any other
    name that several parts have. The channels of the part that is the picture stay as they are.

    Parameters
    ----------
    parts : sequence of (str, collection of str)
        The name of each part and those of its channels.

    Returns
    -------
    list of dict
        For each part, from a channel's name in the file to the one it goes by.

    Raises
    ------
    ValueError
        More than one part could be the picture, or two names stay the same.
    """
    counts = Counter(name for _, names in parts for name in names)
    pictures = main = [part for part, names in parts if {*RGB} <= {*names}]
    if len(pictures) > 1:
        named = [part for part in pictures if is_picture_name(part)]
        main = named or [part for part in pictures if _last(part) not in CHANNELS]
    if len(main) > 1:
        raise ValueError(
            f"expected R G B in one part, or one of the parts with them named {' or '.join(PICTURES)}; found them in"
            f" {', '.join(pictures)}"
        )
    moved = {name for name, count in counts.items() if count > 1 or (name in LETTERS and len(parts) > 1)}
    renamed = [
        {name: f"{part}.{name}" if name in moved and part not in main else name for name in names}
        for part, names in parts
    ]
    for name, count in Counter(name for names in renamed for name in names.values()).items():
        if count > 1:
            raise ValueError(f"expected channels of different names, found two called {name}")
    return renamed


def _last(layer: str) -> str:
    """The last word of a layer's name, in small letters."""
    return layer.rpartition(".")[2].casefold()

"""Channel names: finds a file's picture channels, and renames channels that several parts have."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence

from svgf_cl.frame import CHANNELS

RGB = ("R", "G", "B")
# Names of components, which need a layer's name; in a file of several parts they get the part's name.
ORDER = "RGBAXYZ"
LETTERS = frozenset(ORDER)
# Renderers' names of the components of a colour.
COMPONENTS = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}
# Renderers' names of the layer that is the picture: the last word of a name such as ViewLayer.Combined.
PICTURES = ("rgba", "rgb", "beauty", "combined", "color", "colour", "c", "ci", "main")


def picture_channels(names: Collection[str]) -> tuple[str, ...]:
    """Find the red, green and blue channel of the picture among the channels of a file.

    The picture is ``R G B``; else the layer with a picture's name, such as ``Beauty.R G B``; else the only layer with
    colours; else ``Y``, a grey picture.

    Raises
    ------
    ValueError
        If there is none, or more than one.
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
    """Return the red, green and blue channels of each layer that has them, by the layer's name, which may be empty."""
    layers: dict[str, dict[int, str]] = {}
    for name in names:
        layer, _, component = name.rpartition(".")
        if component.casefold() in COMPONENTS:
            layers.setdefault(layer, {}).setdefault(COMPONENTS[component.casefold()], name)
    return {layer: tuple(found[i] for i in range(3)) for layer, found in layers.items() if len(found) == 3}


def is_picture_name(name: str) -> bool:
    """Whether a layer or part of this name is a picture."""
    return _last(name) in PICTURES


def in_usual_order(names: Iterable[str]) -> list[str]:
    """Sort channels by layer, and within a layer in the usual order: ``R G B A``, ``X Y Z``, then all others."""

    def place(name: str) -> tuple[str, int, str]:
        layer, _, component = name.rpartition(".")
        return layer, ORDER.find(component) if component in LETTERS else len(ORDER), component

    return sorted(names, key=place)


def unique_names(parts: Sequence[tuple[str, Collection[str]]]) -> list[dict[str, str]]:
    """Give the channels of a file different names.

    In a file of several parts, the part's name is put before ``R G B A X Y Z``, like a layer's name, and before any
    other name that several parts have. The part that is the picture keeps its names.

    Parameters
    ----------
    parts : sequence of (str, collection of str)
        The name of each part, and the names of its channels.

    Returns
    -------
    list of dict
        For each part, the new names of its channels by their names in the file.

    Raises
    ------
    ValueError
        If more than one part could be the picture, or two names are still the same.
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
    """Return the last word of a layer's name, in small letters."""
    return layer.rpartition(".")[2].casefold()

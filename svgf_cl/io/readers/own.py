"""Reads our own channels (docs/conventions.md), from ``svgf-cl render`` and from any renderer with the same names."""

from __future__ import annotations

import numpy as np

from svgf_cl.frame import REQUIRED
from svgf_cl.io.image import Image
from svgf_cl.io.readers.conversions import Array
from svgf_cl.io.readers.reader import Exactly, LightPasses, Reader

# Channels of each field, in the order of its components; `OPTIONAL` may be missing.
CHANNEL_NAMES: dict[str, tuple[str, ...]] = {
    "color": ("R", "G", "B"),
    **{
        name: tuple(f"{name}.{c}" for c in "RGB")
        for name in ("albedo", "emission", "direct", "indirect", "diffuse", "specular")
    },
    **{name: tuple(f"{name}.{c}" for c in "XYZ") for name in ("normal", "motion")},
    "depth": ("depth.Z",),
    "id": ("id",),
    "roughness": ("roughness",),
    "hit_distance": ("hit_distance.diffuse", "hit_distance.specular"),
}
OPTIONAL = "motion.Z"
MAX_ID = 2**24  # greatest id in a channel of floats


def needed(field: str) -> tuple[str, ...]:
    """Return the channels that a field needs."""
    return tuple(name for name in CHANNEL_NAMES[field] if name != OPTIONAL)


def recognises(image: Image) -> bool:
    """Whether the image has all the fields that a frame needs in addition to its light."""
    return all(image.planes.keys() >= set(needed(field)) for field in REQUIRED)


def whole_numbers(plane: Array) -> Array:
    """Return ids as integers; raise `ValueError` unless they are whole numbers that float32 represents exactly."""
    if plane.dtype == np.uint32:
        return plane
    values = np.asarray(plane, np.float32)
    fits = (values >= 0) & (values <= MAX_ID) & (values == np.floor(values))
    if not fits.all():
        raise ValueError(
            f"expected whole numbers in 0..{MAX_ID} in channel id, got {values[~fits][0]}; "
            "an id up to 4294967295 takes a channel of unsigned integers"
        )
    return values.astype(np.uint32)


OWN = Reader(
    name="svgf_cl",
    title="svgf_cl, or of another renderer with its channel names",
    recognises=recognises,
    passes={
        field: (Exactly(names, (OPTIONAL,), whole_numbers if field == "id" else None),)
        for field, names in CHANNEL_NAMES.items()
    },
    lights=(LightPasses(("direct", "indirect")), LightPasses(("emission",), filtered=False)),
)

"""The bytes that a pass moves per pixel: what it needs is read once, and what it makes is written once."""

from __future__ import annotations

from svgf_cl.filters.formats import LIGHT, NORMALS
from svgf_cl.filters.pipeline import OUT, Inputs, Pass, kind_of
from svgf_cl.frame import CHANNELS
from svgf_cl.settings import Settings

FLOAT = 4  # bytes
HALF = 2


def bytes_moved(entry: Pass, buffer: str, inputs: Inputs, settings: Settings) -> int:
    """What a pass moves of a buffer or a user's array, per pixel; light and normals may be kept in 16 bits."""
    planes = planes_used(entry, buffer, inputs)
    kind = kind_of(buffer)
    if kind in LIGHT:
        return planes * light_bytes(settings)
    narrow = NORMALS if kind == "guide" and planes > 1 else 0
    return (planes - narrow) * FLOAT + narrow * normal_bytes(settings)


def light_bytes(settings: Settings) -> int:
    """Of an element of illumination or moments."""
    return HALF if settings.half_history else FLOAT


def normal_bytes(settings: Settings) -> int:
    """Of a component of the guide's normals."""
    return HALF if settings.half_guides else FLOAT


def planes_used(entry: Pass, buffer: str, inputs: Inputs) -> int:
    """How many of a buffer's planes, or of a user's array's channels, a pass needs."""
    light = 3 * inputs.signals
    if buffer == "motion":
        return 2 if entry.kernel == "taa" else inputs.motion
    parts = {
        ("temporal", "history"): light,  # without the variance
        ("temporal", "accumulated"): light,
        ("atrous", "guide"): 4,  # normal and depth
        ("variance", "guide"): 0,  # only where history is short
        ("variance", "moments"): 1 + inputs.signals,  # length and variance
        ("variance", "accumulated"): inputs.signals,
        ("modulate", entry.reads[-1]): light,
        ("taa", "guide"): 1,  # depth
        ("taa", "moments"): 1,  # length
    }
    if (entry.kernel, buffer) in parts:
        return parts[entry.kernel, buffer]
    if buffer == OUT:
        return 3
    return max(1, *CHANNELS[buffer]) if buffer in CHANNELS else inputs.planes(buffer)

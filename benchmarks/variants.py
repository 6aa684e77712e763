"""The choices that trade speed for error: each alone, against the default, and those that make sense together."""

from __future__ import annotations

from dataclasses import dataclass, field

from svgf_cl import Settings


@dataclass(frozen=True)
class Variant:
    """A way to run the filter.

    Parameters
    ----------
    name : str
        What differs from the default.
    settings : Settings
    signals : int, 1 or 2
        2 filters direct and indirect light apart.
    """

    name: str
    settings: Settings = field(default_factory=Settings)
    signals: int = 1


DEFAULT = Variant("default")

VARIANTS = (
    DEFAULT,
    Variant("fast", Settings(precision="fast")),
    Variant("3x3 taps", Settings(taps="3x3")),
    Variant("4 levels", Settings(iterations=4)),
    Variant("3 levels", Settings(iterations=3)),
    Variant("3 levels, fast", Settings(iterations=3, precision="fast")),
    Variant("3x3, fast", Settings(taps="3x3", precision="fast")),
    Variant("3x3, 3 levels, fast", Settings(taps="3x3", iterations=3, precision="fast")),
    Variant("two signals", signals=2),
    Variant("TAA", Settings(taa=True)),
    Variant("TAA, fast", Settings(taa=True, precision="fast")),
    Variant("TAA, 3x3, fast", Settings(taa=True, taps="3x3", precision="fast")),
    Variant("TAA, 3 levels, fast", Settings(taa=True, iterations=3, precision="fast")),
    Variant("TAA, two signals", Settings(taa=True), signals=2),
)

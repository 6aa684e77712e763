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
    Variant("half guides", Settings(half_guides=True)),
    Variant("half history", Settings(half_history=True)),
    Variant("half both", Settings(half_guides=True, half_history=True)),
    Variant("5x5", Settings(taps="5x5")),
    Variant("4 levels", Settings(iterations=4)),
    Variant("3 levels", Settings(iterations=3)),
    Variant("two signals", signals=2),
    Variant("5x5, fast", Settings(taps="5x5", precision="fast")),
    Variant("5x5, 3 levels", Settings(taps="5x5", iterations=3)),
    Variant("fast, half", Settings(precision="fast", half_guides=True, half_history=True)),
    Variant("fast, 4 levels", Settings(precision="fast", iterations=4)),
    Variant("fast, 3 levels", Settings(precision="fast", iterations=3)),
    Variant("TAA", Settings(taa=True)),
    Variant("TAA, fast", Settings(taa=True, precision="fast")),
    Variant("TAA, fast, 3 levels", Settings(taa=True, precision="fast", iterations=3)),
    Variant("TAA, 5x5", Settings(taa=True, taps="5x5")),
    Variant("TAA, two signals", Settings(taa=True), signals=2),
)

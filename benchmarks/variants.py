"""The settings that trade speed for error: each one alone compared with the default, and useful combinations."""

from __future__ import annotations

from dataclasses import dataclass, field

from svgf_cl import Kalman, Settings
from svgf_cl.filters import DEFAULT
from svgf_cl.filters.temporal import TemporalFilter


@dataclass(frozen=True)
class Variant:
    """A way to run the filter.

    Parameters
    ----------
    name : str
        The difference from the default.
    settings : TemporalFilter
    signals : int, 1 or 2
        2 filters direct and indirect light separately.
    """

    name: str
    settings: TemporalFilter = field(default_factory=DEFAULT)
    signals: int = 1


VARIANTS = (
    Variant("default"),
    Variant("fast", Kalman(precision="fast")),
    Variant("half guides", Kalman(half_guides=True)),
    Variant("half history", Kalman(half_history=True)),
    Variant("half both", Kalman(half_guides=True, half_history=True)),
    Variant("5x5", Kalman(taps="5x5")),
    Variant("5 levels", Kalman(iterations=5)),
    Variant("3 levels", Kalman(iterations=3)),
    Variant("two signals", signals=2),
    Variant("fast, 3 levels", Kalman(precision="fast", iterations=3)),
    Variant("SVGF", Settings()),
    Variant("SVGF, fast", Settings(precision="fast")),
    Variant("SVGF, 5x5", Settings(taps="5x5")),
    Variant("SVGF, 3 levels", Settings(iterations=3)),
    Variant("SVGF, two signals", Settings(), signals=2),
    Variant("TAA", Kalman(taa=True)),
    Variant("TAA, fast", Kalman(taa=True, precision="fast")),
    Variant("TAA, two signals", Kalman(taa=True), signals=2),
    Variant("SVGF, TAA", Settings(taa=True)),
    Variant("SVGF, TAA, 5x5", Settings(taa=True, taps="5x5")),
)

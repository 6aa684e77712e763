"""The variants of the kernels that are compiled: each choice alone, and all choices at once."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.builds import Build, Case, builds
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import SPLITS, Inputs
from svgf_cl.settings import Choice, Switch, Value, defaults, domains

USUAL = Inputs(motion=3, albedo=True)  # the fields that most renderers write
# The fewest and the most fields of frames with either split.
EXTREMES = tuple(
    supplied
    for signals in SPLITS
    for supplied in (Inputs(signals=signals), Inputs(signals=signals, motion=3, albedo=True, emission=True, id=True))
)


def variants() -> list[Build]:
    """Every source file with the options of every case, each once; the most usual variant of a source is first."""
    return builds(cases())


def cases() -> Iterator[Case]:
    """For each filter, the defaults and all choices at once, with any frames; and each choice alone, with usual frames.

    Compiling the product of all choices would take an hour. `scripts/lint_kernels.py` checks more combinations, with
    clang alone.
    """
    for kind in FILTERS.values():
        alone = choices(kind)
        together = {name: value for each in alone for name, value in each.items()}
        for supplied in (USUAL, *EXTREMES):
            yield case(kind, {}, supplied)
        for chosen in alone:
            yield case(kind, chosen, USUAL)
        for supplied in (USUAL, *EXTREMES):
            yield case(kind, together, supplied)


def choices(kind: type[Filter]) -> list[dict[str, Value]]:
    """A filter's settings that change its code, one at a time, with each value that is not the default."""
    usual = defaults(kind)
    return [
        {name: value}
        for name, domain in domains(kind).items()
        for value in (
            domain.words if isinstance(domain, Choice) else (True, False) if isinstance(domain, Switch) else ()
        )
        if value != usual[name]
    ]


def case(kind: type[Filter], settings: dict[str, Value], supplied: Inputs) -> Case:
    """A filter with these settings, with the tuning for GPUs."""
    return Case(kind(**settings), supplied, GPU_TUNING)

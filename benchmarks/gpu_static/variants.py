"""Which variants of the kernels are compiled: all that differ in one choice, and all choices at once."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.builds import Build, Case, builds
from svgf_cl.device.tuning import GPU_TUNING
from svgf_cl.filters import FILTERS
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import SPLITS, Inputs
from svgf_cl.settings import Choice, Switch, Value, defaults, domains

USUAL = Inputs(motion=3, albedo=True)  # what most renderers give
# The least and the most that frames of either split may supply.
EXTREMES = tuple(
    supplied
    for signals in SPLITS
    for supplied in (Inputs(signals=signals), Inputs(signals=signals, motion=3, albedo=True, emission=True, id=True))
)


def variants() -> list[Build]:
    """Every source file with the options of every case, each once; the first of a source is the most usual one."""
    return builds(cases())


def cases() -> Iterator[Case]:
    """Of each filter the defaults and all choices at once with any frames, and one choice alone with usual ones.

    The product of all choices would take an hour to compile. `scripts/lint_kernels.py` checks more of it, by clang
    alone.
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
    """A filter's settings that change its code, one by one, with each value that is not the default."""
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
    """A filter with these settings as GPUs run it."""
    return Case(kind(**settings), supplied, GPU_TUNING)

"""The builds of kernels: source files with the macros of settings, frames and tunings, each combination once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from svgf_cl.device import programs
from svgf_cl.device.tuning import Tuning
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.signals import Inputs
from svgf_cl.settings import defaults


@dataclass(frozen=True)
class Case:
    """A filter with its settings, the fields of the frames, and the tuning."""

    chosen: Filter
    inputs: Inputs
    tuning: Tuning

    def __str__(self) -> str:
        usual = defaults(type(self.chosen))
        other = {name: value for name in usual if (value := getattr(self.chosen, name)) != usual[name]}
        settings = " ".join(f"{name}={value}" for name, value in other.items())
        return f"{self.chosen.name} {settings or 'by default'}; {self.inputs}"


@dataclass(frozen=True)
class Build:
    """A source file and its compiler options, and a description of the first case that needs this build."""

    source: str
    options: tuple[str, ...]
    variant: str

    @property
    def macros(self) -> tuple[str, ...]:
        """The options that define macros."""
        return tuple(option for option in self.options if option.startswith("-D"))


def builds(cases: Iterable[Case]) -> list[Build]:
    """All builds for these cases, each once, and the builds that do not depend on a filter."""
    found: dict[tuple[str, tuple[str, ...]], Build] = {}
    for build in (*fixed(), *(build for case in cases for build in builds_of(case))):
        found.setdefault((build.source, build.options), build)
    return list(found.values())


def fixed() -> Iterator[Build]:
    """The builds that are the same for all filters and frames."""
    for source in programs.WITHOUT_HEADERS:
        yield Build(source, programs.options_of(source, {}), "all")


def builds_of(case: Case) -> Iterator[Build]:
    """The builds of all source files in a case's pipeline."""
    pipeline = case.chosen.pipeline(case.inputs)
    for source in dict.fromkeys(entry.source for entry in pipeline.passes):
        yield Build(source, programs.options_of(source, case.tuning.defines | pipeline.defines), str(case))

"""Runs all benchmarks on every device, in turn."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import chain, zip_longest
from typing import TypeVar

from svgf_cl.bench.cases import SHAPES, STARTS, USUAL_SHAPE, Case, cases
from svgf_cl.bench.results import Run
from svgf_cl.bench.station import Station
from svgf_cl.device import devices
from svgf_cl.device.devices import DeviceReport
from svgf_cl.errors import SvgfError
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Shape

# Everything is sampled this many times, in turn: then a temporary disturbance of the machine affects all alike.
TURNS = 5

Task = TypeVar("Task")
ProgressBar = Callable[[str, int], AbstractContextManager[Callable[[], None]]]


@dataclass(frozen=True)
class Suite:
    """The benchmarks to run.

    Parameters
    ----------
    pattern : re.Pattern
        Benchmarks whose names match it are run.
    settings : Filter
    shapes : sequence of (int, int)
    seconds : float, s
        Approximate time for each denoiser. Each kind of sample is taken at least `TURNS` times, however long that
        takes.
    ceilings : bool
        Measure the devices' limits too; without them there are no rooflines.
    """

    pattern: re.Pattern[str]
    settings: Filter
    shapes: Sequence[Shape] = SHAPES
    seconds: float = 1.0
    ceilings: bool = True

    def names(self) -> list[str]:
        """Return the benchmarks that `run` would time on any device, except the ceilings; errors are those of `run`."""
        return self._names(timed_devices())

    def run(self, progress_bar: ProgressBar) -> Run:
        """Time everything, in turn: each denoiser on one device after the other.

        Parameters
        ----------
        progress_bar : callable
            Takes a title and a number of steps, and returns a context manager whose value is a function to call after
            each step.

        Raises
        ------
        SvgfError
            If no name matches `pattern`, or no device works (`DeviceError`).
        """
        reports = timed_devices()
        names = self._names(reports)
        stations = [Station(each, self._chosen(each), self.settings, ceilings=self.ceilings) for each in reports]
        chosen = interleaved([[(station, case) for case in station.chosen] for station in stations])
        starts = not set(names).isdisjoint(self._starts())
        with progress_bar("setting up", len(chosen) + len(stations)) as advance:
            for station, case in chosen:
                station.set_up(case)
                advance()
            for station in stations:
                if starts:
                    station.start()
                advance()
        with progress_bar("timing", TURNS * (len(chosen) + len(stations))) as advance:
            for _ in range(TURNS):
                for station in stations:
                    station.sample_ceilings()
                    advance()
                for station, case in chosen:
                    station.sample(case, self.seconds / TURNS)
                    advance()
        with progress_bar("comparing with the oracle", len(stations)) as advance:
            records = []
            for station in stations:
                records.append(station.record())
                advance()
        results = [station.results(record, self.pattern) for station, record in zip(stations, records, strict=True)]
        left_out = [line for station in stations for line in station.left_out]
        return Run.now(tuple(records), tuple(chain(*results)), tuple(left_out))

    def _names(self, reports: Sequence[DeviceReport]) -> list[str]:
        """Return the names that match on at least one of these devices; raise `SvgfError` if there is none."""
        every = [case.name(row) for report in reports for case in self._chosen(report) for row in case.rows]
        found = [name for name in dict.fromkeys([*every, *self._starts()]) if self.pattern.search(name)]
        if not found:
            name = f"{self.settings.name}.frame.1280x720"
            raise SvgfError(f"--only: expected part of a name such as {name}, got {self.pattern.pattern}")
        return found

    def _chosen(self, report: DeviceReport) -> list[Case]:
        """Return the cases that have something to time on a device."""
        assert report.handle is not None
        every = cases(report.handle, self.shapes, self.settings)
        return [case for case in every if any(self.pattern.search(case.name(row)) for row in case.rows)]

    def _starts(self) -> list[str]:
        """Return the names of the benchmarks of a process's first frame, whether they match or not."""
        return [Case(USUAL_SHAPE, self.settings).name(row) for row in STARTS]


def timed_devices() -> list[DeviceReport]:
    """Return the device that ``PYOPENCL_CTX`` names, else all working devices except simulators.

    Raises
    ------
    DeviceError
        If no device works.
    """
    reports = devices.list_devices()
    if devices.VARIABLE in os.environ:
        return [devices.choose(reports)]
    return [report for report in reports if report.works and report.kind != "simulator"] or [devices.choose(reports)]


def interleaved(columns: Sequence[Sequence[Task]]) -> list[Task]:
    """Return the first task of each column, then the second of each, and so on."""
    return [task for row in zip_longest(*columns) for task in row if task is not None]

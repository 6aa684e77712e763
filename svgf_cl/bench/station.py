"""`Station`: one device of a run, with its limits, its denoisers and their samples."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from functools import cache
from typing import Any

import pyopencl as cl

from svgf_cl.bench.cases import STARTS, USUAL_SHAPE, Case
from svgf_cl.bench.ceilings import Ceilings, CeilingSamples
from svgf_cl.bench.cores import confined
from svgf_cl.bench.error import error_to_oracle
from svgf_cl.bench.results import DeviceRecord, Result
from svgf_cl.bench.rig import EVENT, FRAME, HOST, Rig, Row, levels_together, there_and_back
from svgf_cl.bench.roofline import BINDS, Bound
from svgf_cl.bench.startup import first_frames
from svgf_cl.device import devices
from svgf_cl.device.devices import DeviceReport
from svgf_cl.device.tuning import best_tuning
from svgf_cl.errors import SvgfError
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Frame, Shape


class Station:
    """A device with all the cases to time on it.

    Parameters
    ----------
    report : DeviceReport
        The report on a device that works.
    chosen : sequence of Case
    settings : Filter
        The filter whose error is measured.
    ceilings : bool
        Measure the device's limits too.
    """

    def __init__(self, report: DeviceReport, chosen: Sequence[Case], settings: Filter, *, ceilings: bool) -> None:
        assert report.handle is not None
        self.report, self.chosen, self.settings = report, chosen, settings
        self._rigs: dict[Case, Rig] = {}
        self.left_out: list[str] = []
        self._starts: dict[Row, list[float]] = {}
        self._queue = devices.create_queue(report.handle)
        self._ceilings = CeilingSamples(self._queue) if ceilings else None

    def set_up(self, case: Case) -> None:
        """Prepare a denoiser, or note why that fails."""
        try:
            frames = room(case.shape, len(case.inputs.signals))
            self._rigs[case] = Rig(frames, case.settings, self._queue, passes=not case.variant)
        except (SvgfError, MemoryError, cl.Error) as error:  # the device may lack memory
            self.left_out.append(f"{case.name(FRAME)} on {self.report}: {error}")

    def start(self) -> None:
        """Time the first frame of new processes."""
        cold, warm = first_frames(self.report, USUAL_SHAPE, self.settings)
        self._starts = dict(zip(STARTS, ([cold], warm), strict=True))

    def sample(self, case: Case, seconds: float) -> None:
        """Time a case for about `seconds`, if it could be set up."""
        if case in self._rigs:
            with confined(case.cores) if case.cores else nullcontext():
                self._rigs[case].sample(seconds)

    def sample_ceilings(self) -> None:
        """Take a few samples of each limit, if they are to be measured."""
        if self._ceilings:
            self._ceilings.sample()

    def record(self) -> DeviceRecord:
        """Return the description of the device, its limits, and the error on it."""
        largest, rms = error_to_oracle(self.settings, queue=self._queue)
        device = self._queue.device
        return DeviceRecord(
            selector=self.report.selector,
            platform=self.report.platform,
            version=self.report.version,
            device=self.report.device,
            driver=self.report.driver,
            compute_units=device.max_compute_units,
            tuning=str(best_tuning(device)),
            rms=rms,
            largest=largest,
            ceilings=self._ceilings.ceilings if self._ceilings else None,
        )

    def results(self, record: DeviceRecord, pattern: re.Pattern[str]) -> Iterator[Result]:
        """Yield the results whose names match `pattern`; `record` is this device's."""
        for name, seconds, facts in self._ceilings.named() if self._ceilings else ():
            yield Result(name, record.selector, EVENT, tuple(seconds), facts)
        usual = Case(USUAL_SHAPE, self.settings)
        for row, values in self._starts.items():
            if pattern.search(usual.name(row)):
                yield self._result(usual, row, HOST, values)
        for case, rig in self._rigs.items():
            bounds = bound_facts(case, record.ceilings) if record.ceilings else {}
            for (row, clock), values in rig.samples.items():
                if row in case.rows and pattern.search(case.name(row)):
                    more = bounds.get(row, {}) if clock == EVENT else {}
                    if row == FRAME and not case.variant:
                        more = more | {"planes": rig.denoiser.nbytes}
                    yield self._result(case, row, clock, values, **more)

    def _result(self, case: Case, row: Row, clock: str, seconds: Sequence[float], **more: Any) -> Result:
        passes = {entry.path: entry for entry in case.passes}
        facts = {
            "row": " ".join(row),
            "kernel": passes[row].kernel if row in passes else None,
            "level": passes[row].level if row in passes else None,
            "variant": case.variant,
            "width": case.shape[1],
            "height": case.shape[0],
            "signals": len(case.inputs.signals),
            "iterations": vars(case.settings).get("iterations"),
            "cores": case.cores,
        }
        return Result(case.name(row), self.report.selector, clock, tuple(seconds), facts | more)


def bound_facts(case: Case, ceilings: Ceilings) -> dict[Row, dict[str, Any]]:
    """Return for each row the bytes moved and loaded, the operations, the least seconds, and the limit that binds.

    Rows of several passes have the sums.
    """
    if case.cores is not None:  # the ceilings are those of all cores
        return {}
    costs = case.costs()
    before = [*costs.values()][-1:] + [*costs.values()][:-1]  # the first pass comes after the last of another frame
    bounds = {path: Bound.of(costs[path], other, ceilings) for path, other in zip(costs, before, strict=True)}
    groups = {path: [path] for path in costs} | {FRAME: list(costs)} | levels_together(costs)
    found = {}
    for row, paths in groups.items():
        seconds = {term: sum((bounds[p].seconds for p in paths if bounds[p].binds == term), 0.0) for term in BINDS}
        binds = max(BINDS, key=seconds.__getitem__)
        found[row] = {
            "bytes": sum(costs[p].bytes for p in paths),
            "loaded": sum(costs[p].loads.bytes for p in paths),
            "flops": sum(costs[p].flops for p in paths),
            "bound": sum(seconds.values()),
            "binds": binds,
        }
    return found


@cache
def room(shape: Shape, signals: int) -> tuple[Frame, Frame]:
    """Return the frames of a size; all devices share them."""
    return there_and_back(shape, signals)

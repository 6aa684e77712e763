"""The report of a run: ``report.md`` to read and ``report.json`` for programs; both are rewritten after every step."""

from __future__ import annotations

import json
import os
import platform
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pyopencl as cl

from benchmarks.gpu.child import Ended
from benchmarks.gpu.findings import Found
from benchmarks.gpu.steps import Step, logs
from benchmarks.presentation import markdown
from benchmarks.provenance import provenance
from svgf_cl.bench.tables import Table
from svgf_cl.device.devices import DeviceReport
from svgf_cl.io.atomic import write_text

PACKAGES = ("pyopencl", "numpy", "pytest")
# Facts about a device, by pyopencl's names.
FACTS = (
    *("name", "vendor", "version", "driver_version", "opencl_c_version", "max_compute_units", "max_clock_frequency"),
    *("global_mem_size", "global_mem_cache_size", "local_mem_size", "max_mem_alloc_size", "max_work_group_size"),
    *("native_vector_width_float", "preferred_vector_width_float", "host_unified_memory", "profiling_timer_resolution"),
    "extensions",
)
PLEASE = "Please send this page, or the folder that it lies in, to the project: no GPU was at hand when it was written."
DRY = "This was a dry run: the same steps, with sizes so small that no time in it means anything."


@dataclass(frozen=True)
class Outcome:
    """A step that has ended, and its result."""

    step: Step
    ended: Ended
    found: Found

    @property
    def state(self) -> str:
        """The result in a word or two."""
        if self.found.complaint:
            return "failed"
        return "cut short" if self.ended.is_short else "done"

    @property
    def row(self) -> tuple[str, ...]:
        """A row of the table of steps."""
        step, seconds = self.step, f"{self.ended.seconds:.0f} of {self.step.seconds}"
        return step.name, step.title, self.state, seconds, self.found.complaint

    def as_json(self) -> dict[str, Any]:
        """The result as JSON."""
        step = {"name": self.step.name, "title": self.step.title, "command": self.step.command}
        return step | {"state": self.state, "seconds": self.ended.seconds} | asdict(self.found)


@dataclass
class Report:
    """The results of a run so far.

    Parameters
    ----------
    reports : sequence of DeviceReport
        All devices that were found.
    device : DeviceReport
        The device that the run measures.
    dry_run : bool
    outcomes : list of Outcome
        The steps that have ended.
    begun : str
        Start of the run, ISO 8601, UTC.
    """

    reports: list[DeviceReport]
    device: DeviceReport
    dry_run: bool
    outcomes: list[Outcome] = field(default_factory=list)
    begun: str = field(default_factory=lambda: datetime.now(timezone.utc).isoformat(timespec="seconds"))

    @property
    def failed(self) -> list[str]:
        """The names of the steps that failed."""
        return [each.step.name for each in self.outcomes if each.found.complaint]

    @property
    def steps(self) -> Table:
        """The result of each step."""
        heads = ("step", "what", "state", "seconds", "why")
        return Table("steps", heads, [each.row for each in self.outcomes])

    def write(self, folder: Path) -> None:
        """Write both files, each completely or not at all."""
        write_text(folder / "report.md", self.page())
        write_text(folder / "report.json", json.dumps(self.as_json(), indent=1))

    def page(self) -> str:
        """The report in Markdown."""
        about = Table("", ("what", "value"), [(key, cell(value)) for key, value in self.about().items()])
        driver = Table("", ("what", "value"), [(key, cell(value)) for key, value in facts(self.device).items()])
        parts = [
            f"# {self.device.device}: svgf_cl on a GPU\n" if not self.dry_run else "# svgf_cl: a dry run\n",
            f"{DRY if self.dry_run else PLEASE}\n",
            markdown(about),
            f"## Steps\n\n{markdown(self.steps)}",
            f"## Devices\n\n{markdown(device_table(self.reports))}",
            f"## What the driver says of the device\n\n{markdown(driver)}",
            *(section(each) for each in self.outcomes),
        ]
        return "\n".join(parts)

    def about(self) -> dict[str, Any]:
        """What ran, on which device, and when."""
        assert self.device.handle is not None
        return {
            **provenance(self.device.handle),
            "begun": self.begun,
            "system": platform.platform(),
            "cores": os.cpu_count(),
            "python": platform.python_version(),
            **{name: version(name) for name in PACKAGES},
        }

    def as_json(self) -> dict[str, Any]:
        """The report for programs."""
        return {
            "about": self.about(),
            "dry_run": self.dry_run,
            "devices": asdict(device_table(self.reports)),
            "facts": facts(self.device),
            "steps": [each.as_json() for each in self.outcomes],
        }


def facts(report: DeviceReport) -> dict[str, Any]:
    """The driver's information about a device; if the driver fails, the reason."""
    found = {}
    for name in FACTS:
        try:
            found[name] = getattr(report.handle, name)
        except (cl.Error, AttributeError) as error:
            found[name] = f"unknown ({error})"
    return found


def device_table(reports: list[DeviceReport]) -> Table:
    """Every device, and whether it works."""
    heads = ("PYOPENCL_CTX", "device", "platform", "driver", "kind", "works")
    rows = [(r.selector, r.device, r.platform, r.driver, r.kind, r.reason or "yes") for r in reports]
    return Table("devices", heads, [tuple(map(cell, row)) for row in rows])


def section(outcome: Outcome) -> str:
    """The section of the page about a step."""
    step, found = outcome.step, outcome.found
    output, errors = (log.name for log in logs(Path(), step.name))
    said = [f"{outcome.state}: {found.complaint}" if found.complaint else "", *found.notes]
    parts = [f"## {step.title[0].upper()}{step.title[1:]}\n", *(f"- {cell(line)}" for line in said if line)]
    tables = [f"\n{table.title}:\n\n{markdown(escaped(table))}" for table in found.tables if table.rows]
    return "\n".join([*parts, *tables, f"\nWhat it printed: `{output}`, `{errors}`.\n"])


def escaped(table: Table) -> Table:
    """The table with its cells escaped for Markdown."""
    return Table(table.title, table.columns, [tuple(map(cell, row)) for row in table.rows])


def cell(value: object) -> str:
    """A value escaped for a line of Markdown."""
    return " ".join(str(value).replace("|", "\\|").split())

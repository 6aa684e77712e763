"""Shows a run as tables of text, the same in the terminal and in the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.results import DeviceRecord, Result, Run
from svgf_cl.bench.rig import EVENT, HOST

# The columns that `limits` fills.
LIMITS = ("roofline %", "bound by", "bytes/px", "loaded/px", "flop/px")


@dataclass(frozen=True)
class Table:
    """A table of texts: words in the first column, mostly numbers in the others."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


def milliseconds(seconds: float) -> str:
    """Return a time given in s as text in ms, with about three significant digits."""
    ms = 1e3 * seconds
    return f"{ms:.3g}" if ms < 1 else f"{ms:.2f}" if ms < 100 else f"{ms:.0f}"


def device_table(run: Run) -> Table:
    """Return a table with a column for each device: its description, its limits if measured, and the error."""
    described = [describe(device) for device in run.devices]
    rows = [(what, *(facts[what] for facts in described)) for what in described[0]]
    title = "ceilings measured in the same run, and the error" if run.has_ceilings else "devices, and the error"
    return Table(title, ("", *(device.platform for device in run.devices)), rows)


def describe(device: DeviceRecord) -> dict[str, str]:
    """Return the texts that describe a device."""
    return {
        "device": device.device,
        "version": device.version,
        "driver": device.driver,
        "compute units": str(device.compute_units),
        "tuning": device.tuning,
        **(describe_ceilings(device.ceilings) if device.ceilings else {}),
        "error to the float64 oracle, rms": f"{device.rms:.1e}",
        "error to the float64 oracle, largest": f"{device.largest:.1e}",
    }


def describe_ceilings(ceilings: Ceilings) -> dict[str, str]:
    """Return the texts that describe a device's limits."""
    return {
        "copy in cache, GB/s": f"{1e-9 * max(speed for _, speed in ceilings.bandwidth):.0f}",
        "copy out of cache, GB/s": f"{1e-9 * ceilings.bandwidth[-1][1]:.0f}",
        "load, aligned, GB/s": f"{1e-9 * ceilings.aligned_loads:.0f}",
        "load, offset by one, GB/s": f"{1e-9 * ceilings.offset_loads:.0f}",
        "multiply-add, GFLOP/s": f"{1e-9 * ceilings.flops:.0f}",
    }


def benchmark_table(run: Run, device: DeviceRecord) -> Table:
    """Return a table of a device's benchmarks, with event and host time side by side, without empty columns."""
    columns = ("benchmark", "event ms", "host ms", *LIMITS, "rounds")
    by_name: dict[str, dict[str, Result]] = {}
    for result in run.of(device):
        if "row" in result.facts:
            by_name.setdefault(result.name, {})[result.clock] = result
    title = f"{device.platform}, {device.device}: median and half the interquartile range"
    return filled(Table(title, columns, [benchmark_row(name, clocks) for name, clocks in by_name.items()]))


def filled(table: Table) -> Table:
    """Return the table without the columns in which nothing was measured."""
    kept = [index for index in range(len(table.columns)) if any(row[index] != "-" for row in table.rows)]
    columns, *rows = (tuple(cells[index] for index in kept) for cells in (table.columns, *table.rows))
    return Table(table.title, columns, rows)


def benchmark_row(name: str, clocks: dict[str, Result]) -> tuple[str, ...]:
    """Return the row of one benchmark, with both clocks; a dash means that it was not measured."""
    event, host = clocks.get(EVENT), clocks.get(HOST)
    rounds = str((event or clocks[HOST]).stats.rounds)
    return (name, spread(event), spread(host), *limits(event), rounds)


def spread(result: Result | None) -> str:
    """Return the median, and half the interquartile range in percent of the median."""
    if result is None:
        return "-"
    return f"{milliseconds(result.median)} ±{50 * result.stats.iqr / result.median:.0f}%"


def limits(result: Result | None) -> tuple[str, ...]:
    """Return how close a row came to its roofline, which limit binds it, and its cost per pixel."""
    if result is None or result.roofline is None:
        return ("-",) * len(LIMITS)
    facts = result.facts
    pixels = facts["width"] * facts["height"]
    share = f"{100 * result.roofline:.0f}", facts["binds"]
    return *share, *(f"{facts[what] / pixels:.0f}" for what in ("bytes", "loaded", "flops"))


def memory_table(run: Run) -> Table:
    """Return a table of the device memory that a denoiser uses."""
    held = {(r.facts["width"], r.facts["height"]): r.facts["planes"] for r in run.results if "planes" in r.facts}
    rows = [(f"{width}x{height}", f"{planes / 1e6:.0f}") for (width, height), planes in held.items()]
    return Table("device memory of a denoiser", ("size", "MB"), rows)

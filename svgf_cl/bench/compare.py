"""Compares two runs: ratios of medians, and differences that make the runs hard to compare."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import geometric_mean

from svgf_cl.bench.results import DeviceRecord, Run
from svgf_cl.bench.tables import Table, milliseconds

Key = tuple[str, str, str]


def comparison(old: Run, new: Run) -> Table:
    """Return a table of the benchmarks that both runs have, with how many times faster the new run is."""
    before, after = medians(old), medians(new)
    rows, ratios = [], []
    for key in after:
        if key in before:
            ratios.append(before[key] / after[key])
            rows.append((*key, milliseconds(before[key]), milliseconds(after[key]), f"{ratios[-1]:.2f}"))
    if ratios:
        rows.append(("geometric mean", "", "", "", "", f"{geometric_mean(ratios):.2f}"))
    columns = ("benchmark", "implementation", "clock", "old ms", "new ms", "times faster")
    return Table(f"compared with {old.revision}, {old.date}", columns, rows)


def differences(old: Run, new: Run) -> list[str]:
    """Return what else differs: devices, drivers, tunings, and benchmarks that only one run has."""
    return [*device_differences(old, new), *name_differences(old, new)]


def medians(run: Run) -> dict[Key, float]:
    """Return the median seconds by name, OpenCL implementation and clock."""
    return {(result.name, run.platforms[result.device], result.clock): result.median for result in run.results}


def device_differences(old: Run, new: Run) -> Iterator[str]:
    """Yield a line for each implementation whose device, driver or tuning differs, or that one run lacks."""
    before, after = by_platform(old), by_platform(new)
    for platform in sorted(before.keys() | after.keys()):
        was, is_ = before.get(platform), after.get(platform)
        if was is None or is_ is None:
            yield f"only the {'new' if was is None else 'old'} run has {platform}"
            continue
        for what in ("device", "driver", "version", "compute_units", "tuning"):
            if getattr(was, what) != getattr(is_, what):
                yield f"{platform}: {what} was {getattr(was, what)}, is {getattr(is_, what)}"


def name_differences(old: Run, new: Run) -> Iterator[str]:
    """Yield a line for each run that has benchmarks that the other lacks."""
    before, after = ({result.name for result in run.results} for run in (old, new))
    if before - after:
        yield f"only in the old run: {', '.join(sorted(before - after))}"
    if after - before:
        yield f"only in the new run: {', '.join(sorted(after - before))}"


def by_platform(run: Run) -> dict[str, DeviceRecord]:
    """Return the devices by OpenCL implementation."""
    return {device.platform: device for device in run.devices}

"""Shows how a frame's time grows with pixels, iterations, signals and cores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from svgf_cl.bench.results import DeviceRecord, Result, Run
from svgf_cl.bench.rig import EVENT
from svgf_cl.bench.tables import Table, milliseconds


@dataclass(frozen=True)
class Series:
    """The times of a frame on one device while one quantity varies.

    Parameters
    ----------
    device : DeviceRecord
    over : tuple of float
        Pixels, iterations, signals or cores, ascending.
    seconds : tuple of float
        Median event times.
    """

    device: DeviceRecord
    over: tuple[float, ...]
    seconds: tuple[float, ...]


def series(run: Run, over: str) -> list[Series]:
    """Return a frame's time over "pixels", "iterations", "signals" or "cores", for devices with two points or more."""
    found = []
    for device in run.devices:
        points = sorted((position(result, over), result.median) for result in frames(run, device, over))
        if len(points) > 1:
            found.append(Series(device, *(tuple(values) for values in zip(*points, strict=True))))
    return found


def frames(run: Run, device: DeviceRecord, over: str) -> list[Result]:
    """Return the results of frames in which only `over` varies."""
    results = run.of(device, row="frame", clock=EVENT)
    return [r for r in results if r.facts["variant"].rstrip("0123456789") == ("" if over == "pixels" else over)]


def position(result: Result, over: str) -> float:
    """Return a frame's position on the axis."""
    facts = result.facts
    return float(facts["width"] * facts["height"] if over == "pixels" else facts[over])


def table(over: str, found: Sequence[Series]) -> Table:
    """Return a table of times, per pixel if `over` is "pixels", and their ratios to the first point."""
    if over == "pixels":
        columns = ["implementation", "pixels", "ms", "ms / Mpixel", "over the first"]
        rows = [row for each in found for row in per_pixel(each)]
    else:
        columns = ["implementation", over, "ms", "over the first"]
        rows = [row for each in found for row in plain(each)]
    return Table(f"a frame's time over {over}", columns, rows)


def per_pixel(each: Series) -> list[tuple[str, ...]]:
    """Return rows with the time per pixel; if the last column is 1, time is linear."""
    per = [seconds / pixels for pixels, seconds in zip(each.over, each.seconds, strict=True)]
    return [
        (each.device.platform, f"{pixels:.0f}", milliseconds(seconds), milliseconds(1e6 * cost), f"{cost / per[0]:.2f}")
        for pixels, seconds, cost in zip(each.over, each.seconds, per, strict=True)
    ]


def plain(each: Series) -> list[tuple[str, ...]]:
    """Return rows with the time, without dividing it."""
    return [
        (each.device.platform, f"{where:.0f}", milliseconds(seconds), f"{seconds / each.seconds[0]:.2f}")
        for where, seconds in zip(each.over, each.seconds, strict=True)
    ]

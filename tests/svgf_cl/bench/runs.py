"""Runs that nobody ran, for tests of what is made of them."""

from __future__ import annotations

from typing import Any

from svgf_cl.bench.ceilings import Ceilings
from svgf_cl.bench.results import DeviceRecord, Result, Run

GIGA = 1e9
CEILINGS = Ceilings([(2**16, 100 * GIGA), (2**29, 10 * GIGA)], 900 * GIGA, 300 * GIGA, 400 * GIGA)


def device(selector: str = "0:0", **other: Any) -> DeviceRecord:
    """A CPU that copies 100 GB/s in cache and 10 GB/s out of it, loads 900 or 300, and computes 400 GFLOP/s."""
    facts = {
        "platform": "Alpha",
        "version": "OpenCL 3.0",
        "device": "a <CPU>",
        "driver": "1.0",
        "compute_units": 2,
        "tuning": "16 wide",
        "rms": 1.5e-7,
        "largest": 9e-7,
        "ceilings": CEILINGS,
    }
    return DeviceRecord(selector=selector, **(facts | other))


def result(row: str, clock: str, *ms: float, on: str = "0:0", **facts: Any) -> Result:
    """Samples in milliseconds of a row of 1280x720 frames, or of what `facts` say."""
    usual = {"variant": "", "width": 1280, "height": 720, "signals": 1, "iterations": 5, "cores": None}
    kernel, _, level = row.partition(" ")
    is_pass = kernel in ("temporal", "variance", "modulate") or level.isdigit()
    part = {"row": row, "kernel": kernel if is_pass else None, "level": int(level) if level.isdigit() else None}
    known = part | usual | facts
    words = ["svgf", *row.split(), known["variant"], f"{known['width']}x{known['height']}"]
    return Result(".".join(filter(None, words)), on, clock, tuple(1e-3 * value for value in ms), known)


def run(*results: Result, devices: tuple[DeviceRecord, ...] = (), left_out: tuple[str, ...] = ()) -> Run:
    """A run on these devices, by default `device`."""
    machine = {"cpu": {"brand_raw": "a CPU"}, "machine": "x", "system": "Linux", "release": "6", "python_version": "3"}
    commit = {"project": "svgf_cl", "version": "0.1.0", "id": "0123456789abcdef", "dirty": True}
    return Run(devices or (device(),), results, left_out, machine, commit, "2026-11-22T08:00:00+00:00")


BOUND = {"bytes": 1e7, "loaded": 2e8, "flops": 1e9, "bound": 4e-3, "binds": "arithmetic"}


def whole_run() -> Run:
    """One of everything that a report shows."""
    frames = [
        result("frame", "event", 10.0 * size, 11.0 * size, width=1280, height=720 * size, planes=10**8, **BOUND)
        for size in (1, 2)
    ]
    variants = [
        result("frame", "event", 10.0 * count, variant=f"{over}{count}", **{over: count})
        for over in ("iterations", "signals", "cores")
        for count in (1, 2)
    ]
    stages = [result(row, "event", 5.0, 8.0, **BOUND) for row in ("temporal", "atrous 1", "atrous 2", "atrous")]
    hosts = [result(row, "host", 6.0, 9.0) for row in ("temporal", "frame", "frame numpy", "enqueue", "start cold")]
    return run(*frames, *variants, *stages, *hosts, left_out=("svgf.frame.9x9 on it: no room",))

"""The tables of `benchmarks.versus_oidn`."""

from __future__ import annotations

from collections.abc import Mapping

from benchmarks.measurements import Quality
from benchmarks.race import Spread, Times, ratio
from svgf_cl.bench.rig import EVENT, HOST
from svgf_cl.bench.tables import Table


def time_table(times: Times, memory: Mapping[str, int]) -> Table:
    """A row for each denoiser and clock: its times, and its memory."""
    rows = []
    for (name, clock), samples in times.items():
        spread = Spread.of(samples)
        milliseconds = [f"{1e3 * value:.1f}" for value in (spread.median, spread.low, spread.high)]
        rows.append([name, clock, *milliseconds, f"{memory[name] / 1e6:.0f}" if clock == HOST else ""])
    return Table("time of a frame, and memory", ("denoiser", "clock", "median ms", "10 %", "90 %", "MB"), rows)


def ratio_table(times: Times) -> Table:
    """A row for each rival: how many times as long it took as svgf_cl, with both clocks."""
    own = {name for name, clock in times if clock == EVENT}
    bases = [key for key in times if key[0] in own]
    rivals = [key for key in times if key[0] not in own]
    rows = [[rival[0], *(f"{ratio(times[rival], times[base]):.2f}" for base in bases)] for rival in rivals]
    columns = ("time of", *(f"over {name}, {clock}" for name, clock in bases))
    return Table("ratios of times of one round: median (10 % - 90 %)", columns, rows)


def error_table(errors: Mapping[str, Quality]) -> Table:
    """A row for each denoiser: its errors."""
    rows = [
        [name, f"{found.psnr:.2f}", f"{found.relmse:.4f}", f"{found.flip:.4f}", f"{found.temporal:.4f}"]
        for name, found in errors.items()
    ]
    return Table("error against the truth", ("", "PSNR dB ↑", "relMSE ↓", "FLIP ↓", "temporal ↓"), rows)

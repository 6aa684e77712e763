"""The tables of `benchmarks.versus_oidn`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from benchmarks.bars import BARS
from benchmarks.measurements import Quality
from benchmarks.race import DEVICE, WHOLE, Spread, ratio

Times = Mapping[str, Sequence[float]]


class Table(NamedTuple):
    """A title over columns of words."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]

    def markdown(self) -> str:
        """As it may stand in docs/results.md."""
        lines = [self.headings, ["---"] * len(self.headings), *self.rows]
        return "\n".join([f"{self.title}:", "", *(f"| {' | '.join(line)} |" for line in lines), ""])


def time_table(times: Times, memory: Mapping[str, int]) -> Table:
    """One row a denoiser: its times and its memory."""
    rows = []
    for name, samples in times.items():
        spread = Spread.of(samples)
        milliseconds = [f"{value:.1f}" for value in (spread.median, spread.low, spread.high)]
        rows.append([name, *milliseconds, f"{memory[name] / 2**20:.0f}" if name in memory else ""])
    return Table("Time of a frame, and memory", ("denoiser", "median ms", "10 %", "90 %", "MiB"), rows)


def ratio_table(times: Times) -> Table:
    """One row a rival: how many times as long it took."""
    rivals = [name for name in times if name not in (WHOLE, DEVICE)]
    rows = [[name, *(f"{ratio(times[name], times[base]):.2f}" for base in (WHOLE, DEVICE))] for name in rivals]
    return Table("Ratios of times of one round, median (10-90 %)", ("time of", f"/ {WHOLE}", f"/ {DEVICE}"), rows)


def bar_table(times: Times) -> Table:
    """One row a bar: the ratios that are held against it, and whether it holds."""
    rows = []
    for bar in BARS:
        found = [ratio(times[bar.rival], times[base]) for base in (WHOLE, DEVICE)]
        rows.append([str(bar), *(f"{spread.median:.2f} {bar.verdict(spread)}" for spread in found)])
    return Table("Bars: so many times faster at least", ("", WHOLE, DEVICE), rows)


def error_table(errors: Mapping[str, Quality]) -> Table:
    """One row a denoiser: its errors."""
    rows = [
        [name, f"{found.psnr:.2f}", f"{found.relmse:.4f}", f"{found.flip:.4f}", f"{found.temporal:.4f}"]
        for name, found in errors.items()
    ]
    return Table("Error against the truth", ("", "PSNR dB ↑", "relMSE ↓", "FLIP ↓", "temporal ↓"), rows)

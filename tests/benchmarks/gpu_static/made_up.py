"""Rows that no compiler made."""

from __future__ import annotations

from benchmarks.gpu_static.gate import Row
from benchmarks.gpu_static.usage import Instructions, Usage

COUNTED = Instructions(total=100, loads=10, stores=2, integer=30)


def row(
    kernel: str, architecture: str, registers: int, *, variant: str = "any", spills: int = 0, scratch: int = 0
) -> Row:
    scalars = 20 if architecture.startswith("gfx") else None
    return Row("atrous", kernel, variant, architecture, Usage(registers, scalars, spills, scratch), COUNTED)

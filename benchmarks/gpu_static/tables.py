"""Results as text: all kernels in all variants, and each kernel in its most usual variant."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict

from benchmarks.gpu_static.gate import ARCHITECTURES, Row

COLUMNS = ("kernel", "variant", "on", "registers", "scalars", "spills", "scratch", "occupancy", "instructions")
COUNTED = ("loads", "stores", "integer")


def document(rows: Iterable[Row], about: Mapping[str, str]) -> str:
    """All results as JSON."""
    entries = [asdict(row) | {"occupancy": row.occupancy} for row in rows]
    return json.dumps({"about": dict(about), "kernels": entries}, indent=1)


def every(rows: Iterable[Row]) -> list[list[str]]:
    """A row for each kernel and variant, with `COLUMNS` and `COUNTED`."""
    return [
        [
            row.name,
            row.variant,
            row.architecture,
            str(row.usage.registers),
            "" if row.usage.scalars is None else str(row.usage.scalars),
            str(row.usage.spills),
            str(row.usage.scratch),
            f"{row.occupancy:.0%}",
            str(row.instructions.total),
            *(str(getattr(row.instructions, name)) for name in COUNTED),
        ]
        for row in rows
    ]


def usual(rows: Sequence[Row]) -> list[list[str]]:
    """Each kernel in the first variant that has it.

    A column for each architecture: registers, occupancy, instructions.
    """
    first = most_usual(rows)
    names = dict.fromkeys(row.name for row in rows)
    return [[name, *(cell(first.get((name, each))) for each in ARCHITECTURES)] for name in names]


def integer_share(rows: Sequence[Row], name: str) -> str:
    """The share of integer arithmetic in a kernel's instructions, on each architecture."""
    counted = {row.architecture: row.instructions for row in most_usual(rows).values() if row.name == name}
    return ", ".join(f"{architecture} {each.integer / each.total:.0%}" for architecture, each in counted.items())


def most_usual(rows: Sequence[Row]) -> dict[tuple[str, str], Row]:
    """The first row of each kernel and architecture."""
    first: dict[tuple[str, str], Row] = {}
    for row in rows:
        first.setdefault((row.name, row.architecture), row)
    return first


def cell(row: Row | None) -> str:
    """The cell of a row; empty if the kernel did not compile."""
    return f"{row.usage.registers}, {row.occupancy:.0%}, {row.instructions.total}" if row else ""

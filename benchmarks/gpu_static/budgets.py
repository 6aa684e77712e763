"""The recorded budgets: for each kernel and architecture, the most registers that any of its variants needed."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from benchmarks.gpu_static.gate import Row
from svgf_cl.errors import FileError
from svgf_cl.io.atomic import read_json, unreadable, write_text

FILE = Path(__file__).with_name("budgets.json")
RECORD = "'python -m benchmarks.gpu_static --record' records what is found"
COMPILERS = "compilers"  # the key of the compilers' versions, beside those of the kernels

Budgets = Mapping[str, Mapping[str, int]]  # registers by architecture, for each kernel


def of(rows: Iterable[Row]) -> dict[str, dict[str, int]]:
    """The most registers of each kernel on each architecture."""
    found: dict[str, dict[str, int]] = {}
    for row in rows:
        most = found.setdefault(row.name, {})
        most[row.architecture] = max(most.get(row.architecture, 0), row.usage.registers)
    return {name: found[name] for name in sorted(found)}


def exceeded(rows: Iterable[Row], budgets: Budgets) -> Iterator[str]:
    """Rows that exceed their budgets, and budgets that are missing or that belong to no kernel."""
    rows = list(rows)
    for row in rows:
        budget = budgets.get(row.name, {}).get(row.architecture)
        if budget is not None and row.usage.registers > budget:
            yield (
                f"{row.place}: expected at most {budget} registers, found {row.usage.registers}; "
                f"keep fewer values alive at a time, or, if it is worth them, {RECORD}"
            )
    compiled = pairs(of(rows))
    recorded = pairs(budgets)
    for name, architecture in sorted(compiled - recorded):
        yield f"{name} on {architecture}: expected a budget of registers in {FILE.name}, found none; {RECORD}"
    for name, architecture in sorted(recorded - compiled):
        yield f"{name} on {architecture}: expected a kernel, found a budget in {FILE.name} alone; {RECORD}"


def pairs(budgets: Budgets) -> set[tuple[str, str]]:
    """Kernels and architectures with a budget."""
    return {(name, architecture) for name, by_architecture in budgets.items() for architecture in by_architecture}


def read(path: Path) -> tuple[Budgets, Mapping[str, str]]:
    """Read budgets, and the versions of the compilers with which they were recorded.

    Raises
    ------
    FileError
        If it cannot be read, or contains something else.
    """
    try:
        document = read_json(path)
        compilers = {str(name): str(version) for name, version in document.pop(COMPILERS).items()}
        kernels = {
            str(name): {str(architecture): int(registers) for architecture, registers in each.items()}
            for name, each in document.items()
        }
    except OSError as error:
        raise unreadable(path, error) from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise FileError(f"{path}: expected budgets, got something else ({error!r}); {RECORD}") from error
    return kernels, compilers


def record(path: Path, rows: Iterable[Row], compilers: Mapping[str, str]) -> None:
    """Write the registers found as budgets, one kernel per line."""
    entries = {COMPILERS: dict(compilers), **of(rows)}
    lines = ",\n".join(f" {json.dumps(name)}: {json.dumps(entry)}" for name, entry in entries.items())
    write_text(path, f"{{\n{lines}\n}}\n")

"""``python -m benchmarks.gpu_static``: compiles every kernel for GPUs and checks limits; it needs no GPU."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.command import run as run_command
from benchmarks.gpu_static import budgets, gate, tables, tools, variants
from benchmarks.markdown import markdown
from svgf_cl.bench.results import commit_info
from svgf_cl.cli.console import progress_bar, show
from svgf_cl.io.atomic import output_folder, write_text

ADDRESSED = "atrous/atrous"  # the kernel with the most taps, for which the share of address arithmetic is shown
TITLE = "registers, occupancy and instructions of each kernel in its most usual variant"
SUMMARY = ("kernel", *gate.ARCHITECTURES)
SHOWN = 20  # the most faults to print; a broken header breaks every kernel


def gpu_static(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Gets kernels.json, kernels.md and summary.md.")
    ] = Path("out/gpu_static"),
    record: Annotated[bool, typer.Option("--record", help="Record the registers found as the new budgets.")] = False,
) -> None:
    """Compile every kernel for GPUs of NVIDIA and AMD and to SPIR-V, on a machine without a GPU.

    The exit code is 1 if a kernel spills registers, needs scratch memory, does not compile, is not a valid module, or
    needs more registers than budgets.json allows.
    """
    compilers = tools.find()
    folder = output_folder(output)
    builds = variants.variants()
    start = time.monotonic()
    with progress_bar("compiling", len(builds) * len(gate.TARGETS)) as advance:
        outcomes = gate.compile_all(compilers, builds, advance)
    rows = gate.rows(compilers, outcomes)
    refused = [outcome.fault for outcome in outcomes if outcome.fault]
    faults = [*refused, *(fault for row in rows for fault in row.faults())]
    write(folder, rows, about(compilers.versions))
    show(TITLE, SUMMARY, tables.usual(rows))
    print(integer(rows))
    print(f"{len(builds)} variants for {len(gate.TARGETS)} targets, compiled in {time.monotonic() - start:.0f} s")
    print(f"{folder}: kernels.json, kernels.md, summary.md")
    if record and not refused:  # the registers of a kernel that does not compile are unknown
        budgets.record(budgets.FILE, rows, compilers.versions)
        print(f"recorded in {budgets.FILE}")
    elif not record:
        faults += over_budget(rows, compilers.versions)
    if faults:
        report(faults)
        raise typer.Exit(1)


def over_budget(rows: Sequence[gate.Row], versions: Mapping[str, str]) -> list[str]:
    """The kernels that exceed the recorded budgets, and a note if the compilers differ."""
    recorded, compilers = budgets.read(budgets.FILE)
    faults = list(budgets.exceeded(rows, recorded))
    others = [f"{name} {versions[name]} is not {then}" for name, then in compilers.items() if versions[name] != then]
    if faults and others:
        faults.append(f"the budgets were recorded with other compilers, which may be the reason: {', '.join(others)}")
    return faults


def about(versions: Mapping[str, str]) -> dict[str, str]:
    """What was compiled, with which compilers, and when."""
    commit = commit_info()
    changed = " with changes" if commit["dirty"] else ""
    return {
        "svgf_cl": f"{commit['version']}, git {commit['id'][:7]}{changed}",
        "date": date.today().isoformat(),
        **versions,
    }


def write(folder: Path, rows: Sequence[gate.Row], about: Mapping[str, str]) -> None:
    """Write all tables."""
    header = ", ".join(f"{name} {value}" for name, value in about.items())
    every = markdown((*tables.COLUMNS, *tables.COUNTED), tables.every(rows))
    write_text(folder / "kernels.json", tables.document(rows, about))
    write_text(folder / "kernels.md", f"{header}\n\n{every}")
    write_text(folder / "summary.md", f"{header}\n\n{markdown(SUMMARY, tables.usual(rows))}\n{integer(rows)}\n")


def integer(rows: Sequence[gate.Row]) -> str:
    """The share of address arithmetic in the a-trous filter."""
    return f"integer arithmetic in {ADDRESSED}: {tables.integer_share(rows, ADDRESSED)} of its instructions"


def report(faults: Sequence[str]) -> None:
    """Print faults, the first ones completely."""
    print(f"\ngpu_static: {len(faults)} faults")
    for fault in faults[:SHOWN]:
        print(f"- {fault}")
    if len(faults) > SHOWN:
        print(f"- and {len(faults) - SHOWN} more")


def main() -> None:
    """Run the command."""
    run_command(gpu_static, "benchmarks.gpu_static")


if __name__ == "__main__":
    main()

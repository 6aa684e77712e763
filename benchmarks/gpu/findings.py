"""Reads the results of each step of a run as tables."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from benchmarks import accuracy_page
from benchmarks.gpu.child import Ended
from svgf_cl.bench import tables
from svgf_cl.bench.results import Run
from svgf_cl.bench.tables import Table
from svgf_cl.errors import one_line
from svgf_cl.io.atomic import read_json

OUTCOMES = ("passed", "failed", "skipped")
INTERRUPTED = 2  # pytest's exit code
FAULTS = ("failure", "error")


@dataclass(frozen=True)
class Found:
    """The result of a step.

    Parameters
    ----------
    tables : sequence of Table
    notes : sequence of str
        What was left out, and other remarks.
    complaint : str
        The reason why the step counts as failed; empty if it does not.
    data : dict
        The same data for programs, for ``report.json``.
    """

    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()
    complaint: str = ""
    data: dict[str, Any] = field(default_factory=dict)


def tests(result: Path, ended: Ended) -> Found:
    """The result of pytest's JUnit XML: how many tests of each file passed, and why others failed."""
    cases = [case for case in ElementTree.parse(result).getroot().iter("testcase") if has_ended(case, ended)]
    if not cases:
        raise ValueError("no test ran")
    counts: dict[str, Counter[str]] = {}
    for case in cases:
        counts.setdefault(case.get("classname", ""), Counter())[outcome(case)] += 1
    rows = [(name, *(str(found[each]) for each in OUTCOMES)) for name, found in sorted(counts.items())]
    total: Counter[str] = sum(counts.values(), Counter())
    failed = [f"{case.get('classname')}::{case.get('name')}: {reason(case)}" for case in cases if faults(case)]
    complaint = f"{total['failed']} of {len(cases)} tests failed" if failed else ""
    if not failed and ended.code not in (0, INTERRUPTED, None):
        complaint = f"pytest ended with exit code {ended.code}"
    short = [f"cut short after {ended.seconds:.0f} s, when {len(cases)} tests had run"] if ended.is_short else []
    heads = ("tests", *OUTCOMES)
    return Found(
        [Table("kernels against the oracle", heads, rows)], [*short, *failed], complaint, {"counts": dict(total)}
    )


def has_ended(case: ElementTree.Element, ended: Ended) -> bool:
    """Whether a test ran to its end; pytest lists an interrupted test as if it had, but without a time."""
    return not ended.is_short or float(case.get("time", 0)) > 0 or len(case) > 0


def outcome(case: ElementTree.Element) -> str:
    """The result of a test."""
    return "failed" if faults(case) else "passed" if case.find("skipped") is None else "skipped"


def faults(case: ElementTree.Element) -> list[ElementTree.Element]:
    """The failures and errors of a test, if any."""
    return [fault for kind in FAULTS for fault in case.findall(kind)]


def reason(case: ElementTree.Element) -> str:
    """The reason of a test's failure, in one line."""
    return one_line(faults(case)[0].get("message", ""))[:300]


def tune(result: Path, ended: Ended) -> Found:
    """The result of ``svgf-cl tune --json``: every tuning that was tried, and the best one."""
    found = read_json(result)
    rows = [
        (
            trial["tuning"],
            *(figure(trial[key], spec) for key, spec in (("ms", ".3f"), ("ratio", ".3f"))),
            trial["fault"],
        )
        for trial in found["trials"]
    ]
    table = Table(f"tunings at {found['size']}, in the order tried", ("tuning", "ms", "time/default", "rejected"), rows)
    doubts = [f"nothing is stored: {doubt}" for doubt in found["doubts"]]
    short = [f"cut short after {ended.seconds:.0f} s"] if ended.is_short else []
    return Found([table], [*short, found["verdict"], *doubts], data=found)


def figure(value: float | None, spec: str) -> str:
    """A number, or a dash if there is none."""
    return "-" if value is None else format(value, spec)


def bench(result: Path, ended: Ended) -> Found:
    """The result of ``svgf-cl bench``: ceilings, error, and times of all passes; its own report is beside its JSON."""
    run = Run.read(result)
    shown = [tables.device_table(run), *(tables.benchmark_table(run, device) for device in run.devices)]
    notes = [f"left out: {line}" for line in run.left_out]
    return Found(
        [*shown, tables.memory_table(run)], notes, data={"results": str(result.relative_to(result.parents[1]))}
    )


def accuracy(result: Path, ended: Ended) -> Found:
    """The result of ``benchmarks.accuracy_page --here``: the largest error of each kernel."""
    if ended.code:
        raise ValueError(f"exit code {ended.code}")
    figures = json.loads(ended.output.splitlines()[-1])
    device = {figures["device"].partition(",")[0]: figures}
    return Found([accuracy_page.kernel_table(device), accuracy_page.whole_table(device)], data=figures)

"""The report says what ran where, what each step found, and what failed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.gpu import findings, report
from benchmarks.gpu.child import Ended
from benchmarks.gpu.findings import Found
from benchmarks.gpu.report import Outcome, Report
from benchmarks.gpu.steps import Step
from svgf_cl.bench.tables import Table
from svgf_cl.device.devices import DeviceReport, list_devices

TABLE = Table("times", ("pass", "ms"), [("a|b", "1.5")])


def outcome(name: str, found: Found, code: int | None = 0) -> Outcome:
    step = Step(name, f"the step {name}", ("a", "b"), 60, Path(name), findings.tune)
    return Outcome(step, Ended(code, 12.3, "", ""), found)


@pytest.fixture
def written(tmp_path: Path) -> Report:
    reports = list_devices()
    device = next(each for each in reports if each.works)
    made = Report(reports, device, dry_run=False)
    made.outcomes += [
        outcome("one", Found([TABLE], ["a note"])),
        outcome("two", Found(complaint="exit code 1: it crashed"), 1),
        outcome("three", Found([TABLE], ["cut short after 60 s"]), None),
    ]
    made.write(tmp_path)
    return made


def test_the_page_holds_all(written: Report, tmp_path: Path) -> None:
    page = (tmp_path / "report.md").read_text()
    assert page.startswith(f"# {written.device.device}: svgf_cl on a GPU\n")
    assert report.PLEASE in page
    for line in (
        "| one | the step one | done | 12 of 60 |  |",
        "| two | the step two | failed | 12 of 60 | exit code 1: it crashed |",
        "| three | the step three | cut short | 12 of 60 |  |",
        "| a\\|b | 1.5 |",
        "- a note",
        "- failed: exit code 1: it crashed",
        "- cut short after 60 s",
        "What it printed: `two.out.txt`, `two.err.txt`.",
        f"| driver_version | {written.device.driver} |",
    ):
        assert line in page.splitlines(), line
    assert all(f"| {name} | " in page for name in ("svgf_cl", "date", "pyopencl", "numpy", "system", "cores"))


def test_the_file_for_programs_holds_all(written: Report, tmp_path: Path) -> None:
    found = json.loads((tmp_path / "report.json").read_text())
    assert [step["state"] for step in found["steps"]] == ["done", "failed", "cut short"]
    assert found["steps"][0]["tables"][0]["rows"] == [["a|b", "1.5"]]
    assert found["facts"]["name"] == written.device.handle.name
    assert found["dry_run"] is False
    assert len(found["devices"]["rows"]) == len(written.reports)


def test_what_failed_is_named(written: Report) -> None:
    assert written.failed == ["two"]


def test_a_dry_run_says_that_its_times_mean_nothing(tmp_path: Path) -> None:
    reports = list_devices()
    Report(reports, next(each for each in reports if each.works), dry_run=True).write(tmp_path)
    page = (tmp_path / "report.md").read_text()
    assert page.startswith("# svgf_cl: a dry run\n")
    assert report.DRY in page


def test_what_a_driver_does_not_say_is_unknown() -> None:
    silent = DeviceReport("0:0", "A", "", "G", "1", "GPU", "", handle=None)
    assert report.facts(silent)["name"].startswith("unknown (")

"""What steps leave is read as tables, and what is wrong with it is told."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks import accuracy_page
from benchmarks.gpu import findings
from benchmarks.gpu.child import Ended
from benchmarks.gpu.findings import Found
from tests.svgf_cl.bench.runs import whole_run

ENDED = Ended(0, 12.0, "", "")
STOPPED = Ended(None, 60.0, "", "")

JUNIT = """<testsuites><testsuite>
<testcase classname="tests.kernels.test_atrous" name="test_a[plain]" time="0.1"/>
<testcase classname="tests.kernels.test_atrous" name="test_a[full]"><skipped message="no"/></testcase>
<testcase classname="tests.kernels.test_taa" name="test_b" time="{time}">{fault}</testcase>
</testsuite></testsuites>"""


def junit(path: Path, fault: str, ended: Ended, time: str = "0.1") -> Found:
    path.write_text(JUNIT.format(fault=fault, time=time))
    return findings.tests(path, ended)


def test_tests_are_counted_by_file(tmp_path: Path) -> None:
    found = junit(tmp_path / "a.xml", "", ENDED)
    assert found.tables[0].rows == [
        ("tests.kernels.test_atrous", "1", "0", "1"),
        ("tests.kernels.test_taa", "1", "0", "0"),
    ]
    assert (found.complaint, found.notes) == ("", [])
    assert found.data == {"counts": {"passed": 2, "skipped": 1}}


@pytest.mark.parametrize("kind", ["failure", "error"])
def test_a_test_that_failed_is_named_with_the_reason(kind: str, tmp_path: Path) -> None:
    fault = f'<{kind} message="AssertionError:&#10; off by 2">long</{kind}>'
    found = junit(tmp_path / "a.xml", fault, Ended(1, 12.0, "", ""))
    assert found.complaint == "1 of 3 tests failed"
    assert found.notes == ["tests.kernels.test_taa::test_b: AssertionError: off by 2"]


def test_tests_that_were_cut_short_say_how_many_had_run(tmp_path: Path) -> None:
    found = junit(tmp_path / "a.xml", "", STOPPED)
    assert found.notes == ["cut short after 60 s, when 3 tests had run"]
    assert found.complaint == ""


def test_a_test_that_was_interrupted_counts_for_nothing(tmp_path: Path) -> None:
    """As pytest writes it: without any time, and as if it had passed."""
    found = junit(tmp_path / "a.xml", "", STOPPED, time="0.000")
    assert found.data == {"counts": {"passed": 1, "skipped": 1}}
    assert junit(tmp_path / "a.xml", "", ENDED, time="0.000").data == {"counts": {"passed": 2, "skipped": 1}}


def test_pytest_that_breaks_off_has_failed_though_no_test_has(tmp_path: Path) -> None:
    assert junit(tmp_path / "a.xml", "", Ended(3, 1.0, "", "")).complaint == "pytest ended with exit code 3"


def test_no_test_at_all_is_no_result(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text("<testsuites/>")
    with pytest.raises(ValueError, match="no test ran"):
        findings.tests(tmp_path / "a.xml", ENDED)


def test_tunings_are_shown_in_the_order_tried(tmp_path: Path) -> None:
    trials = [
        {"tuning": "vectors of 1", "ms": 0.5, "ratio": 1.0, "fault": ""},
        {"tuning": "vectors of 4", "ms": None, "ratio": None, "fault": "wrong"},
    ]
    found = {"size": "64x36", "verdict": "the default stays", "doubts": ["no time"], "trials": trials}
    (tmp_path / "tune.json").write_text(json.dumps(found))
    read = findings.tune(tmp_path / "tune.json", Ended(1, 5.0, "", ""))
    assert read.tables[0].rows == [("vectors of 1", "0.500", "1.000", ""), ("vectors of 4", "-", "-", "wrong")]
    assert read.notes == ["the default stays", "nothing is stored: no time"]
    assert read.complaint == ""


def test_the_benchmarks_tables_are_those_of_bench(tmp_path: Path) -> None:
    (tmp_path / "bench").mkdir()
    whole_run().write(tmp_path / "bench" / "results.json")
    found = findings.bench(tmp_path / "bench" / "results.json", ENDED)
    assert len(found.tables) == 2 + len(whole_run().devices)
    assert found.data == {"results": "bench/results.json"}


def test_errors_are_read_behind_what_libraries_print(tmp_path: Path) -> None:
    row = dict.fromkeys(accuracy_page.COLUMNS, 1e-6)
    figures = {"device": "G, OpenCL 3.0", "kernels": {"atrous": row}, "whole": {"kalman": [1e-3, 1e-5]}}
    found = findings.accuracy(tmp_path, Ended(0, 1.0, f"compiling\n{json.dumps(figures)}\n", ""))
    assert found.tables[0].rows == [("atrous", "G", *["1.0e-06"] * 4)]
    assert found.tables[1].rows == [("kalman", "G", "1.0e-05", "1.0e-03", "G, OpenCL 3.0")]
    with pytest.raises(ValueError, match="exit code 1"):
        findings.accuracy(tmp_path, Ended(1, 1.0, json.dumps(figures), ""))

"""What is written can be read, by pytest-benchmark too."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from svgf_cl import SvgfError, __version__
from svgf_cl.bench.results import Run, commit_info
from tests.svgf_cl.bench.runs import BOUND, device, result, run, whole_run


def test_a_run_comes_back(tmp_path: Path) -> None:
    written = whole_run()
    written.write(tmp_path / "results.json")
    read = Run.read(tmp_path / "results.json")
    assert read.results == written.results
    assert (read.commit, read.machine, read.date) == (written.commit, written.machine, written.date)
    assert read.left_out == written.left_out
    was, is_ = written.devices[0].ceilings, read.devices[0].ceilings
    assert was
    assert is_
    assert is_.bandwidth_at(2**16) == was.bandwidth_at(2**16)
    assert is_.flops == was.flops


def test_a_run_without_ceilings_comes_back(tmp_path: Path) -> None:
    without = run(result("temporal", "event", 1.0), devices=(device(ceilings=None),))
    without.write(tmp_path / "results.json")
    assert Run.read(tmp_path / "results.json") == without


def test_pytest_benchmark_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    whole_run().write(path)
    command = [sys.executable, "-m", "pytest_benchmark", "compare", str(path)]
    told = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert "svgf.temporal.1280x720" in told.stdout


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"machine_info": {}}', json.dumps({"benchmarks": []})])
def test_another_file_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SvgfError, match=r"other\.json: expected the results\.json of 'svgf-cl bench'"):
        Run.read(path)


def test_no_file() -> None:
    with pytest.raises(SvgfError, match="cannot be read"):
        Run.read(Path("/nowhere/results.json"))


def test_medians_and_the_share_of_the_roofline() -> None:
    timed = result("temporal", "event", 8.0, 5.0, 6.0, **BOUND)
    assert timed.median == pytest.approx(6e-3)
    assert timed.roofline == pytest.approx(4 / 5), "of the fastest sample"
    assert result("temporal", "host", 1.0).roofline is None


def test_results_are_found_by_clock_and_facts() -> None:
    ours = run(
        result("temporal", "event", 1.0), result("temporal", "host", 1.0), result("frame", "event", 1.0, on="1:0")
    )
    assert list(ours.of(ours.devices[0], clock="host")) == [ours.results[1]]
    assert list(ours.of(ours.devices[0], row="frame")) == []


def test_the_revision_is_this_source() -> None:
    info = commit_info()
    assert info["version"] == __version__
    assert info["id"] == "unknown" or len(info["id"]) == 40
    assert run().revision == "0.1.0 (git 0123456789ab with changes)"

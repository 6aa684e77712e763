"""A run's findings say all that has to be known, wherever they are shown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
from benchmarks.findings import TITLE, Findings
from benchmarks.measurements import Quality, Result, Times
from benchmarks.variants import Variant
from svgf_cl import Kalman

FINDINGS = Findings(
    [
        Result(Variant("default"), Times(50, 55), 1e-7, 1e-6, {"area": Quality(31, 0.01, 0.05, 0.008)}),
        Result(Variant("cheap"), Times(20, 25), 1e-3, 1e-2, {"area": Quality(29, 0.02, 0.06, 0.009)}),
    ],
    {"area": Quality(40, 0.001, 0.02, 0.004)},
    {"device": "a device", "size": "1280x720"},
)


def test_each_kind_of_error_has_its_table() -> None:
    assert [table.title for table in FINDINGS.tables] == ["error against the oracle", "error against the truth, area"]
    assert [len(table.rows) for table in FINDINGS.tables] == [2, 2]


def test_the_page_holds_every_figure_the_noise_and_the_device() -> None:
    page = FINDINGS.page
    for text in ("50.0", "1.00e-03", "29.00", "0.0600", "halves differ by PSNR 40.0 dB", "device: a device"):
        assert text in page


def test_files_are_written(tmp_path: Path) -> None:
    FINDINGS.write(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"results.json", "table.md", "plot.png"}
    record = json.loads((tmp_path / "results.json").read_text())
    assert record["results"][1]["variant"]["settings"]["iterations"] == Kalman().iterations
    assert record["results"][1]["quality"]["area"]["psnr"] == 29


def test_the_section_holds_plot_tables_and_remarks() -> None:
    section = FINDINGS.section
    assert section.title == TITLE
    assert "data:image/png;base64,iVBOR" in section.figure
    assert section.tables == FINDINGS.tables
    assert "device: a device" in section.notes

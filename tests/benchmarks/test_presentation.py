"""Figures appear as measured, and those on the Pareto front are marked."""

from __future__ import annotations

import io

import pytest
from PIL import Image

pytest.importorskip("matplotlib")
from benchmarks import presentation
from benchmarks.measurements import Quality, Result, Times
from benchmarks.presentation import oracle_column, quality_columns, table
from benchmarks.variants import Variant


def result(name: str, device: float, rms: float, psnr: float | None) -> Result:
    quality = {} if psnr is None else {"area": Quality(psnr, 0.01, 0.05, 0.008)}
    return Result(Variant(name), Times(device, device + 5), rms, 10 * rms, quality)


RESULTS = [
    result("slow and good", 50.04, 1.52e-7, 31.5),
    result("fast and bad", 20, 3e-4, 29.5),
    result("slow and bad", 50.01, 3e-4, None),
]


def test_more_decibels_and_less_error_are_better() -> None:
    psnr, relmse, *_ = quality_columns("area")
    assert psnr.front(RESULTS) == [RESULTS[1], RESULTS[0]]
    assert relmse.front(RESULTS) == [RESULTS[1]]
    assert oracle_column().front(RESULTS) == [RESULTS[1], RESULTS[0]]


def test_what_does_not_show_when_printed_puts_nothing_on_the_front() -> None:
    slower_but_equal = [RESULTS[1], result("no better", 21, 3.001e-4, 29.504)]
    assert oracle_column().front(slower_but_equal) == [RESULTS[1]]
    assert quality_columns("area")[0].front(slower_but_equal) == [RESULTS[1]]


def test_the_table_marks_the_front_and_leaves_out_what_was_not_measured() -> None:
    found = table("title", RESULTS, [oracle_column(), quality_columns("area")[0]])
    assert found.columns == ["variant", "device ms", "frame ms", "oracle rms ↓", "area PSNR dB ↑"]
    assert found.rows == [
        ["1 slow and good", "50.0", "55.0", "1.52e-07 •", "31.50 •"],
        ["2 fast and bad", "20.0", "25.0", "3.00e-04 •", "29.50 •"],
        ["3 slow and bad", "50.0", "55.0", "3.00e-04", ""],
    ]
    assert len(table("title", RESULTS, quality_columns("area")).rows) == 2
    lines = presentation.markdown(found).splitlines()
    assert lines[1] == "| --- | --- | --- | --- | --- |"
    assert len(lines) == 5


def test_the_plot_is_a_picture() -> None:
    with Image.open(io.BytesIO(presentation.plot(RESULTS, ["area", "centre"], "title"))) as picture:
        assert picture.width > picture.height > 500

"""The split as a picture, and the section of the report."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from benchmarks.tracing.picture import draw, section, write
from benchmarks.tracing.split import PARTS
from tests.benchmarks.tracing.made_up import tracer_results


def test_every_part_has_its_length_and_colour() -> None:
    axes = Figure().add_subplot()
    draw(axes, tracer_results())
    assert [text.get_text() for text in axes.get_legend().get_texts()] == list(PARTS)
    bars = [patch for container in axes.containers for patch in container]
    assert [bar.get_width() for bar in bars] == pytest.approx([10.0] * len(PARTS))
    assert [bar.get_x() for bar in bars] == pytest.approx([10.0 * number for number in range(len(PARTS))])
    assert len({bar.get_facecolor() for bar in bars}) == len(PARTS)


def test_it_is_written(tmp_path: Path) -> None:
    write(tracer_results(), tmp_path / "split.png")
    assert (tmp_path / "split.png").read_bytes().startswith(b"\x89PNG")
    assert [path.name for path in tmp_path.iterdir()] == ["split.png"]


def test_the_section_of_the_report() -> None:
    found = section(tracer_results())
    assert found.title == "The tracer: box"
    assert "G-buffer" in found.figure
    assert len(found.tables) == 5

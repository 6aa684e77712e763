"""Tables where the output is a file, a narrow terminal, ASCII alone, full, broken or closed."""

from __future__ import annotations

import io
import subprocess
import sys

import pytest

from svgf_cl.cli.console import NARROW, WIDE, screen, show

NUMBERS = ("0.123456789", "1234567.89", "-12.5")


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("columns", "width"), [("1", NARROW), ("20", NARROW), ("100", 100)])
def test_a_narrow_terminal_loses_no_number(
    columns: str, width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    monkeypatch.setenv("COLUMNS", columns)
    assert screen().width == width
    show("title", ("name", "first number", "second number", "third number"), [("a", *NUMBERS)])
    assert all(number in terminal.getvalue() for number in NUMBERS)


def test_a_file_gets_wide_lines() -> None:
    assert screen().width == WIDE


def test_a_table_in_ascii(monkeypatch: pytest.MonkeyPatch) -> None:
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, "ascii", "strict", write_through=True))
    show("title", ("name", "number"), [("a", "1.5")])
    assert b"| a" in written.getvalue()


def test_a_closed_output_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    show("title", ("name", "number"), [("a", "1.5")])


@pytest.mark.parametrize(
    ("output", "codes", "said"),
    [("| true", (0, 1), ""), ("> /dev/full", (2,), "svgf-cl: output: No space left on device\n"), (">&-", (0,), "")],
)
def test_an_output_that_takes_nothing_ends_in_one_line_at_most(output: str, codes: tuple[int, ...], said: str) -> None:
    svgf_cl = f"{sys.executable} -m svgf_cl --help"
    child = subprocess.run(
        ["bash", "-c", f"{svgf_cl} {output}; exit ${{PIPESTATUS[0]}}"], capture_output=True, text=True, check=False
    )
    assert child.stderr == said
    assert child.returncode in codes  # a reader may be gone before anything is written, or behind it

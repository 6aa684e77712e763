"""``svgf-cl devices`` as people use it."""

from __future__ import annotations

import pytest

from tests.command_line import run


def test_devices_marks_a_default_that_works(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("devices") == 0
    marked = [line for line in capsys.readouterr().out.splitlines() if "*" in line]
    assert len(marked) == 1
    assert "yes" in marked[0]

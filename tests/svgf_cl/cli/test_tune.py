"""``svgf-cl tune`` as people use it."""

from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl.bench import tuner
from svgf_cl.device import tuning
from tests.command_line import run


def test_tune_stores_what_it_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tuning, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(tuner, "CHOICES", {"vector_width": (4, 8, 16), "row_alignment": (16, 256)})
    assert run("tune", "--size", "32x18") == 0
    assert f"stored in {tmp_path / tuning.STORE}" in capsys.readouterr().out
    assert run("devices") == 0
    assert "tuned: vectors of" in capsys.readouterr().out
    assert run("tune", "--reset") == 0
    assert run("devices") == 0
    assert "tuned: vectors of" not in capsys.readouterr().out

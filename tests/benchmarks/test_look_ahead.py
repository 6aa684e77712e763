"""The measurement of looking ahead as a command: what it prints, writes and refuses."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks import look_ahead
from svgf_cl import Denoiser, motion_to_next
from svgf_cl.io.synthetic import room_frames

WAYS = ["forward", "backward", "both, 1 ahead", "both, whole shot", "Open Image Denoise"]


def run(monkeypatch: pytest.MonkeyPatch, *argv: str | Path) -> int:
    """Exit code of the program."""
    monkeypatch.setattr(sys, "argv", ["look_ahead", *map(str, argv)])
    with pytest.raises(SystemExit) as left:
        look_ahead.main()
    return int(left.value.code or 0)


def test_it_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    pytest.importorskip("flip_evaluator")
    monkeypatch.setattr(look_ahead, "AHEAD", (1,))
    options = ["--size", "32x18", "--frames", "3", "--spp", "32", "--markdown", "-o", tmp_path]
    assert run(monkeypatch, "cornell", *options) == 0
    lines = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
    heads, _, *rows = lines
    assert [row[:2] for row in rows] == [["cornell", way] for way in WAYS]
    psnr = [float(row[heads.index("PSNR, dB ↑")]) for row in rows]
    assert psnr[3] > max(psnr[:2])
    assert len(list(tmp_path.glob("cornell.*.png"))) == len(WAYS) + 1


def test_a_scene_that_is_not_there(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    assert run(monkeypatch, "nowhere") == 2
    assert capsys.readouterr().err.startswith("look_ahead: ")


def test_frames_turned_round_run_backward_in_time() -> None:
    frames = list(room_frames((18, 32), 4))
    turned = list(look_ahead.turned_round(frames))
    assert [frame.color is other.color for frame, other in zip(turned, reversed(frames), strict=True)] == [True] * 4
    np.testing.assert_array_equal(turned[1].motion, motion_to_next(frames[2], frames[3]))
    with Denoiser((18, 32)) as den:
        pictures = list(look_ahead.filtered(den, turned))
        assert len(pictures) == 4

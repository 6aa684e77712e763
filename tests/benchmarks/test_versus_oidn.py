"""The comparison as a command: what it prints, writes and refuses."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyopencl as cl
import pytest

from benchmarks import versus_oidn
from benchmarks.footage import Footage
from svgf_cl import Denoiser, Frame
from svgf_cl.io.synthetic import room_frames

FOOTAGE = Footage("area", jitter=True, band=(0.6, 0.9), frames=4, spp=32)


def run(monkeypatch: pytest.MonkeyPatch, *argv: str | Path) -> int:
    """Exit code of the program."""
    monkeypatch.setattr(sys, "argv", ["versus_oidn", *map(str, argv)])
    with pytest.raises(SystemExit) as left:
        versus_oidn.main()
    return int(left.value.code or 0)


def test_wrong_input_ends_in_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(monkeypatch, "--set", "iterations=many") == 2
    said = capsys.readouterr().err
    assert said.startswith("versus_oidn: --set iterations: expected a whole number")
    assert said.count("\n") == 1


class Alone:
    """Stands for a denoiser of single frames that returns its input; notes how many it saw."""

    seen = 0

    def denoise(self, frame: Frame) -> np.ndarray:
        self.seen += 1
        return frame.color


def test_errors_are_of_the_judged_frames(queue: cl.CommandQueue) -> None:
    pytest.importorskip("flip_evaluator")
    film = replace(FOOTAGE, shape=(45, 80))
    den, alone = Denoiser(film.shape, queue=queue), Alone()
    used = next(room_frames(film.shape, 1))
    den.denoise(used)  # other fields than the footage has, and a history that is not its own
    ticks: list[None] = []
    steps = film.chunks + film.frames
    found = versus_oidn.qualities({"svgf_cl": den}, {"alone": alone}, film, lambda: ticks.append(None))
    assert found["alone"] == found["noisy"]
    assert found["svgf_cl"].psnr > found["noisy"].psnr
    assert alone.seen == len(film.judged)
    assert len(ticks) == steps


def test_it_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install 'svgf-cl[oidn]'")
    target = tmp_path / "versus.json"
    pytest.importorskip("flip_evaluator")
    monkeypatch.setattr(versus_oidn, "AREA", FOOTAGE)
    options = ["--size", "80x45", "--rounds", "2", "--set", "iterations=2", "--markdown", "--json", target]
    assert run(monkeypatch, *options) == 0
    said = capsys.readouterr().out
    assert "| bar: 5x5 faster than OIDN high | " in said
    assert "| aim: default faster than OIDN fast | " in said
    record = json.loads(target.read_text())
    assert "iterations=2" in record["about"]["svgf_cl default"]
    assert {len(samples) for samples in record["seconds"].values()} == {2}
    assert list(record["error"]) == ["noisy", *record["bytes"]]
    assert list(record["bytes"]) == [
        "svgf_cl 5x5",
        "svgf_cl SVGF",
        "svgf_cl default",
        "OIDN high",
        "OIDN balanced",
        "OIDN fast",
    ]
    assert record["error"]["svgf_cl 5x5"]["psnr"] > record["error"]["noisy"]["psnr"]

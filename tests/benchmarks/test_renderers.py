"""Frames of renderers before and after: what the command prints, judges and refuses."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks import renderers
from svgf_cl.errors import FileError
from svgf_cl.io.exr import read_image
from tests.exr_files import exr_bytes
from tests.renderers import BLENDER_HEADER, SHAPE, Moment, Planes, blender, moments, rgb, written

NUMBERS = (1, 2, 3, 4)


def run(monkeypatch: pytest.MonkeyPatch, *argv: str | Path) -> int:
    """Exit code of the program."""
    monkeypatch.setattr(sys, "argv", ["renderers", *map(str, argv)])
    with pytest.raises(SystemExit) as left:
        renderers.main()
    return int(left.value.code or 0)


def folder(at: Path, strength: float = 1.0) -> Path:
    """Frames whose direct light is noisy, and the same without noise."""
    rng = np.random.default_rng(0)
    for name, noise in (("noisy", strength), ("reference", 0.0)):
        written(at / name, {each.number: lit(each, rng, noise) for each in moments(NUMBERS)}, BLENDER_HEADER)
    return at


def lit(at: Moment, rng: np.random.Generator, noise: float) -> Planes:
    """Blender's passes of a frame under even light, which is multiplied by noise around 1."""
    gain = np.asarray(1 + noise * (rng.exponential(size=(*SHAPE, 1)) - 1), np.float32)
    light = np.where(at.hit[..., None], 0.8 * gain, np.float32(0)) * np.ones(3, np.float32)
    frame = replace(at.frame, direct=light * at.frame.albedo, indirect=np.zeros_like(light))
    picture = np.asarray(frame.direct + frame.emission, np.float32)
    return blender(replace(at, frame=replace(frame, color=picture)))


def test_it_prints_a_row_for_each_folder(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    pytest.importorskip("flip_evaluator")
    folders = [folder(tmp_path / "blender" / name) for name in ("one", "two")]
    assert run(monkeypatch, *folders, "--markdown") == 0
    lines = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
    heads, _, *rows = lines
    assert [row[0] for row in rows] == ["blender/one", "blender/two"]
    for row in rows:
        before, after = map(float, row[heads.index("PSNR, dB ↑")].split(" → "))
        assert after > before + 3


def test_what_became_worse_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Without noise there is nothing to gain: whatever is filtered is lost."""
    pytest.importorskip("flip_evaluator")
    assert run(monkeypatch, folder(tmp_path, strength=0.0)) == 1
    assert f"worse than before: {tmp_path}: PSNR" in capsys.readouterr().out


def test_frames_without_a_reference_are_not_judged(tmp_path: Path) -> None:
    pytest.importorskip("flip_evaluator")
    folder(tmp_path)
    whole = renderers.gain(tmp_path)
    for number in NUMBERS[:-1]:
        (tmp_path / "reference" / f"shot_{number:04d}.exr").unlink()
    assert renderers.gain(tmp_path).after.psnr != whole.after.psnr


def test_the_view_layer_is_that_of_the_reference(tmp_path: Path) -> None:
    pytest.importorskip("flip_evaluator")
    folder(tmp_path)
    expected = renderers.gain(tmp_path)
    for at in moments(NUMBERS):
        path = tmp_path / "noisy" / f"shot_{at.number:04d}.exr"
        both = {**read_image(path).planes, **blender(at, "Fog")}
        path.write_bytes(exr_bytes(both, BLENDER_HEADER))
    assert renderers.gain(tmp_path).after.psnr == expected.after.psnr


def test_a_folder_without_references_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "noisy").mkdir()
    assert run(monkeypatch, tmp_path) == 2
    assert "reference" in capsys.readouterr().err


def test_references_of_other_frames_are_refused(tmp_path: Path) -> None:
    folder(tmp_path)
    written(tmp_path / "reference", {9: rgb(moments((9,))[0].frame.color)})
    for number in NUMBERS:
        (tmp_path / "reference" / f"shot_{number:04d}.exr").unlink()
    with pytest.raises(FileError, match=r"expected the number of a frame in .*noisy, found none"):
        renderers.gain(tmp_path)

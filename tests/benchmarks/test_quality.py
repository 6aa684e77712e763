"""The comparison of filters as a command: what it prints, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

pytest.importorskip("flip_evaluator")
pytest.importorskip("skimage")

from benchmarks import quality
from benchmarks.footage import Footage
from benchmarks.rivals import OIDN
from svgf_cl import SvgfError

APP = typer.Typer()
APP.command()(quality.quality)
TINY = ("--size", "48x32", "--frames", "4", "--spp", "32")


def output(*arguments: str) -> str:
    run = CliRunner().invoke(APP, [*TINY, *arguments], catch_exceptions=False)
    assert run.exit_code == 0
    return run.output


def first_cells(text: str) -> list[str]:
    """Of the rows of its markdown tables."""
    return [line.split(" | ")[0].removeprefix("| ") for line in text.splitlines() if line.startswith("| ")]


def test_filters_are_judged_with_both_kinds_of_rays_and_all_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(quality, "why_no_oidn", lambda: "not compared; it is missing")
    target = tmp_path / "quality.json"
    said = output(
        *("swing", "--filter", "svgf,iterations=2", "--filter", "eaw,sigma_color=0.5", "--markdown"),
        *("-o", str(tmp_path / "panels"), "--picture", "3", "--json", str(target)),
    )
    plain = ["noisy", "accumulated", "svgf,iterations=2", "eaw,sigma_color=0.5"]
    both = [*plain, "svgf,iterations=2,taa=on", "eaw,sigma_color=0.5,taa=on"]
    tables = [["filter", "---", *plain], ["filter", "---", *both]]
    assert first_cells(said) == [*tables[0], *tables[1], *(3 * tables[0]), *(3 * tables[1])]
    assert "Open Image Denoise: not compared; it is missing" in said
    assert "truth: 32 spp" in said
    names = [f"swing.{rays}.0003{part}.png" for rays in ("area", "centre") for part in (".detail", "")]
    assert sorted(path.name for path in (tmp_path / "panels").iterdir()) == names
    record = json.loads(target.read_text())
    assert [(scene["jitter"], list(scene["rows"])) for scene in record["scenes"]] == [(False, plain), (True, both)]
    for scene in record["scenes"]:
        rows = scene["rows"]
        assert rows["svgf,iterations=2"]["psnr"] > rows["noisy"]["psnr"]
        assert rows["svgf,iterations=2"]["device"] > 0
        assert rows["noisy"]["call"] is None


def test_open_image_denoise_stands_beside_them() -> None:
    pytest.importorskip("pyoidn", reason="pyoidn is not installed: pip install '.[oidn]'")
    said = output("swing", "--filter", "svgf", "--no-jitter", "--markdown")
    assert first_cells(said)[:6] == ["filter", "---", "noisy", "accumulated", "svgf", OIDN]


def test_all_frames_that_history_is_long_in_are_judged() -> None:
    assert quality.footage("swing", "64x36", None, 32, jitter=False).judged == range(8, 48)
    assert quality.footage("cornell", "64x36", None, 32, jitter=True).judged == range(8, 24)
    assert quality.footage("some.glb", "64x36", None, 32, jitter=True).judged == range(8, 24)
    assert quality.footage("swing", "64x36", 4, 32, jitter=False).judged == range(2, 4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--size", "64x8"), "--size: expected at least 11x11 pixels, which SSIM needs, got 64x8"),
        (("--filter", "nlm"), "--filter: expected kalman or svgf or"),
        (("--picture", "1"), r"--picture: expected frames out of 2\.\.3 of swing, got 1"),
    ],
)
def test_what_cannot_be_done_is_said_before_anything_is_rendered(
    arguments: tuple[str, ...], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Footage, "halves", lambda *_: pytest.fail("rendered"))
    with pytest.raises(SvgfError, match=message):
        CliRunner().invoke(APP, ["swing", *TINY, "--no-jitter", *arguments], catch_exceptions=False)


def test_without_open_image_denoise_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise SvgfError("it is missing")

    monkeypatch.setattr(quality, "require_oidn", missing)
    assert quality.why_no_oidn() == "not compared; it is missing"

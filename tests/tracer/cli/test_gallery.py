"""``svgf-cl scenes`` as people use it: a table, thumbnails, a contact sheet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from rich.color import Color

import svgf_cl_tracer
from svgf_cl.cli import main
from svgf_cl_tracer.cli.gallery import half_blocks

RNG = np.random.default_rng(5)


def run(*argv: str | Path) -> int:
    """Exit code of ``svgf-cl scenes argv``."""
    with pytest.raises(SystemExit) as left:
        main(["scenes", *map(str, argv)])
    return int(left.value.code or 0)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if there were two built-in scenes only."""
    two = {name: svgf_cl_tracer.BUILTIN[name] for name in ("cornell", "mirror")}
    monkeypatch.setattr(svgf_cl_tracer, "BUILTIN", two)


def test_the_table_says_what_is_hard_about_every_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert run() == 0
    said = capsys.readouterr().out
    for name, scene in svgf_cl_tracer.BUILTIN.items():
        (line,) = (line for line in said.splitlines() if f" {name} " in line)
        assert scene.hard in line
        assert f" {scene.frames} " in line
    assert "\u2580" not in said


@pytest.mark.usefixtures("few")
def test_a_terminal_with_colours_shows_thumbnails(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("FORCE_COLOR", "1"), ("COLORTERM", "truecolor"), ("TERM", "xterm-256color")):
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert run("--spp", "1") == 0
    said = capsys.readouterr().out
    assert sum(line.count("\u2580") for line in said.splitlines()) == 2 * 9 * 32
    assert said.count("\x1b[38;2;") > 100


def test_half_blocks_are_two_pixels_each() -> None:
    picture = RNG.integers(0, 256, (4, 3, 3), np.uint8)
    text = half_blocks(picture)
    assert text.plain == "\u2580\u2580\u2580\n\u2580\u2580\u2580"
    for index, (y, x) in enumerate((y, x) for y in (0, 2) for x in range(3)):
        style = text.spans[index].style
        assert style.color == Color.from_rgb(*picture[y, x])
        assert style.bgcolor == Color.from_rgb(*picture[y + 1, x])


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize("suffix", ["png", "webp"])
def test_the_sheet_shows_given_scenes_and_built_in_ones(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet = tmp_path / "new" / f"sheet.{suffix}"
    square = tmp_path / "square.obj"
    square.write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")
    assert run(square, "--sky", "1,1,1", "-o", sheet, "--size", "32x18", "--spp", "2") == 0
    assert capsys.readouterr().out == f"3 scenes in {sheet}\n"
    with Image.open(sheet) as picture:
        assert picture.format == suffix.upper()
        assert picture.size == (2 * 32 + 4, 2 * (28 + 18 + 4))
        pixels = np.asarray(picture)
    first = pixels[28 : 28 + 18, :32]
    assert 40 < first.mean() < 215
    assert not pixels[-10:, 40:].any()  # the fourth place of two by two


@pytest.mark.usefixtures("few")
def test_exposure_brightens_the_sheet(tmp_path: Path) -> None:
    for stops in ("-2", "0"):
        assert run("-o", tmp_path / f"{stops}.png", "--size", "32x18", "--spp", "1", "--exposure", stops) == 0
    dark, bright = (np.asarray(Image.open(tmp_path / f"{stops}.png"), float).mean() for stops in ("-2", "0"))
    assert dark < 0.8 * bright


@pytest.mark.parametrize(
    ("words", "argv"),
    [
        ("expected a file named *.png or *.webp, got sheet.exr", ["-o", "sheet.exr"]),
        ("nowhere.glb: expected", ["nowhere.glb", "-o", "sheet.png"]),
        ("--size", ["-o", "sheet.png", "--size", "large"]),
    ],
)
def test_what_cannot_be_drawn_is_said_at_once(
    words: str, argv: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(*argv) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())

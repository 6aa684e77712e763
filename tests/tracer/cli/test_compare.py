"""``svgf-cl compare`` on scenes as people use it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

pytest.importorskip("flip_evaluator")
pytest.importorskip("jinja2")
pytest.importorskip("skimage")

from svgf_cl.compare import rivals
from svgf_cl.filters import Accumulation, Kalman, Settings
from svgf_cl.frame import Shape
from svgf_cl_tracer.cli.footage import Traced
from tests.command_line import run

TINY = ("--size", "48x32", "--frames", "4", "--judged", "2", "--spp", "32")


@pytest.fixture
def antialiased(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether each filter that takes part antialiases over time."""
    found: list[bool] = []

    class Watched(rivals.Filtered):
        def __init__(self, shape: Shape, settings: Kalman | Settings | Accumulation) -> None:
            found.append(settings.taa)
            super().__init__(shape, settings)

    monkeypatch.setattr(rivals, "Filtered", Watched)
    return found


def test_a_scene_becomes_a_page_with_all_filters_beside_the_noisy_frames(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], antialiased: list[bool]
) -> None:
    assert (
        run("compare", "swing", "--filters", "svgf,accumulation", *TINY, "-o", tmp_path, "--fail-below", "psnr=20") == 0
    )
    said = capsys.readouterr()
    assert "swing: 1 sample per pixel" in said.out
    assert said.out.index("svgf") < said.out.index("accumulation") < said.out.index("noisy")
    assert [path.name for path in (tmp_path / "figures").iterdir()] == ["01.swing.png"]
    page = (tmp_path / "index.html").read_text("utf-8")
    assert all(f">{name}<" in page for name in ("swing", "svgf", "accumulation", "noisy", "reference"))
    (scene,) = json.loads((tmp_path / "results.json").read_text())["scenes"]
    assert (scene["name"], scene["size"], scene["frames"]) == ("swing", [48, 32], [2, 3])
    assert "rays move within the pixel; truth of 32 samples per pixel; halves of the truth differ by " in scene["note"]
    assert list(scene["filters"]) == ["svgf", "accumulation", "noisy"]
    figures = {name: each["values"] for name, each in scene["filters"].items()}
    for filtered in (figures["svgf"], figures["accumulation"]):
        assert filtered["psnr"] > figures["noisy"]["psnr"] + 1
        assert filtered["temporal"] < figures["noisy"]["temporal"]
    assert abs(figures["noisy"]["bias"]) < 0.1, "noisy frames and truth are of one light"
    assert antialiased == [True, True]


def test_json_is_all_that_is_printed_and_the_first_filter_is_tested(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], antialiased: list[bool]
) -> None:
    command = ("compare", "cornell", "--filters", "kalman", *TINY, "--no-jitter", "-o", tmp_path, "--json", "-")
    assert run(*command, "--fail-above", "relmse=0") == 1
    said = capsys.readouterr()
    (scene,) = json.loads(said.out)["scenes"]
    assert "rays go through pixel centres" in scene["note"]
    assert "cornell.kalman, relmse: relMSE" in said.err
    assert "noisy" not in said.err
    assert antialiased == [False]


@pytest.mark.parametrize(
    ("words", "argv"),
    [
        ("juggling: expected a scene's folder or file or a built-in scene", ["juggling"]),
        ("room.glb: expected a scene's folder or file or a built-in scene", ["swing", "room.glb"]),
        ("--size: expected WIDTHxHEIGHT", ["swing", "--size", "large"]),
        ("--size: expected at least 11x11 pixels, which SSIM needs, got 64x8", ["swing", "--size", "64x8"]),
        ("'--spp'", ["swing", "--spp", "1"]),
        ("'--frames'", ["swing", "--frames", "0"]),
        ("--filters: expected names among kalman", ["swing", "--filters", "nlm"]),
    ],
)
def test_what_cannot_be_done_is_said_before_anything_is_rendered(
    words: str, argv: list[str], tmp_path: Path, refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Traced, "truths", lambda *_: pytest.fail("rendered"))
    refused(words, "compare", *argv, "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("module", ["svgf_cl_tracer.api", "svgf_cl_tracer.cli.footage"])
def test_without_the_tracer_it_is_said_how_to_get_it(
    module: str, tmp_path: Path, refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    refused("pip install 'svgf-cl[tracer]'", "compare", "swing", "--filters", "eaw", "-o", tmp_path)

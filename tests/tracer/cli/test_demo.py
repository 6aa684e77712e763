"""``svgf-cl demo`` as people use it."""

from __future__ import annotations

import shlex
import sys
from dataclasses import asdict
from pathlib import Path

import pytest

from svgf_cl.view.server import Server
from svgf_cl_tracer.cli.demo import viewing
from svgf_cl_tracer.demo import SETTINGS
from tests.command_line import run


def test_demo_prints_gain_times_and_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("demo", "--frames", "2", "--size", "32x18", "--reference-spp", "4", "-o", tmp_path) == 0
    said = capsys.readouterr()
    for words in ("device: ", "gain", "atrous 1", f"{tmp_path}/preview.webp", "all frames, noisy beside denoised"):
        assert words in said.out
    assert said.err == "", "no progress bar where stderr is no terminal"
    assert (tmp_path / "still.0001.png").exists()
    told = said.out.splitlines()[-1]
    assert told == f"to see it in motion: {shlex.join(viewing(tmp_path))}"


def test_the_command_that_the_demo_ends_with_plays_its_frames(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, told = tmp_path / "a folder", []
    monkeypatch.setattr(Server, "serve_forever", lambda server, poll: told.append(server.clip()))
    assert run("demo", "--frames", "2", "--size", "32x18", "--reference-spp", "4", "-o", folder) == 0
    command = shlex.split(capsys.readouterr().out.splitlines()[-1].partition(": ")[2])
    assert run(*command[1:], "--no-browser") == 0
    (clip,) = told
    assert (clip["name"], clip["numbers"], clip["has_references"]) == ("a folder/noisy", [0, 1], True)
    assert clip["settings"] == asdict(SETTINGS)


@pytest.mark.parametrize(
    ("called", "on_the_path", "program"),
    [
        (".venv/bin/svgf-cl", None, ".venv/bin/svgf-cl"),
        ("/usr/bin/svgf-cl", "/usr/bin/svgf-cl", "svgf-cl"),
        ("python", None, "svgf-cl"),
    ],
)
def test_that_command_can_be_pasted_into_the_shell(
    called: str, on_the_path: str | None, program: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", [called, "demo"])
    monkeypatch.setattr("shutil.which", lambda name: on_the_path)
    assert viewing(Path("out"))[0] == program


def test_a_demo_too_small_to_be_measured(tmp_path: Path, refused) -> None:
    refused("--size: expected at least 11x11 pixels", "demo", "--size", "8x8", "-o", tmp_path / "demo")
    assert not (tmp_path / "demo").exists(), "refused before the long work, not after it"


def test_an_output_that_cannot_be_written(tmp_path: Path, refused) -> None:
    (tmp_path / "file").touch()
    refused("cannot be a folder for the output", "demo", "-o", tmp_path / "file" / "out")


def test_rendering_without_the_tracer_says_how_to_get_it(tmp_path: Path, refused, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "svgf_cl_tracer.api", None)
    refused("pip install 'svgf-cl[tracer]'", "demo", "-o", tmp_path)


def test_measuring_without_scikit_image_says_how_to_get_it(tmp_path: Path, refused, monkeypatch) -> None:
    for module in ("skimage", "skimage.metrics"):
        monkeypatch.setitem(sys.modules, module, None)
    refused("pip install 'svgf-cl[metrics]'", "demo", "-o", tmp_path / "demo")
    assert not (tmp_path / "demo").exists(), "refused before the long work, not after it"

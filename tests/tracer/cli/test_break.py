"""A sequence that is killed leaves whole files alone; the same command goes on and ends as if nothing had happened."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from svgf_cl.io.frames import read_frame, write_frame
from svgf_cl_tracer import SceneError
from tests.command_line import assert_goes_on, contents, run

FRAMES = ("--frames", "4", "--size", "32x18")


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four frames of the built-in scene; not to be changed."""
    folder = tmp_path_factory.mktemp("rendered")
    assert run("render", "cornell", *FRAMES, "-o", folder) == 0
    return folder


@pytest.mark.parametrize(
    ("argv", "killed"),
    [
        (("render", "cornell", *FRAMES, "--reference-spp", "16"), (5,)),
        (("demo", *FRAMES, "--reference-spp", "4"), (13,)),
    ],
    ids=lambda value: value[0] if isinstance(value[0], str) else "",
)
def test_a_killed_run_is_gone_on_with(argv: tuple[str, ...], killed: tuple[int, ...], tmp_path: Path) -> None:
    assert_goes_on(argv, killed, tmp_path, first="import svgf_cl_tracer.api")


def test_render_keeps_only_what_it_would_make(rendered: Path, tmp_path: Path, capsys) -> None:
    folder = Path(shutil.copytree(rendered, tmp_path / "frames"))
    first, second = folder / "frame.0000.exr", folder / "frame.0001.exr"
    first.write_bytes(first.read_bytes()[:-1])
    write_frame(second, read_frame(second), "something else")
    assert run("render", "cornell", *FRAMES, "-o", folder) == 0
    assert "2 of them kept" in capsys.readouterr().out
    assert contents(folder) == contents(rendered)
    for change in ("--seed=1", "--no-jitter", "--bounces=0", "--spp=2", "--camera=0,1,3/0,1,0/60"):
        assert run("render", "cornell", *FRAMES, change, "-o", folder) == 0
        assert "kept" not in capsys.readouterr().out
        assert contents(folder)["frame.0003.exr"] != contents(rendered)["frame.0003.exr"]


def test_render_keeps_nothing_of_another_version(rendered: Path, tmp_path: Path, capsys, monkeypatch) -> None:
    folder = Path(shutil.copytree(rendered, tmp_path / "frames"))
    monkeypatch.setattr("svgf_cl_tracer.shot.tracer_version", lambda: "another")
    assert run("render", "cornell", *FRAMES, "-o", folder) == 0
    assert "kept" not in capsys.readouterr().out


def test_render_keeps_nothing_of_a_scene_that_has_changed(tmp_path: Path, capsys) -> None:
    (tmp_path / "triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for radiance, kept in ((1.0, False), (1.0, True), (2.0, False)):
        lights = [{"type": "sky_constant", "radiance": 3 * [radiance]}]
        (tmp_path / "scene.json").write_text(json.dumps({"model": "triangle.obj", "lights": lights}))
        assert run("render", tmp_path, "--frames", "1", "--size", "16x12", "-o", tmp_path / "out") == 0
        assert ("kept" in capsys.readouterr().out) == kept
        assert read_frame(tmp_path / "out" / "frame.0000.exr").color[0, 0, 0] == radiance


def test_a_name_that_is_too_long_is_refused_in_one_line(tmp_path: Path, capsys) -> None:
    assert run("render", "x" * 300, "-o", tmp_path / "out") == 2
    said = capsys.readouterr().err
    assert "File name too long" in said
    assert said.count("\n") == 1


@pytest.mark.parametrize("output", ["/proc/a", "/dev/null/a", "file/a/b"])
def test_an_output_that_cannot_be_is_refused_before_any_work(output: str, tmp_path: Path, refused, monkeypatch) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr("svgf_cl_tracer.render_frame", None)
    monkeypatch.setattr("svgf_cl_tracer.demo.Demo.denoise", None)
    for argv in (("render", "cornell", "-o", tmp_path / output), ("demo", "-o", tmp_path / output)):
        refused("cannot be a folder for the output", *argv)
    refused("cannot be a folder for the output", "scenes", "-o", tmp_path / output / "a.png")
    (tmp_path / "a.png").mkdir()
    refused("expected a file to write, got a folder", "scenes", "-o", tmp_path / "a.png")


def test_a_run_that_fails_leaves_no_empty_folder(tmp_path: Path, refused, monkeypatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise SceneError("it cannot be rendered")

    out = tmp_path / "a" / "b"
    refused("found nothing", "render", "nowhere", "-o", out)
    refused("found nothing", "scenes", "nowhere", "-o", out / "a.png")
    monkeypatch.setattr("svgf_cl_tracer.render_frame", fail)
    for argv in (("render", "cornell", *FRAMES), ("demo", *FRAMES)):
        refused("it cannot be rendered", *argv, "-o", out)
    assert not list(tmp_path.iterdir())

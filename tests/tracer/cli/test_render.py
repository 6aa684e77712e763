"""``svgf-cl render`` as people use it."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.io.exr import read_image
from svgf_cl.io.frames import CHANNEL_NAMES, read_frame
from svgf_cl.io.pictures import read_picture
from svgf_cl_tracer import BUILTIN
from tests.command_line import NAMES, run

# Radiance of the sky in either set of a scene's lights.
LIGHTS = {"lights": 0.5, "alternative_lights": 2.0}


def test_render_writes_every_field_of_every_frame(rendered: Path) -> None:
    assert sorted(path.name for path in rendered.glob("frame.*")) == NAMES
    assert set(read_image(rendered / NAMES[0]).planes) == {name for names in CHANNEL_NAMES.values() for name in names}
    assert read_frame(rendered / NAMES[0]).shape == (18, 32)
    assert set(read_image(rendered / "reference.0002.exr").planes) == {
        *(name for field, names in CHANNEL_NAMES.items() if field != "hit_distance" for name in names),
        *("error.R", "error.G", "error.B"),
    }


def test_references_reach_the_error_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ("render", "cornell", "--frames", "1", "--size", "32x18", "--reference-spp", "64", "--until-error", "0.05")
    assert run(*argv, "-o", tmp_path) == 0
    said = re.search(r"references: at least (\d+) spp, error at most ([\d.]+)", capsys.readouterr().out)
    assert int(said[1]) > 64
    assert 0.04 < float(said[2]) <= 0.05


def test_render_is_reproducible_and_seeded(rendered: Path, tmp_path: Path) -> None:
    for seed in ("0", "1"):
        argv = ("render", "cornell", "--frames", "3", "--size", "32x18", "--seed", seed, "-o", tmp_path / seed)
        assert run(*argv) == 0
    known, same, other = (read_picture(folder / NAMES[2]) for folder in (rendered, tmp_path / "0", tmp_path / "1"))
    np.testing.assert_array_equal(same, known)
    assert not np.array_equal(other, known)


def test_render_along_cameras(tmp_path: Path) -> None:
    still = ("render", "cornell", "--frames", "2", "--size", "16x12", "--no-jitter", "--camera", "0,1,3/0,1,0/60")
    assert run(*still, "-o", tmp_path / "still") == 0
    assert run(*still, "--camera", "0.5,1,3/0,1,0/60", "-o", tmp_path / "moving") == 0
    assert not read_frame(tmp_path / "still" / NAMES[1]).motion[..., :2].any()
    assert read_frame(tmp_path / "moving" / NAMES[1]).motion[..., :2].any()


def test_denoise_and_compare_as_people_do(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert run("denoise", rendered, "-o", out, "--png") == 0
    assert "atrous 4" in capsys.readouterr().out
    assert sorted(path.name for path in out.iterdir()) == sorted(NAMES + [n.replace("exr", "png") for n in NAMES])
    assert all(np.isfinite(read_picture(out / name)).all() for name in NAMES)

    assert run("compare", out, rendered) == 0
    assert "all" in capsys.readouterr().out
    assert run("compare", out, rendered, "--fail-below", "psnr=12,ssim=0.2") == 0
    assert run("compare", out, rendered, "--fail-below", "psnr=99,ssim=0.99", "--fail-above", "relmse=0") == 1
    said = capsys.readouterr().err
    assert "out 0, psnr: PSNR" in said
    assert "below 99 dB" in said
    assert "out 2, relmse: relMSE" in said


@pytest.mark.parametrize(
    ("words", "argv"),
    [
        ("'SCENE'; try 'svgf-cl render --help'", ["render"]),
        ("'-o'", ["render", "cornell"]),
        ("'--frames'", ["render", "cornell", "-o", "x", "--frames", "0"]),
    ],
)
def test_wrong_usage_is_one_line(words: str, argv: list[str], refused) -> None:
    refused(words, *argv)


@pytest.mark.parametrize("size", ["640", "0x360", "640x360x3", "axb", "-1x5"])
def test_a_bad_size(size: str, tmp_path: Path, refused) -> None:
    refused("--size: expected WIDTHxHEIGHT", "render", "cornell", f"--size={size}", "-o", tmp_path)


def test_a_size_that_no_memory_holds(tmp_path: Path, refused) -> None:
    refused("--size: expected at most 32768 pixels a side", "render", "cornell", "--size=1x32769", "-o", tmp_path)


@pytest.mark.parametrize("sky", ["1,2", "red", "1,2,-3", "1,nan,1", "inf,1,1"])
def test_a_bad_sky(sky: str, tmp_path: Path, refused) -> None:
    refused("--sky: expected", "render", "cornell", "--sky", sky, "-o", tmp_path)


def test_a_bad_camera(tmp_path: Path, refused) -> None:
    refused("camera: expected", "render", "cornell", "--camera", "over there", "-o", tmp_path)


@pytest.mark.parametrize("error", ["0", "-1", "nan"])
def test_an_error_that_is_never_reached(error: str, tmp_path: Path, refused) -> None:
    refused("expected an error above 0", "render", "cornell", "--until-error", error, "-o", tmp_path)


def test_a_scheduler_that_is_not_there(tmp_path: Path, refused) -> None:
    refused("expected a Dask scheduler at nowhere", "render", "cornell", "--scheduler", "nowhere", "-o", tmp_path)


def test_a_missing_scene(tmp_path: Path, refused) -> None:
    refused(
        "nowhere.glb: expected a scene's folder or file or a built-in",
        "render",
        tmp_path / "nowhere.glb",
        "-o",
        tmp_path,
    )


def test_a_scene_without_light_is_offered_a_sky(tmp_path: Path, refused) -> None:
    scene = tmp_path / "triangle.obj"
    scene.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    options = ("--frames", "1", "--size", "16x12", "-o", tmp_path)
    refused("--sky", "render", scene, *options)
    assert run("render", scene, "--sky", "1,1,1", *options) == 0


def test_a_folder_with_a_scene_and_its_alternative_lights(tmp_path: Path) -> None:
    (tmp_path / "triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    lights = {kind: [{"type": "sky_constant", "radiance": 3 * [level]}] for kind, level in LIGHTS.items()}
    (tmp_path / "scene.json").write_text(json.dumps({"model": "triangle.obj"} | lights))
    options = ("--frames", "1", "--size", "16x12", "-o", tmp_path / "out")
    for option, kind in (((), "lights"), (("--alternative-lights",), "alternative_lights")):
        assert run("render", tmp_path, *option, *options) == 0
        assert read_frame(tmp_path / "out" / "frame.0000.exr").color[0, 0, 0] == LIGHTS[kind]


def test_frames_of_an_earlier_run_are_not_mixed_in(frames: Path, refused) -> None:
    refused("left by an earlier run", "render", "cornell", "--frames", "2", "--size", "32x18", "-o", frames)
    for name in NAMES:
        (frames / name).unlink()
    refused("reference.0000.exr: left by", "render", "cornell", "--frames", "3", "--size", "32x18", "-o", frames)


def test_an_output_that_cannot_be_written(tmp_path: Path, refused) -> None:
    (tmp_path / "file").touch()
    refused("cannot be a folder for the output", "render", "cornell", "-o", tmp_path / "file" / "out")


def test_rendering_without_the_tracer_says_how_to_get_it(tmp_path: Path, refused, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "svgf_cl_tracer.api", None)
    refused("pip install 'svgf-cl[tracer]'", "render", "cornell", "-o", tmp_path)


def test_a_builtin_scene_comes_with_the_frames_that_show_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("render", "switch", "--size", "4x3", "-o", tmp_path) == 0
    assert len(list(tmp_path.glob("frame.*.exr"))) == BUILTIN["switch"].frames == 48
    assert "48 frames" in capsys.readouterr().out

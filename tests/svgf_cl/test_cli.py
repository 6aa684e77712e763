"""The command line as people use it: what it writes, what it prints, and one clear line for wrong input."""

from __future__ import annotations

import json
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import __version__
from svgf_cl.bench import tuner
from svgf_cl.cli import main
from svgf_cl.device import devices, tuning
from svgf_cl.io.exr import read_channels, write_channels
from svgf_cl.io.frames import (
    CHANNEL_NAMES,
    read_frame,
    read_picture,
    write_frame,
    write_picture,
)
from tests.benchmarks.tracing import made_up

COMMANDS = ("devices", "demo", "scenes", "render", "check", "denoise", "compare", "bench", "tune")
# Radiance of the sky in either set of a scene's lights.
LIGHTS = {"lights": 0.5, "alternative_lights": 2.0}
NAMES = [f"frame.{number:04d}.exr" for number in range(3)]


def run(*argv: str | Path) -> int:
    """Exit code of ``svgf-cl argv``."""
    with pytest.raises(SystemExit) as left:
        main([str(argument) for argument in argv])
    return int(left.value.code or 0)


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three frames of the built-in scene and their references; not to be changed."""
    folder = tmp_path_factory.mktemp("rendered")
    assert run("render", "cornell", "--frames", "3", "--size", "32x18", "--reference-spp", "16", "-o", folder) == 0
    return folder


@pytest.fixture
def frames(rendered: Path, tmp_path: Path) -> Path:
    """A copy of `rendered`, to be broken."""
    return Path(shutil.copytree(rendered, tmp_path / "frames"))


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]):
    """Check that a command line is refused: exit code 2 and one line on stderr, with these words and no traceback."""

    def check(words: str, *argv: str | Path) -> None:
        capsys.readouterr()
        assert run(*argv) == 2
        said = capsys.readouterr().err
        assert said.startswith("svgf-cl: ")
        assert said.count("\n") == 1, said
        assert words in said

    return check


# Help and usage


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, "--help") == 0
    said = capsys.readouterr().out
    assert f"svgf-cl {command}" in said.split("Examples:")[1]


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--help") == 0
    said = capsys.readouterr().out
    assert all(f"\n  {command} " in said for command in COMMANDS)


@pytest.mark.parametrize(
    ("words", "argv"),
    [
        ("'juggle'; try 'svgf-cl --help'", ["juggle"]),
        ("'SCENE'; try 'svgf-cl render --help'", ["render"]),
        ("'-o'", ["render", "cornell"]),
        ("'--frames'", ["render", "cornell", "-o", "x", "--frames", "0"]),
        ("--bogus; try 'svgf-cl compare --help'", ["compare", "--bogus"]),
    ],
)
def test_wrong_usage_is_one_line(words: str, argv: list[str], refused) -> None:
    refused(words, *argv)


def test_no_command_at_all_shows_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert run() == 0
    assert "Usage: svgf-cl" in capsys.readouterr().out


@pytest.mark.parametrize(("error", "code"), [(KeyboardInterrupt(), 130), (MemoryError("8 EiB"), 2)])
def test_what_comes_from_outside_leaves_no_traceback(
    error: BaseException, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("svgf_cl.bench.suite.Suite.run", broken)
    assert run("bench") == code
    said = capsys.readouterr().err
    assert said.strip() == ("svgf-cl: not enough memory: 8 EiB" if code == 2 else "")


def test_devices_marks_a_default_that_works(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("devices") == 0
    marked = [line for line in capsys.readouterr().out.splitlines() if "*" in line]
    assert len(marked) == 1
    assert "yes" in marked[0]


# render, denoise, compare


def test_tune_stores_what_it_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tuning, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(tuner, "CHOICES", {"vector_width": (4, 8, 16), "row_alignment": (16, 256)})
    assert run("tune", "--size", "32x18") == 0
    assert f"stored in {tmp_path / tuning.MEMORY}" in capsys.readouterr().out
    assert run("devices") == 0
    assert "tuned: vectors of" in capsys.readouterr().out
    assert run("tune", "--reset") == 0
    assert run("devices") == 0
    assert "tuned: vectors of" not in capsys.readouterr().out


def test_render_writes_every_field_of_every_frame(rendered: Path) -> None:
    assert sorted(path.name for path in rendered.glob("frame.*")) == NAMES
    assert set(read_channels(rendered / NAMES[0])) == {name for names in CHANNEL_NAMES.values() for name in names}
    assert read_frame(rendered / NAMES[0]).shape == (18, 32)
    assert set(read_channels(rendered / "reference.0002.exr")) == {
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
    assert "atrous 5" in capsys.readouterr().out
    assert sorted(path.name for path in out.iterdir()) == sorted(NAMES + [n.replace("exr", "png") for n in NAMES])
    assert all(np.isfinite(read_picture(out / name)).all() for name in NAMES)

    assert run("compare", out, rendered) == 0
    assert "mean" in capsys.readouterr().out
    assert run("compare", out, rendered, "--min-psnr", "12", "--min-ssim", "0.2") == 0
    assert run("compare", out, rendered, "--min-psnr", "99", "--min-ssim", "0.99", "--max-relmse", "0") == 1
    said = capsys.readouterr().err
    assert "0: PSNR" in said
    assert "below 99 dB" in said
    assert "2: relMSE" in said


def test_settings_reach_the_filter(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("denoise", rendered, "-o", tmp_path, "--set", "iterations=2") == 0
    said = capsys.readouterr().out
    assert "atrous 2" in said
    assert "atrous 3" not in said


def test_single_files_are_denoised_in_the_order_given(rendered: Path, tmp_path: Path) -> None:
    assert run("denoise", rendered / NAMES[0], rendered / NAMES[1], "-o", tmp_path) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == NAMES[:2]


def test_compare_finds_a_picture_equal_to_itself(rendered: Path) -> None:
    picture = rendered / NAMES[0]
    assert run("compare", picture, picture, "--min-psnr", "200", "--min-ssim", "1", "--max-relmse", "0") == 0


def test_nan_misses_every_threshold(frames: Path) -> None:
    picture = read_picture(frames / NAMES[0])
    picture[0, 0] = np.nan
    write_picture(frames / "nan.exr", picture)
    assert run("compare", frames / "nan.exr", frames / NAMES[0], "--min-psnr", "1") == 1
    assert run("compare", frames / "nan.exr", frames / NAMES[0], "--max-relmse", "1000") == 1


def test_demo_prints_gain_times_and_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("demo", "--frames", "2", "--size", "32x18", "--reference-spp", "4", "-o", tmp_path) == 0
    said = capsys.readouterr()
    for words in ("device: ", "gain", "atrous 1", f"{tmp_path}/preview.webp"):
        assert words in said.out
    assert said.err == "", "no progress bar where stderr is no terminal"
    assert (tmp_path / "still.0001.png").exists()


# Wrong input


@pytest.mark.parametrize("size", ["640", "0x360", "640x360x3", "axb", "-1x5"])
def test_a_bad_size(size: str, tmp_path: Path, refused) -> None:
    refused("--size: expected WIDTHxHEIGHT", "render", "cornell", f"--size={size}", "-o", tmp_path)


def test_a_size_that_no_memory_holds(tmp_path: Path, refused) -> None:
    refused("--size: expected at most 32768 pixels a side", "render", "cornell", "--size=1x32769", "-o", tmp_path)
    refused("--size: expected at most 32768 pixels a side", "bench", "--size", "100000x100000")


def test_a_demo_too_small_to_be_measured(tmp_path: Path, refused) -> None:
    refused("--size: expected at least 11x11 pixels", "demo", "--size", "8x8", "-o", tmp_path / "demo")
    assert not (tmp_path / "demo").exists(), "refused before the long work, not after it"


@pytest.mark.parametrize("stops", ["2000", "-65", "nan", "inf"])
def test_a_bad_exposure(stops: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected stops in -64..64", "denoise", rendered, "-o", tmp_path, "--png", f"--exposure={stops}")
    refused("expected stops in -64..64", "compare", rendered, rendered, f"--exposure={stops}")


@pytest.mark.parametrize("option", ["--min-psnr", "--min-ssim", "--max-relmse"])
def test_a_threshold_that_is_no_number(option: str, rendered: Path, refused) -> None:
    refused(f"'{option}': expected a number, got nan", "compare", rendered, rendered, option, "nan")


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


def test_pictures_of_an_earlier_run_are_not_mixed_in(frames: Path, tmp_path: Path, refused) -> None:
    assert run("denoise", frames, "-o", tmp_path / "clean", "--png") == 0
    assert run("denoise", frames, "-o", tmp_path / "clean", "--png") == 0
    refused("left by an earlier run", "denoise", frames / NAMES[0], "-o", tmp_path / "clean")


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--version") == 0
    assert capsys.readouterr().out == f"svgf-cl {__version__}\n"


def test_missing_and_empty_input(tmp_path: Path, refused) -> None:
    refused("nowhere: expected a file or a folder", "denoise", tmp_path / "nowhere", "-o", tmp_path / "out")
    refused("expected files named frame.0000.exr", "denoise", tmp_path, "-o", tmp_path / "out")
    refused("expected files named", "compare", tmp_path, tmp_path)


def test_sizes_that_differ(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[1])
    cropped = {name: np.ascontiguousarray(value[:-2]) for name, value in frame.present().items()}
    write_frame(frames / NAMES[1], replace(frame, **cropped))
    refused("0001.exr: expected 32x18 pixels", "denoise", frames, "-o", frames / "out")
    refused("0001.exr: expected 32x18 pixels", "compare", frames / NAMES[1], frames / NAMES[0])


def test_an_absent_field(frames: Path, refused) -> None:
    planes = read_channels(frames / NAMES[0])
    write_channels(frames / NAMES[0], {n: p for n, p in planes.items() if not n.startswith("normal")})
    refused("expected channels normal.X normal.Y normal.Z, found R G B", "denoise", frames, "-o", frames / "out")


def test_fields_that_change_within_a_sequence(frames: Path, refused) -> None:
    write_frame(frames / NAMES[1], replace(read_frame(frames / NAMES[1]), albedo=None))
    refused("0001.exr: expected the fields of", "denoise", frames, "-o", frames / "out")
    (frames / NAMES[1]).unlink()
    refused("0001.exr: expected this frame between", "denoise", frames, "-o", frames / "out")


def test_a_frame_of_nothing_but_nan(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[2])
    write_frame(frames / NAMES[2], replace(frame, color=np.full_like(frame.color, np.nan)))
    refused("0002.exr: expected finite values in color", "denoise", frames, "-o", frames / "out")


def test_an_output_that_cannot_be_written(rendered: Path, tmp_path: Path, refused) -> None:
    (tmp_path / "file").touch()
    for argv in (("render", "cornell"), ("denoise", rendered), ("demo",)):
        refused("cannot be made a folder", *argv, "-o", tmp_path / "file" / "out")


def test_denoise_never_replaces_its_input(rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected an output folder other than the input's", "denoise", rendered, "-o", rendered)
    twice = (rendered / NAMES[0], rendered / NAMES[0])
    refused("frames of different names", "denoise", *twice, "-o", tmp_path / "out")


@pytest.mark.parametrize(
    ("text", "words"),
    [("sigma=1", "a name out of iterations,"), ("iterations=9", "in 1..5"), ("taa=maybe", "expected on or off"),
     ("sigma_depth=wide", "expected a number in"), ("iterations=2.5", "expected a whole number in 1..5")],
)  # fmt: skip
def test_a_bad_setting(text: str, words: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused(words, "denoise", rendered, "-o", tmp_path, "--set", text)


def test_compare_wants_like_with_like(frames: Path, refused) -> None:
    refused("two files or two folders", "compare", frames, frames / NAMES[0])
    (frames / "few").mkdir()
    shutil.copy(frames / NAMES[0], frames / "few")
    refused("expected a picture number 1", "compare", frames / "few", frames)


def test_rendering_without_the_tracer_says_how_to_get_it(tmp_path: Path, refused, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "svgf_cl_tracer.api", None)
    refused("pip install '.[tracer]'", "render", "cornell", "-o", tmp_path)
    refused("pip install '.[tracer]'", "demo", "-o", tmp_path)


def test_measuring_without_scikit_image_says_how_to_get_it(
    rendered: Path, tmp_path: Path, refused, monkeypatch
) -> None:
    for module in ("skimage", "skimage.metrics"):
        monkeypatch.setitem(sys.modules, module, None)
    refused("pip install '.[metrics]'", "compare", rendered, rendered)
    refused("pip install '.[metrics]'", "demo", "-o", tmp_path / "demo")
    assert not (tmp_path / "demo").exists(), "refused before the long work, not after it"


# bench


@pytest.fixture
def quick_ceilings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ceilings of no worth, measured at once, and an error that was not measured."""
    monkeypatch.setattr("svgf_cl.bench.ceilings.WORKING_SETS", (2**22,))
    monkeypatch.setattr("svgf_cl.bench.ceilings.COPIED", 1)
    monkeypatch.setattr("svgf_cl.bench.station.error_to_oracle", lambda *_, **__: (2e-7, 1e-7))
    monkeypatch.setattr("svgf_cl.bench.suite.timed_devices", lambda: [devices.choose(devices.list_devices())])


@pytest.mark.usefixtures("quick_ceilings")
def test_bench_writes_a_report_and_compares(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ("bench", "--only", "frame.16x9", "--size", "16x9", "--seconds", "0", "-o", tmp_path)
    assert run(*argv) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "results.json", "summary.png"]
    shown = capsys.readouterr().out
    assert "svgf.frame.16x9" in shown
    assert "2.0e-07" in shown, "speed stands beside error"
    assert run(*argv, "--compare", tmp_path / "results.json") == 0
    assert "times faster" in capsys.readouterr().out
    assert "times faster" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_what_bench_cannot_make_sense_of(tmp_path: Path, refused) -> None:
    refused("--only: expected a regular expression, got '('", "bench", "--only", "(")
    refused("cannot be read", "bench", "--compare", tmp_path / "none.json")
    refused("--only: expected part of a name", "bench", "--only", "nothing.of.the.kind")


def test_bench_without_its_extra_says_what_to_install(monkeypatch: pytest.MonkeyPatch, refused) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    monkeypatch.delitem(sys.modules, "svgf_cl.bench.report", raising=False)
    monkeypatch.delattr("svgf_cl.bench.report", raising=False)
    refused("pip install '.[bench]'", "bench")


def test_bench_tracer_has_help_with_an_example(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("bench", "tracer", "--help") == 0
    assert "svgf-cl bench tracer" in capsys.readouterr().out.split("Examples:")[1]
    assert run("bench", "--help") == 0
    assert "\n  tracer " in capsys.readouterr().out


def test_bench_tracer_writes_and_compares(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    measured = made_up.tracer_results()
    monkeypatch.setattr("benchmarks.tracing.suite.measure", lambda *_: measured)
    assert run("bench", "tracer", "cornell", "-o", tmp_path) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["results.json", "split.png"]
    shown = capsys.readouterr().out
    for words in ("over raw Embree", "relMSE", "shadow", "G-buffer", "nothing compiled yet", "holds"):
        assert words in shown
    assert run("bench", "tracer", "--compare", tmp_path / "results.json") == 0
    assert "times faster" in capsys.readouterr().out


def test_what_bench_tracer_cannot_make_sense_of(tmp_path: Path, refused) -> None:
    refused("nowhere: expected a scene's folder or file", "bench", "tracer", "nowhere")
    refused("--size: expected WIDTHxHEIGHT", "bench", "tracer", "--size", "big")
    refused("'--rounds'", "bench", "tracer", "--rounds", "0")
    refused("cannot be read", "bench", "tracer", "--compare", tmp_path / "none.json")
    refused("expected options of 'tracer' behind its name", "bench", "--size", "16x9", "tracer")


def test_bench_tracer_without_an_extra_says_what_to_install(monkeypatch: pytest.MonkeyPatch, refused) -> None:
    monkeypatch.setitem(sys.modules, "psutil", None)
    for module in ("suite", "fresh"):
        monkeypatch.delitem(sys.modules, f"benchmarks.tracing.{module}", raising=False)
        monkeypatch.delattr(f"benchmarks.tracing.{module}", raising=False)
    refused("pip install '.[bench]'", "bench", "tracer")
    monkeypatch.setitem(sys.modules, "svgf_cl_tracer.api", None)
    refused("pip install '.[tracer]'", "bench", "tracer")

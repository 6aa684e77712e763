"""``svgf-cl denoise`` as people use it."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.cli import remarks
from svgf_cl.io.exr import read_channels, read_image, write_channels
from svgf_cl.io.frames import read_frame, write_frame
from svgf_cl.io.pictures import read_picture
from svgf_cl.io.synthetic import room_frames
from svgf_cl.io.window import Window
from tests.command_line import NAMES, contents, run
from tests.exr_files import exr_bytes
from tests.frames import wall


def test_settings_reach_the_filter(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("denoise", rendered, "-o", tmp_path, "--set", "iterations=2") == 0
    said = capsys.readouterr().out
    assert "atrous 2" in said
    assert "atrous 3" not in said


def test_single_files_are_denoised_in_the_order_of_their_numbers(rendered: Path, tmp_path: Path) -> None:
    for number, place in enumerate((9, 10, 11)):
        shutil.copy(rendered / NAMES[number], tmp_path / f"shot.{place}.exr")
    assert run("denoise", rendered, "-o", tmp_path / "right") == 0
    assert run("denoise", *sorted(tmp_path.glob("*.exr")), "-o", tmp_path / "out") == 0
    for number, place in enumerate((9, 10, 11)):
        assert (tmp_path / "out" / f"shot.{place}.exr").read_bytes() == (
            tmp_path / "right" / NAMES[number]
        ).read_bytes()


def test_history_ends_at_a_gap(frames: Path, tmp_path: Path, refused) -> None:
    frames.joinpath(NAMES[1]).unlink()
    refused("--allow-gaps", "denoise", frames, "-o", tmp_path / "out")
    assert run("denoise", frames, "-o", tmp_path / "out", "--allow-gaps") == 0
    assert run("denoise", frames / NAMES[2], "-o", tmp_path / "alone") == 0
    assert contents(tmp_path / "alone").items() < contents(tmp_path / "out").items()


def test_a_warning_is_one_line(frames: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (frames / "frame.0003.exr.part").touch()
    assert run("denoise", frames, "-o", tmp_path) == 0
    said = capsys.readouterr().err
    assert said.startswith(f"svgf-cl: warning: {frames}: not read, though named much like ")
    assert said.count("\n") == 1


@pytest.mark.parametrize("name", ["shot.EXR", "shot", "shot.v1.tif"])
def test_a_picture_is_called_as_its_frame(name: str, rendered: Path, tmp_path: Path) -> None:
    shutil.copy(rendered / NAMES[0], tmp_path / name)
    assert run("denoise", tmp_path / name, "-o", tmp_path / "out") == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == [f"{name.removesuffix('.EXR')}.exr"]


@pytest.mark.parametrize("stops", ["2000", "-65", "nan", "inf"])
def test_a_bad_exposure(stops: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected stops in -64..64", "denoise", rendered, "-o", tmp_path, "--png", f"--exposure={stops}")


def test_pictures_of_an_earlier_run_are_not_mixed_in(frames: Path, tmp_path: Path, refused) -> None:
    assert run("denoise", frames, "-o", tmp_path / "clean", "--png") == 0
    assert run("denoise", frames, "-o", tmp_path / "clean", "--png") == 0
    refused("left by an earlier run", "denoise", frames / NAMES[0], "-o", tmp_path / "clean")


def test_missing_and_empty_input(tmp_path: Path, refused) -> None:
    refused("nowhere: expected a file or a folder", "denoise", tmp_path / "nowhere", "-o", tmp_path / "out")
    refused("expected files named frame.0000.exr", "denoise", tmp_path, "-o", tmp_path / "out")


def test_sizes_that_differ(frames: Path, refused) -> None:
    frame = read_frame(frames / NAMES[1])
    cropped = {name: np.ascontiguousarray(value[:-2]) for name, value in frame.present().items()}
    write_frame(frames / NAMES[1], replace(frame, **cropped))
    refused("0001.exr: expected the display window 32x18 at 0,0", "denoise", frames, "-o", frames / "out")


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
    refused("cannot be a folder for the output", "denoise", rendered, "-o", tmp_path / "file" / "out")


def test_denoise_never_replaces_its_input(rendered: Path, tmp_path: Path, refused) -> None:
    refused("expected an output folder other than the input's", "denoise", rendered, "-o", rendered)
    twice = (rendered / NAMES[0], rendered / NAMES[0])
    refused("expected every file once", "denoise", *twice, "-o", tmp_path / "out")


@pytest.mark.parametrize(
    ("text", "words"),
    [("sigma=1", "a name out of alpha_color,"), ("iterations=9", "in 1..5"), ("taa=maybe", "expected on or off"),
     ("sigma_depth=wide", "expected a number in"), ("iterations=2.5", "expected a whole number in 1..5")],
)  # fmt: skip
def test_a_bad_setting(text: str, words: str, rendered: Path, tmp_path: Path, refused) -> None:
    refused(words, "denoise", rendered, "-o", tmp_path, "--set", text)


def test_another_filter(rendered: Path, tmp_path: Path) -> None:
    assert run("denoise", rendered, "-o", tmp_path / "eaw", "--filter", "eaw", "--set", "sigma_color=2") == 0
    assert run("denoise", rendered, "-o", tmp_path / "svgf") == 0
    for name in NAMES:
        one, other = (read_channels(tmp_path / kind / name) for kind in ("eaw", "svgf"))
        assert one.keys() == other.keys()
        assert any((one[channel] != other[channel]).any() for channel in one)


def test_a_filter_that_is_none(rendered: Path, tmp_path: Path, refused) -> None:
    refused("or sbf or lbf or accumulation, got 'nlm'", "denoise", rendered, "-o", tmp_path, "--filter", "nlm")
    refused("a name out of", "denoise", rendered, "-o", tmp_path, "--filter", "eaw", "--set", "sigma_luminance=1")


def test_all_but_the_light_passes_through(rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("denoise", rendered, "-o", tmp_path / "out") == 0
    assert run("denoise", rendered, "-o", tmp_path / "picture", "--no-passes") == 0
    assert run("denoise", rendered, "-o", tmp_path / "plain", "--plain") == 0
    light = {*"RGB", *(f"{name}.{c}" for name in ("direct", "indirect") for c in "RGB")}
    for name in NAMES:
        noisy, clean, plain = (read_image(folder / name) for folder in (rendered, tmp_path / "out", tmp_path / "plain"))
        picture = read_channels(tmp_path / "picture" / name)
        assert clean.planes.keys() == noisy.planes.keys() > plain.planes.keys() == {"R", "G", "B"}
        assert changed(noisy.planes, clean.planes) == light
        assert changed(noisy.planes, picture) == {"R", "G", "B"}
        assert all(plane.tobytes() == clean.planes[key].tobytes() for key, plane in plain.planes.items())
        for c in "RGB":
            np.testing.assert_allclose(
                clean.planes[f"direct.{c}"] + clean.planes[f"indirect.{c}"], clean.planes[c], rtol=1e-6, atol=1e-7
            )
    capsys.readouterr()
    assert run("denoise", rendered, "-o", tmp_path / "out", "--plain") == 0
    assert "kept" not in capsys.readouterr().out
    assert contents(tmp_path / "out") == contents(tmp_path / "plain")


def changed(before: dict[str, np.ndarray], after: dict[str, np.ndarray]) -> set[str]:
    """The channels that are not the same, bit by bit."""
    return {key for key, plane in before.items() if plane.tobytes() != after[key].tobytes()}


def test_another_attribute_or_channel_is_written_though_the_picture_is_the_same(
    frames: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("denoise", frames, "-o", tmp_path / "out") == 0
    planes = read_channels(frames / NAMES[0])
    write_channels(frames / NAMES[0], planes, {"owner": "me"})
    write_channels(frames / NAMES[1], {**read_channels(frames / NAMES[1]), "A": np.ones_like(planes["R"])})
    capsys.readouterr()
    assert run("denoise", frames, "-o", tmp_path / "out") == 0
    assert "1 of them kept" in capsys.readouterr().out
    assert read_image(tmp_path / "out" / NAMES[0]).parts[0].attributes["owner"] == ("string", b"me")
    assert "A" in read_channels(tmp_path / "out" / NAMES[1])


def test_a_window_that_moves_over_a_still_picture_changes_nothing(tmp_path: Path) -> None:
    """Far from what no window had, a picture is what whole frames give; it lies where its frame did."""
    noise, display = np.random.default_rng(3).exponential(1.0, (4, 16, 40, 3)).astype(np.float32), Window(0, 0, 40, 16)
    (tmp_path / "whole").mkdir()
    (tmp_path / "moving").mkdir()
    for name, color, x in zip((*NAMES, "frame.0003.exr"), noise, (0, 3, 8, 2), strict=True):
        write_frame(tmp_path / "whole" / name, wall((16, 40), color=color))
        cut = {
            key: np.ascontiguousarray(plane[:, x:]) for key, plane in read_channels(tmp_path / "whole" / name).items()
        }
        (tmp_path / "moving" / name).write_bytes(exr_bytes(cut, at=(x, 0), display=display))
    for kind in ("whole", "moving"):
        assert run("denoise", tmp_path / kind, "-o", tmp_path / f"{kind} out", "--png", "--set", "iterations=1") == 0
    whole, moving = (read_picture(tmp_path / f"{kind} out" / "frame.0003.exr") for kind in ("whole", "moving"))
    np.testing.assert_array_equal(moving[:, 16:], whole[:, 16:])
    assert not moving[:, :2].any()
    assert moving[:, 2:].all()
    windows = read_image(tmp_path / "moving out" / "frame.0003.exr").windows
    assert windows.data == Window(2, 0, 38, 16)
    assert windows.display == display
    assert run("compare", tmp_path / "moving out", tmp_path / "whole out") == 0
    assert run("check", tmp_path / "moving") in (0, 1)


def test_the_first_frames_of_a_shot_in_chunks_are_checked_once_and_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Warm-ups go over the same frames again, which no motion leads to."""
    frames = list(room_frames((18, 32), 10))
    (tmp_path / "shot").mkdir()
    for number, frame in enumerate(frames):
        write_frame(tmp_path / "shot" / f"frame.{number:04d}.exr", frame)
    checked = []
    monkeypatch.setattr(remarks.Inspection, "add", lambda self, frame: checked.append(frame.color))
    for chunk in (("--chunk", "2", "--warm-up", "2"), ()):
        checked.clear()
        assert run("denoise", tmp_path / "shot", "-o", tmp_path / "out", *chunk) == 0
        assert len(checked) == remarks.FIRST
        np.testing.assert_array_equal(checked, [frame.color for frame in frames[: remarks.FIRST]])

"""What `denoise` says of frames: the fields it reads, and what is wrong in the first ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Frame, SvgfError
from svgf_cl.cli import remarks
from svgf_cl.cli.remarks import described
from svgf_cl.io.exr import read_image, write_channels
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.separate import SeparateFiles
from svgf_cl.io.shot import Shot
from svgf_cl.io.synthetic import room_frames
from svgf_cl.shot_walk import ShotWalk
from tests import renderers
from tests.command_line import run
from tests.renderers import BLENDER_HEADER, blender, moments

SHAPE = (90, 160)
PLAIN = ["R", "G", "B", "normal.X", "normal.Y", "normal.Z", "depth.Z", "motion.X", "motion.Y"]
FULL = [*PLAIN, "motion.Z", "id", *(f"{field}.{c}" for field in ("albedo", "emission") for c in "RGB")]


@pytest.fixture(scope="module")
def room() -> list[Frame]:
    return list(room_frames(SHAPE, 4))


def written(folder: Path, frames: list[Frame]) -> Path:
    folder.mkdir(exist_ok=True)
    for number, frame in enumerate(frames):
        write_frame(frame_path(folder, number), frame)
    return folder


def said(capsys: pytest.CaptureFixture[str], *argv: str | Path) -> tuple[str, str]:
    """What a command that ends well writes to stdout and stderr."""
    capsys.readouterr()
    assert run("denoise", *argv) == 0
    captured = capsys.readouterr()
    return captured.out, captured.err


def changed(room: list[Frame], field: str, change) -> list[Frame]:
    return [replace(frame, **{field: change(getattr(frame, field)).astype(np.float32)}) for frame in room]


def line(folder: Path, names: list[str]) -> str:
    """What is said of a frame with these channels."""
    planes = {name: np.ones((3, 4), np.float32) for name in names}
    write_channels(folder / "frame.0000.exr", planes)
    shot = Shot([folder / "frame.0000.exr"])
    return described(shot, shot.read(0))


def test_one_line_says_what_is_read_and_what_that_costs(tmp_path: Path) -> None:
    text = line(tmp_path, PLAIN)
    assert text.startswith(
        "read as frames of svgf_cl, or of another renderer with its channel names: "
        "color (R G B), normal (normal.X Y Z), motion (motion.X Y), depth (depth.Z); missing: "
    )
    for field in ("albedo", "id", "emission", "motion.Z"):
        assert f"{field} ({remarks.COSTS[field]})" in text
    assert "\n" not in text
    assert "ignored" not in text


def test_what_is_there_is_not_missing(tmp_path: Path) -> None:
    assert "albedo (albedo.R G B)" in line(tmp_path, FULL)
    every = [*FULL, "roughness", *(f"{field}.{c}" for field in ("direct", "indirect") for c in "RGB")]
    assert "missing" not in line(tmp_path, every)
    assert line(tmp_path, every).endswith("; light passes: direct.R G B, indirect.R G B")


def test_what_is_ignored_is_named_only_where_its_field_is_missing(tmp_path: Path) -> None:
    extra = ["A", "Z", "P.X", "P.Y", "P.Z", "Albedo.R", "Albedo.G", "Albedo.B"]
    text = line(tmp_path, [*PLAIN, *extra])
    assert text.endswith("; ignored: Albedo.R G B looks like albedo: if it is, give --map albedo=Albedo")
    assert "ignored" not in line(tmp_path, [*FULL, *extra])


def test_both_commands_say_it(tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path / "in", room)
    out, err = said(capsys, folder, "-o", tmp_path / "out")
    assert out.count("read as ") == 1
    assert not err
    assert run("check", folder) == 0
    assert capsys.readouterr().out.startswith("read as frames of svgf_cl")


@pytest.mark.parametrize(("field", "other"), [("depth.Z", "Z"), ("normal.X", "N.X"), ("motion.X", "Vector.X")])
def test_an_error_names_what_a_field_may_be(tmp_path: Path, room: list[Frame], field: str, other: str, refused) -> None:
    folder = written(tmp_path, room[:1])
    old, new = field.partition(".")[0], other.partition(".")[0]
    planes = {name.replace(f"{old}.Z", "Z") if other == "Z" else name.replace(old, new): plane
              for name, plane in read_image(folder / "frame.0000.exr").planes.items()}  # fmt: skip
    write_channels(folder / "frame.0000.exr", planes)
    refused(f"{other}", "denoise", folder, "-o", tmp_path / "out")
    refused(f"like {old}: if it is, give --map {old}={new}", "denoise", folder, "-o", tmp_path / "out")


def test_a_mistake_is_a_warning_and_no_check_keeps_quiet(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = written(tmp_path / "in", changed(room, "normal", lambda normal: 0.5 * normal + 0.5))
    _, err = said(capsys, folder, "-o", tmp_path / "out")
    assert "svgf-cl: warning: normal: encoded in 0..1; give 2 n - 1, and 0 where the ray hit nothing\n" in err
    assert "--no-check turns them off" in err
    assert "Traceback" not in err
    assert said(capsys, folder, "-o", tmp_path / "out", "--no-check")[1] == ""


def test_only_first_frames_are_checked(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    frames = [*room[:2], *changed(room[2:], "albedo", lambda albedo: 255 * albedo)]
    folder = written(tmp_path / "in", frames)
    assert "albedo: above 1" in said(capsys, folder, "-o", tmp_path / "out")[1]
    monkeypatch.setattr(remarks, "FIRST", 2)
    assert said(capsys, folder, "-o", tmp_path / "out")[1] == ""


def test_a_gap_is_no_mistake(tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path / "in", room)
    (folder / "frame.0001.exr").unlink()
    assert said(capsys, folder, "-o", tmp_path / "out", "--allow-gaps")[1] == ""


@pytest.mark.parametrize("beyond", [0.0, 1e10, np.inf])
def test_negative_depth_is_refused(tmp_path: Path, room: list[Frame], beyond: float, refused, capsys) -> None:
    """As the z of a camera that looks along -z; misses may be a great number."""

    def negated(depth: np.ndarray) -> np.ndarray:
        depth = -depth
        depth[:9] = beyond
        return depth

    folder = written(tmp_path / "in", changed(room, "depth", negated))
    refused("frame.0000.exr: expected depth above 0", "denoise", folder, "-o", tmp_path / "out", "--no-check")
    assert run("check", folder) == 1
    assert "negative" in capsys.readouterr().out


@pytest.mark.parametrize(("depth", "what"), [(0.0, "0 where there is a normal"), (np.inf, "empty everywhere")])
def test_empty_depth_is_named(
    tmp_path: Path, room: list[Frame], depth: float, what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = written(tmp_path / "in", changed(room, "depth", lambda given: given * 0 + depth))
    err = said(capsys, folder, "-o", tmp_path / "out")[1]
    assert f"depth: {what}" in err
    assert "correct depth first" not in err


def test_a_shot_of_nothing_but_sky_is_said(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    sky = changed(changed(room, "depth", lambda depth: depth + np.inf), "normal", np.zeros_like)
    assert "depth: the rays hit nothing" in said(capsys, written(tmp_path / "in", sky), "-o", tmp_path / "out")[1]


def test_the_next_frame_s_motion_in_the_third_component_is_said(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    vectors = changed(room, "motion", lambda motion: np.stack([motion[..., 0], motion[..., 1], 9 - motion[..., 0]], -1))
    err = said(capsys, written(tmp_path / "in", vectors), "-o", tmp_path / "out")[1]
    assert "motion: third component is not the change of depth; give previous minus current depth, or only two" in err


def test_motion_that_motion_blur_left_out_is_said(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    tiles = np.repeat(np.repeat(np.random.default_rng(4).uniform(0.1, 1.0, (15, 32, 3)), 6, 0), 5, 1)
    still = changed(room, "motion", np.zeros_like)
    lost = [replace(frame, albedo=np.roll(tiles, 4 * number, axis=1).astype(np.float32))
            for number, frame in enumerate(still)]  # fmt: skip
    assert (
        "with motion blur, renderers write no motion"
        in said(capsys, written(tmp_path / "in", lost), "-o", tmp_path / "out")[1]
    )
    assert (
        "with motion blur, renderers write no motion"
        not in said(capsys, written(tmp_path / "in2", room), "-o", tmp_path / "out2")[1]
    )
    assert (
        "with motion blur, renderers write no motion"
        not in said(capsys, written(tmp_path / "in3", still[:1] * 4), "-o", tmp_path / "out3")[1]
    )


def test_a_mistake_is_said_before_later_frames_are_filtered(
    tmp_path: Path, room: list[Frame], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise SvgfError("filtered")

    folder = written(tmp_path / "shot", changed(room, "normal", lambda normal: 0.5 * normal + 0.5))
    monkeypatch.setattr(ShotWalk, "estimates", fail)
    assert run("denoise", folder, "-o", tmp_path / "out", "--look-ahead", "all") == 2
    captured = capsys.readouterr()
    assert "read as" in captured.out
    assert "warning: normal: encoded" in captured.err
    assert captured.err.endswith("filtered\n")


def test_a_field_of_its_own_is_said_with_its_file(tmp_path: Path) -> None:
    planes = {name: np.ones((3, 4), np.float32) for name in PLAIN}
    write_channels(tmp_path / "frame.0000.exr", planes)
    write_channels(tmp_path / "albedo.0000.exr", {name: np.ones((3, 4), np.float32) for name in "RGB"})
    shot = Shot([tmp_path / "frame.0000.exr"], separate=SeparateFiles.of({"albedo": tmp_path / "albedo.####.exr"}))
    assert "albedo (albedo.0000.exr)" in described(shot, shot.read(0))


def test_what_every_chunk_warns_of_is_said_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    planes = {at.number: blender(at) for at in moments()}
    brighter = {
        number: {name: 2 * plane if ".DiffDir." in name else plane for name, plane in channels.items()}
        for number, channels in planes.items()
    }
    folder = renderers.written(tmp_path / "shot", brighter, BLENDER_HEADER)
    _, err = said(capsys, folder, "-o", tmp_path / "out", "--chunk", "1", "--warm-up", "0")
    assert err.count("the light passes add up to more than the picture") == 1

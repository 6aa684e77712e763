"""A sequence that is killed leaves whole files alone; the same command goes on and ends as if nothing had happened."""

from __future__ import annotations

import errno
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.io.exr import read_image
from svgf_cl.io.frames import frame_path, read_frame, write_frame
from svgf_cl.io.synthetic import room_frames
from tests.command_line import assert_goes_on, contents, run, run_signalled


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four frames of the room; not to be changed."""
    folder = tmp_path_factory.mktemp("rendered")
    for number, frame in enumerate(room_frames((18, 32), 4, signals=2)):
        write_frame(frame_path(folder, number), frame)
    return folder


@pytest.fixture(scope="module")
def denoised(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same, denoised without a break; not to be changed."""
    folder = tmp_path_factory.mktemp("denoised")
    assert run("denoise", rendered, "--png", "-o", folder) == 0
    return folder


def test_a_killed_run_is_gone_on_with(rendered: Path, tmp_path: Path) -> None:
    assert_goes_on(("denoise", rendered, "--png"), (1, 2), tmp_path)


@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT"])
def test_a_terminated_run_ends_in_one_line_with_whole_files_alone(
    name: str, rendered: Path, denoised: Path, tmp_path: Path
) -> None:
    ended = run_signalled(name, 2, "denoise", rendered, "--png", "-o", tmp_path / "out")
    assert ended.returncode == 130
    assert ended.stderr == "svgf-cl: interrupted\n"
    done = contents(tmp_path / "out")
    assert {"frame.0000.exr", "frame.0001.exr"} <= done.keys()
    assert done.items() < contents(denoised).items()
    assert run("denoise", rendered, "--png", "-o", tmp_path / "out") == 0
    assert contents(tmp_path / "out") == contents(denoised)


def test_denoise_keeps_only_what_it_would_make(rendered: Path, denoised: Path, tmp_path: Path, capsys) -> None:
    frames, out = Path(shutil.copytree(rendered, tmp_path / "in")), Path(shutil.copytree(denoised, tmp_path / "out"))
    frame = read_frame(frames / "frame.0001.exr")
    frame.color[3, 5] += 1.0
    frame.direct[3, 5] += 1.0
    write_frame(frames / "frame.0001.exr", frame)
    assert run("denoise", frames, "--png", "-o", out) == 0
    assert "1 of them kept" in capsys.readouterr().out, "frame 0, which comes before the change"
    assert run("denoise", frames, "--png", "-o", tmp_path / "anew") == 0
    assert contents(out) == contents(tmp_path / "anew") != contents(denoised)
    assert run("denoise", frames, "--png", "-o", out, "--set", "iterations=2") == 0
    assert run("denoise", frames, "--png", "-o", tmp_path / "other", "--set", "iterations=2") == 0
    assert contents(out) == contents(tmp_path / "other") != contents(tmp_path / "anew")


def test_a_damaged_frame_leaves_those_before_it_done(rendered: Path, denoised: Path, tmp_path: Path, capsys) -> None:
    frames, out = Path(shutil.copytree(rendered, tmp_path / "in")), tmp_path / "out"
    damaged = frames / "frame.0002.exr"
    whole = damaged.read_bytes()
    damaged.write_bytes(whole[: len(whole) // 2])
    assert run("denoise", frames, "--png", "-o", out) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"svgf-cl: {damaged}: expected a complete image, got a damaged one")
    assert said.count("\n") == 1
    done = {name: content for name, content in contents(denoised).items() if "0000" in name or "0001" in name}
    assert contents(out) == done
    damaged.write_bytes(whole)
    assert run("denoise", frames, "--png", "-o", out) == 0
    assert contents(out) == contents(denoised)


def test_no_picture_of_another_run_stays_beside(rendered: Path, denoised: Path, tmp_path: Path, capsys) -> None:
    out = Path(shutil.copytree(denoised, tmp_path / "out"))
    for argv in ((rendered / "frame.0000.exr", "--png"), (rendered,)):
        for path in out.glob("*.exr"):
            path.unlink()
        assert run("denoise", *argv, "-o", out) == 2
        assert "left by an earlier run" in capsys.readouterr().err
    assert not list(out.glob("*.exr"))


def test_a_link_to_itself_is_replaced_and_one_to_the_input_is_not(rendered: Path, tmp_path: Path, capsys) -> None:
    (tmp_path / "out").mkdir()
    target = tmp_path / "out" / "frame.0000.exr"
    target.symlink_to(target)
    assert run("denoise", rendered, "-o", tmp_path / "out") == 0
    assert np.isfinite(read_image(target).planes["R"]).all()
    (tmp_path / "linked").symlink_to(rendered)
    assert run("denoise", rendered, "-o", tmp_path / "linked") == 2
    assert "expected an output folder other than the input's" in capsys.readouterr().err


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="/proc tells which file is written")
def test_a_disk_that_fills_up_leaves_what_is_done(
    rendered: Path, denoised: Path, tmp_path: Path, capsys, monkeypatch
) -> None:
    """As the third picture is written; then there is room again, for the fourth, which is written meanwhile, too."""
    out, sync, full_at = tmp_path / "out", os.fsync, ["frame.0002.exr"]

    def full(descriptor: int) -> None:
        if full_at and full_at[0] in os.readlink(f"/proc/self/fd/{descriptor}"):
            full_at.clear()
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", full)
    assert run("denoise", rendered, "--png", "-o", out) == 2
    said = capsys.readouterr().err
    assert said == f"svgf-cl: {out / 'frame.0002.exr'}: cannot be written (No space left on device)\n"
    done = contents(out)
    assert {f"frame.000{number}.{suffix}" for number in range(2) for suffix in ("exr", "png")} <= done.keys()
    assert "frame.0002.exr" not in done
    assert done.items() < contents(denoised).items()
    assert run("denoise", rendered, "--png", "-o", out) == 0
    assert f"{sum(name.endswith('exr') for name in done)} of them kept" in capsys.readouterr().out
    assert contents(out) == contents(denoised)


@pytest.mark.parametrize("output", ["/proc/a", "/dev/null/a", "file/a/b"])
def test_an_output_that_cannot_be_is_refused_before_any_work(output: str, tmp_path: Path, refused, monkeypatch) -> None:
    (tmp_path / "file").touch()
    damaged, folder = tmp_path / "frame.0000.exr", tmp_path / output
    damaged.write_text("it would be an error to read this")
    monkeypatch.setattr("svgf_cl.bench.suite.Suite.run", None)
    for argv in (
        ("denoise", damaged, "-o", folder),
        ("check", damaged, "-o", folder / "a.png"),
        ("bench", "-o", folder),
    ):
        refused("cannot be a folder for the output", *argv)


def test_a_run_that_fails_leaves_no_empty_folder(rendered: Path, tmp_path: Path, refused, monkeypatch) -> None:
    damaged, out = tmp_path / "frame.0000.exr", tmp_path / "a" / "b"
    damaged.write_bytes((rendered / "frame.0000.exr").read_bytes()[:1000])
    refused(damaged.name, "denoise", damaged, "-o", out)
    refused(damaged.name, "check", damaged, "-o", out / "a.png")
    refused("iterations", "denoise", rendered, "-o", out, "--set", "iterations=99")
    refused("--only", "bench", "--only", "nothing", "-o", out)

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    refused("No space left on device", "denoise", rendered, "-o", out)
    assert list(tmp_path.iterdir()) == [damaged]


def test_tune_is_refused_where_nothing_can_be_stored(refused, monkeypatch) -> None:
    monkeypatch.setattr("svgf_cl.device.tuning.cache_folder", lambda: Path("/dev/null/cache"))
    monkeypatch.setattr("svgf_cl.bench.tuner.Tuner.search", None)
    refused("/dev/null/cache: cannot be a folder for the output", "tune")


@pytest.mark.parametrize("name", ["a b", "ü 日本", "new\nline", "-dash", "q?x=1", "frame.0000.exr"])
def test_folders_of_any_name(name: str, rendered: Path, denoised: Path, tmp_path: Path) -> None:
    frames = Path(shutil.copytree(rendered, tmp_path / name / "in"))
    assert run("denoise", frames, "--png", "-o", tmp_path / name / "out") == 0
    assert contents(tmp_path / name / "out") == contents(denoised)


def test_a_name_can_do_nothing_to_the_terminal(tmp_path: Path, capsys) -> None:
    for name, shown in (("\x1b[31mred", r"\x1b[31mred"), (os.fsdecode(b"\xff"), r"\udcff")):
        (tmp_path / name).mkdir()
        assert run("denoise", tmp_path / name, "-o", tmp_path / "out") == 2
        assert capsys.readouterr().err.startswith(f"svgf-cl: {tmp_path}/{shown}: expected files named")


def test_a_name_that_is_too_long_is_refused_in_one_line(rendered: Path, tmp_path: Path, capsys) -> None:
    name = "x" * 300
    for argv in (("denoise", name), ("denoise", rendered), ("compare", name, rendered)):
        output = () if argv[0] == "compare" else ("-o", tmp_path / (name if rendered in argv else "out"))
        assert run(*argv, *output) == 2
        said = capsys.readouterr().err
        assert "File name too long" in said
        assert said.count("\n") == 1

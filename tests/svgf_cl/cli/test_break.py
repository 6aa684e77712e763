"""A sequence that is killed leaves whole files alone; the same command goes on and ends as if nothing had happened."""

from __future__ import annotations

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from svgf_cl.cli import main
from svgf_cl.io import cache
from svgf_cl.io.exr import read_channels
from svgf_cl.io.frames import read_frame, write_frame

# Kills the process as the picture with that number is whole but has not got its name yet.
KILLED = """
import os, signal, sys
from pathlib import Path
import svgf_cl_tracer
from svgf_cl.io import cache
from svgf_cl.cli import main
left, folder, rename = int(sys.argv[1]), Path(sys.argv[2]), os.replace
def rename_or_die(source, target):
    global left
    left -= str(target).endswith(".exr")
    if left < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    rename(source, target)
os.replace, cache.cache_folder = rename_or_die, lambda: folder
main(sys.argv[3:])
"""

FRAMES = ("--frames", "4", "--size", "32x18")


def run(*argv: str | Path) -> int:
    """Exit code of ``svgf-cl argv``."""
    with pytest.raises(SystemExit) as left:
        main([str(argument) for argument in argv])
    return int(left.value.code or 0)


def run_killed(after: int, *argv: str | Path) -> None:
    """Run ``svgf-cl argv`` in a process that dies after so many EXR files."""
    command = [sys.executable, "-c", KILLED, str(after), cache.cache_folder(), *argv]
    child = subprocess.run(command, capture_output=True, text=True, check=False)
    assert child.returncode == -signal.SIGKILL, child.stderr


def contents(folder: Path) -> dict[str, bytes]:
    """What is in `folder` and those below, by name."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four frames of the built-in scene; not to be changed."""
    folder = tmp_path_factory.mktemp("rendered")
    assert run("render", "cornell", *FRAMES, "-o", folder) == 0
    return folder


@pytest.fixture(scope="module")
def denoised(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same, denoised without a break; not to be changed."""
    folder = tmp_path_factory.mktemp("denoised")
    assert run("denoise", rendered, "--png", "-o", folder) == 0
    return folder


@pytest.mark.parametrize(
    ("argv", "killed"),
    [
        (("denoise", "RENDERED", "--png"), (1, 2)),
        (("render", "cornell", *FRAMES, "--reference-spp", "16"), (5,)),
        (("demo", *FRAMES, "--reference-spp", "4"), (13,)),
    ],
    ids=lambda value: value[0] if isinstance(value[0], str) else "",
)
def test_a_killed_run_is_gone_on_with(
    argv: tuple[str, ...], killed: tuple[int, ...], rendered: Path, tmp_path: Path
) -> None:
    command = [rendered if argument == "RENDERED" else argument for argument in argv]
    assert run(*command, "-o", tmp_path / "whole") == 0
    whole, broken = contents(tmp_path / "whole"), tmp_path / "broken"
    for after in killed:
        run_killed(after, *command, "-o", broken)
        left = contents(broken)
        hidden = [name for name in left if Path(name).name.startswith(".")]
        assert len(hidden) == 1, "what it was writing"
        assert left.items() - {(name, left[name]) for name in hidden} <= whole.items()
    done = {path: path.stat() for path in broken.rglob("[!.]*.exr")}
    assert len(done) == sum(killed)
    assert run(*command, "-o", broken) == 0
    assert contents(broken) == whole
    frames = [path for path in done if path.name.startswith("frame")]
    assert all(path.stat().st_ino == done[path].st_ino for path in frames), "kept, not written again"


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
    assert said.startswith(f"svgf-cl: {damaged}: expected a whole image, got a damaged one")
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
    assert np.isfinite(read_channels(target)["R"]).all()
    (tmp_path / "linked").symlink_to(rendered)
    assert run("denoise", rendered, "-o", tmp_path / "linked") == 2
    assert "expected an output folder other than the input's" in capsys.readouterr().err


def test_a_disk_that_fills_up_leaves_what_is_done(
    rendered: Path, denoised: Path, tmp_path: Path, capsys, monkeypatch
) -> None:
    """As the third picture is written; then there is room again."""
    out, sync, left = tmp_path / "out", os.fsync, [5]

    def full(descriptor: int) -> None:
        left[0] -= 1
        if not left[0]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", full)
    assert run("denoise", rendered, "--png", "-o", out) == 2
    said = capsys.readouterr().err
    assert said == f"svgf-cl: {out / 'frame.0002.exr'}: cannot be written (No space left on device)\n"
    done = {name: content for name, content in contents(denoised).items() if "0000" in name or "0001" in name}
    assert contents(out) == done
    assert run("denoise", rendered, "--png", "-o", out) == 0
    assert "2 of them kept" in capsys.readouterr().out
    assert contents(out) == contents(denoised)


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
    for argv in (("denoise", name), ("denoise", rendered), ("compare", name, rendered), ("render", name)):
        output = () if argv[0] == "compare" else ("-o", tmp_path / (name if rendered in argv else "out"))
        assert run(*argv, *output) == 2
        said = capsys.readouterr().err
        assert "File name too long" in said
        assert said.count("\n") == 1

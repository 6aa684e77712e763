"""Files appear whole or not at all."""

from __future__ import annotations

import errno
import os
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError
from svgf_cl.io import atomic
from svgf_cl.io.atomic import folder_written_whole, output_file, output_folder, read_json, written_whole
from svgf_cl.io.display import write_image
from svgf_cl.io.panels import write_preview
from tests.disk import files_up_to

PICTURE = np.random.default_rng(3).integers(0, 256, (40, 50, 3), np.uint8)


def test_a_file_appears_when_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    with written_whole(path) as aside:
        aside.write_text("new")
        assert aside.parent == tmp_path, "another file system would need a copy, which can stop half way"
        assert not path.exists()
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_what_breaks_off_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")

    def break_off() -> None:
        with written_whole(path) as aside:
            aside.write_text("ne")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        break_off()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_of_the_system_names_the_file(tmp_path: Path) -> None:
    with (
        pytest.raises(FileError, match=r"a\.txt: cannot be written \(No space left"),
        written_whole(tmp_path / "a.txt"),
    ):
        raise OSError(28, "No space left on device")


def test_an_error_of_the_system_comes_before_any_work(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with (
        pytest.raises(FileError, match=r"a\.txt: cannot be written \(File exists"),
        written_whole(tmp_path / "file" / "a.txt"),
    ):
        pytest.fail("there is nothing to write to")


FULL = {
    "a.txt": lambda path: _write_text(path),
    "a.png": lambda path: write_image(path, PICTURE),
    "a.webp": lambda path: write_image(path, PICTURE),
    "preview.webp": lambda path: write_preview(path, [PICTURE, PICTURE[::-1]]),
}


def _write_text(path: Path) -> None:
    with written_whole(path) as aside:
        aside.write_text("text " * 1000, encoding="utf-8")


@pytest.mark.parametrize("name", FULL)
def test_a_full_disk_is_reported_and_leaves_the_old_file(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    FULL[name](path)
    old = path.read_bytes()
    for limit in (0, 100, len(old) // 2, len(old) - 1):
        with files_up_to(limit), pytest.raises(FileError, match=rf"{name}: cannot be written \(File too large\)"):
            FULL[name](path)
        assert path.read_bytes() == old
        assert list(tmp_path.iterdir()) == [path]
    with files_up_to(len(old)):
        FULL[name](path)
    assert path.read_bytes() == old


def test_what_a_killed_process_left_is_cleared_away_and_what_others_write_is_not(tmp_path: Path) -> None:
    ended = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, check=True)
    here, dead = socket.gethostname(), int(ended.stdout)
    gone = tmp_path / f".a b.exr.{here}-{dead}.tmp"
    others = (f".a.exr.{here}-{os.getppid()}.tmp", f".a.exr.elsewhere-{dead}.tmp", f"a.exr.{here}-{dead}.tmp", ".tmp")
    kept = [tmp_path / name for name in others]
    for path in (gone, *kept):
        path.touch()
    output_folder(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(kept)


def test_json_that_nobody_meant_is_no_more_than_wrong(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    for content in (b"", b"{", b"\xff\xfe\xfa", b"[" * 100_000, b'{"a":' * 100_000):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r".+"):
            read_json(path)
    path.write_text("[1, 2]")
    assert read_json(path) == [1, 2]


def test_folders_are_made_with_the_first_file_and_gone_if_it_fails(tmp_path: Path) -> None:
    path = output_folder(tmp_path / "a" / "b") / "c.txt"
    assert not list(tmp_path.iterdir()), "a run that fails now leaves nothing"
    with pytest.raises(ZeroDivisionError), written_whole(path) as aside:
        aside.write_text(f"{1 / 0}")
    assert not list(tmp_path.iterdir())
    with written_whole(path) as aside:
        aside.write_text("whole")
    assert path.read_text() == "whole"
    with pytest.raises(ZeroDivisionError), written_whole(path.parent / "d" / "e.txt") as aside:
        aside.write_text(f"{1 / 0}")
    assert [place for place in sorted(tmp_path.rglob("*")) if place.is_file()] == [path]
    assert not (path.parent / "d").exists()


def test_a_folder_that_another_process_uses_meanwhile_stays(tmp_path: Path) -> None:
    other = tmp_path / "a" / "another's.txt"
    with pytest.raises(ZeroDivisionError), written_whole(tmp_path / "a" / "b.txt"):
        other.write_text(f"{other.touch()} {1 / 0}")
    assert other.exists()


def test_what_cannot_be_a_folder_is_refused_and_nothing_is_left(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for path in ("file", "file/below", "link", "a/b/" + "x" * 300):
        for whole in (tmp_path / path, Path(os.path.relpath(tmp_path / path))):
            with pytest.raises(FileError, match="cannot be a folder for the output"):
                output_folder(whole)
    assert sorted(place.name for place in tmp_path.iterdir()) == ["file", "link"]


def test_a_folder_that_cannot_be_written_to_is_refused_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(**_: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(tempfile, "TemporaryFile", refuse)  # root may write anywhere
    for path in (tmp_path, tmp_path / "a" / "b"):
        with pytest.raises(FileError, match=r"cannot be a folder for the output \(Read-only file system\)"):
            output_folder(path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("folder", ["/proc", "/proc/self/a", "/dev/null", "/dev/null/a"])
def test_what_root_cannot_write_to_either(folder: str) -> None:
    for check in (output_folder, lambda path: output_file(path / "a.png")):
        with pytest.raises(FileError, match="cannot be a folder for the output"):
            check(Path(folder))


def test_a_file_that_is_a_folder_is_refused(tmp_path: Path) -> None:
    assert output_file(tmp_path / "a" / "b.png") == tmp_path / "a" / "b.png"
    with pytest.raises(FileError, match="expected a file to write, got a folder"):
        output_file(tmp_path)


def test_a_folder_that_another_process_removes_in_between_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As tasks of a farm do that begin at the same time."""
    make, left = atomic._make, [2]

    def made_and_removed(folder: Path) -> list[Path]:
        made = make(folder)
        left[0] -= 1
        if left[0] >= 0:
            folder.rmdir()
        return made

    monkeypatch.setattr(atomic, "_make", made_and_removed)
    assert not atomic.output_folder(tmp_path / "a" / "b").exists()
    left[0] = 2
    atomic.write_text(tmp_path / "a" / "b" / "file", "text")
    assert (tmp_path / "a" / "b" / "file").read_text() == "text"
    left[0] = 1000
    with pytest.raises(FileError, match="cannot be a folder for the output"):
        atomic.output_folder(tmp_path / "c" / "d")
    with pytest.raises(FileError, match="cannot be written"):
        atomic.write_text(tmp_path / "c" / "d" / "file", "text")
    assert not (tmp_path / "c").exists()


def test_a_folder_appears_when_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "made" / "a"
    with folder_written_whole(path) as aside:
        (aside / "b").mkdir()
        (aside / "b" / "c.txt").write_text("new")
        assert not path.exists()
    assert (path / "b" / "c.txt").read_text() == "new"
    assert list(path.parent.iterdir()) == [path]


def test_a_folder_that_breaks_off_leaves_nothing(tmp_path: Path) -> None:
    def break_off() -> None:
        with folder_written_whole(tmp_path / "made" / "a") as aside:
            (aside / "b.txt").write_text("ne")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        break_off()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_not_put_in_the_place_of_another(tmp_path: Path) -> None:
    path = tmp_path / "a"
    with pytest.raises(FileError, match="a: expected a new folder, but it is there already"):  # noqa: SIM117
        with folder_written_whole(path):
            path.mkdir()
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_a_killed_process_left_is_cleared_away(tmp_path: Path) -> None:
    ended = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, check=True)
    gone = tmp_path / f".a.{socket.gethostname()}-{int(ended.stdout)}.tmp"
    gone.mkdir()
    (gone / "b.txt").touch()
    output_folder(tmp_path)
    assert list(tmp_path.iterdir()) == []

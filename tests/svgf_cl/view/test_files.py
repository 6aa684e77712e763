"""Clips of files: read ahead, forgotten again, with references where they are."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import Kalman
from svgf_cl.errors import FileError
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.pictures import read_picture, write_picture
from svgf_cl.io.sequence import find_frames
from svgf_cl.io.shot import Shot
from svgf_cl.io.synthetic import room_frames
from svgf_cl.view import files as module
from svgf_cl.view.files import FilesClip
from svgf_cl.view.player import Player
from tests.command_line import run
from tests.renderers import BLENDER_HEADER, blender, moments, own, written
from tests.svgf_cl.view.clips import SHAPE

COUNT = 6


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rendered")
    for number, frame in enumerate(room_frames(SHAPE, COUNT), 5):
        write_frame(frame_path(folder, number), frame)
    return folder


def clip_of(folder: Path, references: dict[int, Path] | None = None, *, allow_gaps: bool = False) -> FilesClip:
    return FilesClip(Shot(find_frames([folder], allow_gaps=allow_gaps)), references or {})


def test_frames_are_those_of_the_files(rendered: Path) -> None:
    clip = clip_of(rendered)
    assert (clip.name, clip.shape, clip.numbers, clip.has_references) == (
        "/".join(rendered.parts[-2:]),
        SHAPE,
        [5, 6, 7, 8, 9, 10],
        False,
    )
    for index, frame in enumerate(room_frames(SHAPE, COUNT)):
        assert np.array_equal(clip.read(index).noisy, frame.color)
    assert np.array_equal(clip.beginning()[1].noisy, clip.read(1).noisy)


@pytest.mark.parametrize("renderer", ["blender", "own"])
def test_pictures_are_those_that_denoise_writes(renderer: str, tmp_path: Path) -> None:
    if renderer == "blender":
        folder = written(tmp_path / renderer, {at.number: blender(at) for at in moments()}, BLENDER_HEADER)
    else:
        folder = written(tmp_path / renderer, {at.number: own(at) for at in moments()})
    assert run("denoise", folder, "-o", tmp_path / "out", "--plain") == 0
    clip = clip_of(folder)
    player = Player(clip, Kalman())
    for index, path in enumerate(find_frames([tmp_path / "out"])):
        item, made = player.show(index, Kalman())
        assert item.lights, "light passes are filtered one by one"
        assert np.array_equal(made.picture, read_picture(path))


def test_the_next_frames_are_read_ahead_round_the_end(rendered: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clip, read = clip_of(rendered), []
    item = clip._item

    def reading(index: int) -> module.Item:
        read.append(index)
        return item(index)

    monkeypatch.setattr(clip, "_item", reading)
    clip.read(5)
    clip.read(0)
    clip.read(1)
    clip._pool.shutdown()
    assert sorted(read) == [0, 1, 2, 3, 5], "each once"


def test_frames_beyond_memory_are_read_again(rendered: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MEMORY", 1)
    clip = clip_of(rendered)
    first = clip.read(0)
    assert clip.read(0) is first
    for index in range(1, COUNT):
        clip.read(index)
        assert len(clip._read) == 1 + module.AHEAD
    clip.read(3)
    again = clip.read(0)
    assert np.array_equal(again.noisy, first.noisy)


def test_a_frame_that_is_mended_is_shown(rendered: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(rendered, tmp_path / "frames"))
    whole = frame_path(folder, 7).read_bytes()
    clip = clip_of(folder)
    frame_path(folder, 7).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FileError, match=r"frame\.0007\.exr"):
        clip.read(2)
    assert clip.read(3).frame.color is not None
    frame_path(folder, 7).write_bytes(whole)
    assert clip.read(2).frame.color is not None


def test_frames_behind_a_gap_are_cuts(rendered: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(rendered, tmp_path / "frames"))
    frame_path(folder, 7).unlink()
    assert clip_of(folder, allow_gaps=True).cuts == {2}


def test_some_frames_have_references(rendered: Path, tmp_path: Path) -> None:
    picture = np.random.default_rng(0).random((*SHAPE, 3), np.float32)
    write_picture(tmp_path / "reference.0006.exr", picture)
    clip = clip_of(rendered, {6: tmp_path / "reference.0006.exr"})
    assert clip.has_references
    assert clip.read(0).reference is None
    assert np.array_equal(clip.read(1).reference, picture)


def test_a_reference_of_another_size_is_refused(rendered: Path, tmp_path: Path) -> None:
    write_picture(tmp_path / "reference.0006.exr", np.zeros((4, 5, 3)))
    clip = clip_of(rendered, {6: tmp_path / "reference.0006.exr"})
    with pytest.raises(
        FileError, match=r"reference\.0006\.exr: expected 32x18 pixels as .*frame\.0006\.exr has, got 5x4"
    ):
        clip.read(1)

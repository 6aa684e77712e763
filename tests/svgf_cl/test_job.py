"""A shot's files become pictures, all at once or in stretches."""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from svgf_cl import FileError, SvgfError
from svgf_cl.filters import DEFAULT
from svgf_cl.io.exr import read_image
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.sequence import find_frames
from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.io.synthetic import room_frames
from svgf_cl.job import AT_ONCE, Chunk, Done, Job, Style, in_layer, run, steps, target_paths
from svgf_cl.shot_denoiser import Method
from svgf_cl.shot_walk import ShotWalk
from tests.renderers import BLENDER_HEADER, NUMBERS, blender, moments, written


@pytest.fixture
def sources(tmp_path: Path) -> list[Path]:
    planes = {at.number: blender(at) for at in moments()}
    return find_frames([written(tmp_path / "shot", planes, BLENDER_HEADER)])


def job_of(sources: list[Path], folder: Path, **more: object) -> Job:
    method = Method(DEFAULT(**more.pop("settings", {})), **more.pop("method", {}))  # type: ignore[arg-type]
    return Job(tuple(sources), tuple(target_paths(sources, folder)), method, **more)  # type: ignore[arg-type]


def run_all(job: Job) -> Iterator[Done]:
    """Denoise a whole shot."""
    count = len(job.paths)
    return run(job, Chunk(0, range(count), count))


@pytest.fixture(scope="module")
def shots(tmp_path_factory: pytest.TempPathFactory) -> dict[bool, Path]:
    """Folders of six frames, by whether there is a gap in their numbers; not to be changed."""
    folders = {gap: tmp_path_factory.mktemp("shot") for gap in (False, True)}
    for number, frame in enumerate(room_frames((8, 8), 6)):
        for gap, folder in folders.items():
            write_frame(frame_path(folder, number + 10 * (gap and number > 3)), frame)
    return folders


@pytest.mark.parametrize("look_ahead", [None, 0, 1, 2])
@pytest.mark.parametrize("gap", [False, True])
@pytest.mark.parametrize("chunk", [Chunk(0, range(6), 6), Chunk(1, range(3, 5), 6), Chunk(2, range(2, 3), 3)])
def test_it_is_known_how_many_steps_there_are(
    chunk: Chunk, gap: bool, look_ahead: int | None, shots: dict[bool, Path], tmp_path: Path
) -> None:
    job = job_of(find_frames([shots[gap]], allow_gaps=gap), tmp_path / "out", look_ahead=look_ahead)
    taken: list[None] = []
    done = list(run(job, chunk, advance=lambda: taken.append(None)))
    assert len(done) == len(chunk.written)
    assert len(taken) == steps(job, chunk)


def test_each_frame_is_written_when_it_is_done(sources: list[Path], tmp_path: Path) -> None:
    for number, each in zip(NUMBERS, run_all(job_of(sources, tmp_path / "out")), strict=True):
        assert each.target == tmp_path / "out" / f"shot_{number:04d}.exr"
        assert each.target.exists()
        assert not each.kept
        assert all(time >= 0 for time in each.times.values())
    assert all(each.kept for each in run_all(job_of(sources, tmp_path / "out")))


def test_frames_that_warm_up_are_looked_at_and_not_written(sources: list[Path], tmp_path: Path) -> None:
    seen: list[int] = []

    def look(shot: Shot, index: int, source: ShotFrame) -> None:
        assert source.path == shot.paths[index]
        seen.append(index)

    done = list(run(job_of(sources, tmp_path / "out"), Chunk(1, range(2, 3), 3), look))
    assert seen == [1, 2]
    assert [each.target.name for each in done] == ["shot_0003.exr"]
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["shot_0003.exr"]


def test_a_chunk_with_all_of_its_past_is_as_of_the_whole_shot(sources: list[Path], tmp_path: Path) -> None:
    whole = [each.target.read_bytes() for each in run_all(job_of(sources, tmp_path / "whole"))]
    job = job_of(sources, tmp_path / "chunks")
    for chunk in (Chunk(0, range(2), 2), Chunk(0, range(2, 3), 3)):
        assert [each.target for each in run(job, chunk)] == list(job.targets[chunk.written.start : chunk.written.stop])
    assert [target.read_bytes() for target in job.targets] == whole


@pytest.mark.parametrize("look_ahead", [None, 2])
def test_few_frames_are_held_however_many_there_are(look_ahead: int | None, tmp_path: Path) -> None:
    paths = []
    for number, frame in enumerate(room_frames((8, 12), 24)):
        paths.append(frame_path(tmp_path / "in", number))
        write_frame(paths[-1], frame)
    alive: weakref.WeakSet[ShotFrame] = weakref.WeakSet()
    most = 0

    def look(shot: Shot, index: int, source: ShotFrame) -> None:
        nonlocal most
        alive.add(source)
        most = max(most, len(alive))

    job = job_of(paths, tmp_path / "out", look_ahead=look_ahead)
    done = sum(1 for _ in run(job, Chunk(0, range(len(paths)), len(paths)), look))
    assert done == len(paths)
    assert most <= 2 + 2 * AT_ONCE


@pytest.mark.parametrize("frames", [1, 2, 0])
def test_later_frames_make_it_another_one(frames: int, sources: list[Path], tmp_path: Path) -> None:
    """A chunk that reads so far ahead makes what the whole shot does."""
    job = job_of(sources, tmp_path / "out", look_ahead=frames)
    assert [each.target for each in run_all(job)] == list(job.targets)
    first, forward = read_image(job.targets[0]).planes, tmp_path / "forward"
    list(run_all(job_of(sources, forward)))
    assert any((first[name] != plane).any() for name, plane in read_image(forward / "shot_0001.exr").planes.items())
    if frames != 1:  # a block that is cut off begins its backward run elsewhere
        (alone,) = run(job_of(sources, tmp_path / "alone", look_ahead=frames), Chunk(0, range(1), 3))
        assert all((first[name] == plane).all() for name, plane in read_image(alone.target).planes.items())


def test_a_picture_alone_is_written(sources: list[Path], tmp_path: Path) -> None:
    (first, *_) = run_all(job_of(sources, tmp_path / "out", style=Style(plain=True, png=True)))
    assert read_image(first.target).planes.keys() == {"R", "G", "B"}
    assert first.target.with_suffix(".png").exists()


def test_light_passes_may_be_left_alone(sources: list[Path], tmp_path: Path) -> None:
    (first, *_) = run_all(job_of(sources, tmp_path / "out", method={"lights": False}))
    before, after = read_image(sources[0]).planes, read_image(first.target).planes
    different = {name for name, plane in before.items() if plane.tobytes() != after[name].tobytes()}
    assert different == {f"ViewLayer.Combined.{c}" for c in "RGB"}


def test_the_standard_error_lies_beside_the_picture(sources: list[Path], tmp_path: Path) -> None:
    (first, *_) = run_all(job_of(sources, tmp_path / "out", settings={"standard_error": True}))
    error = read_image(first.target).planes["standard_error"]
    assert np.isfinite(error).all()
    assert error.any()


@pytest.mark.parametrize(
    ("channel", "view_layer", "name"),
    [
        ("R", "", "Denoised.R"),
        ("Main Layer.Combined.R", "Main Layer", "Denoised.Combined.R"),
        ("Ebene.001.Combined.R", "Ebene.001", "Denoised.Combined.R"),
        ("diffuse_direct.R", "", "Denoised.diffuse_direct.R"),
        ("standard_error", "Main Layer", "Denoised.standard_error"),
    ],
)
def test_a_layer_takes_the_place_of_the_view_layer(channel: str, view_layer: str, name: str) -> None:
    assert in_layer(channel, view_layer, "Denoised") == name


def test_pictures_are_called_as_their_frames_or_by_a_pattern(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("a.0007.exr", "a.0008.EXR")]
    assert [path.name for path in target_paths(files, tmp_path / "out")] == ["a.0007.exr", "a.0008.exr"]
    assert [path.name for path in target_paths(files, tmp_path / "##.exr")] == ["07.exr", "08.exr"]
    assert target_paths([tmp_path / "still.exr"], tmp_path / "out.####.exr") == [tmp_path / "out.0000.exr"]


def test_no_picture_replaces_a_frame_by_whatever_way_it_is_named(sources: list[Path], tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(sources[0].parent)
    for output in (sources[0].parent, tmp_path / "link", tmp_path / "link" / "shot_####.exr"):
        with pytest.raises(FileError, match="expected an output folder other than the input's"):
            target_paths(sources, output)


def test_a_run_leaves_its_input_as_it_was(sources: list[Path], tmp_path: Path) -> None:
    before = [path.read_bytes() for path in sources]
    done = list(run_all(job_of(sources, tmp_path / "out")))
    assert [path.read_bytes() for path in sources] == before
    assert read_image(done[0].target).windows == read_image(sources[0]).windows


def test_no_standard_error_of_pictures_from_later_frames(sources: list[Path], tmp_path: Path) -> None:
    with pytest.raises(SvgfError, match="standard_error: expected off with --look-ahead"):
        job_of(sources, tmp_path / "out", settings={"standard_error": True}, look_ahead=0)


def test_nothing_is_filtered_behind_the_last_picture_that_is_written(
    sources: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    walked = []
    monkeypatch.setattr(ShotWalk, "begin", lambda self, *, backward: walked.append(backward))
    list(run(job_of(sources, tmp_path / "out", look_ahead=1), Chunk(0, range(1), 2)))
    assert walked == [False, True]

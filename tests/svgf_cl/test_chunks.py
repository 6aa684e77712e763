"""A shot in chunks: the same files from a cluster as from this process, whoever dies, and joins that nobody sees."""

from __future__ import annotations

import os
import shutil
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from distributed import LocalCluster

from svgf_cl import Denoiser, DeviceError, FileError, Kalman
from svgf_cl.chunks import WARM_UP, absolute, cut, denoise_on_cluster
from svgf_cl.compare.metrics import psnr
from svgf_cl.io.display import display
from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.io.synthetic import room_frames
from svgf_cl.job import Chunk, Job
from svgf_cl.job import run as run_job
from svgf_cl.shot_denoiser import Method
from tests.cluster import wait_for_workers
from tests.command_line import contents, run

SHAPE, FRAMES = (18, 32), 13


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Frames of the room; not to be changed."""
    folder = tmp_path_factory.mktemp("shot")
    for number, frame in enumerate(room_frames(SHAPE, FRAMES)):
        write_frame(frame_path(folder, number), frame)
    return folder


def job_of(shot: Path, out: Path, numbers: range = range(FRAMES)) -> Job:
    paths = [frame_path(shot, number) for number in numbers]
    return Job(tuple(paths), tuple(out / path.name for path in paths), Method(Kalman()))


def die_once(shot: Shot, index: int, source: ShotFrame) -> None:
    """End the first worker that comes to frame 6, in the middle of a chunk, as the system does for want of memory."""
    mark = source.path.parent / "died"
    if source.path.name == "frame.0006.exr" and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)


def have_no_device(shot: Shot, index: int, source: ShotFrame) -> None:
    raise DeviceError("no OpenCL device works")


def test_chunks_write_every_frame_once(tmp_path: Path) -> None:
    chunks = cut(job_of(tmp_path, tmp_path), range(3, 13), 4, 2)
    assert chunks == [Chunk(1, range(3, 7), 7), Chunk(5, range(7, 11), 11), Chunk(9, range(11, 13), 13)]


def test_no_frame_before_the_first_or_a_gap_is_filtered(tmp_path: Path) -> None:
    job = job_of(tmp_path, tmp_path, [0, 1, 2, 3, 4, 10, 11, 12, 13, 14])
    assert cut(job, range(1, 10), 3, 4) == [
        Chunk(0, range(1, 4), 4),
        Chunk(0, range(4, 7), 7),
        Chunk(5, range(7, 10), 10),
    ]
    assert cut(job, range(5, 10), 9, 4) == [Chunk(5, range(5, 10), 10)]


def test_a_chunk_reads_as_far_ahead_as_it_looks(tmp_path: Path) -> None:
    job = replace(job_of(tmp_path, tmp_path, [0, 1, 2, 3, 4, 5, 10, 11]), look_ahead=3)
    assert cut(job, range(8), 2, 0) == [
        Chunk(0, range(0, 2), 5),
        Chunk(2, range(2, 4), 6),
        Chunk(4, range(4, 6), 6),
        Chunk(6, range(6, 8), 8),
    ]
    assert cut(replace(job, look_ahead=0), range(1, 2), 9, 0) == [Chunk(1, range(1, 2), 6)]


def test_a_chunk_that_a_killed_worker_was_at_is_done_again(shot: Path, cluster: LocalCluster, tmp_path: Path) -> None:
    frames = Path(shutil.copytree(shot, tmp_path / "frames"))
    here, there = job_of(frames, tmp_path / "here"), job_of(frames, tmp_path / "there")
    chunks = cut(here, range(1, FRAMES), 4, 2)
    for chunk in chunks:
        assert len(list(run_job(here, chunk))) == len(chunk.written)
    before = {worker.pid for worker in cluster.workers.values()}
    done = list(denoise_on_cluster(cluster.scheduler_address, there, chunks, die_once))
    assert (frames / "died").exists()
    assert len(done) == FRAMES - 1
    assert all(each.times for each in done)
    whole = contents(tmp_path / "here")
    assert len(whole) == FRAMES - 1
    # What the killed worker was writing is deleted by the next command.
    assert {name: file for name, file in contents(tmp_path / "there").items() if not name.startswith(".")} == whole
    again = list(denoise_on_cluster(cluster.scheduler_address, there, chunks))
    assert all(each.kept for each in again)
    wait_for_workers(cluster)
    assert not before <= {worker.pid for worker in cluster.workers.values()}


def test_what_a_worker_lacks_is_told_with_its_name(shot: Path, cluster: LocalCluster, tmp_path: Path) -> None:
    address = cluster.scheduler_address
    job = job_of(shot, tmp_path)
    with pytest.raises(DeviceError, match=r"no OpenCL device works \(on the worker .+\)"):
        list(denoise_on_cluster(address, job, cut(job, range(2), 1, 0), have_no_device))
    lost = job_of(tmp_path / "elsewhere", tmp_path)
    with pytest.raises(FileError, match=r"elsewhere.*\(on the worker .+\)"):
        list(denoise_on_cluster(address, lost, cut(lost, range(2), 1, 0)))


def test_paths_are_absolute_on_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    job = absolute(job_of(Path("frames"), Path("out")))
    assert job.paths[0] == tmp_path / "frames" / "frame.0000.exr"
    assert job.targets[0] == tmp_path / "out" / "frame.0000.exr"


def test_the_command_on_a_cluster_writes_what_it_writes_here(
    shot: Path, cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.chdir(shot.parent)
    command = ("denoise", shot.name, "--chunk", "5", "--warm-up", "3", "--frames", "1-12", "--png", "-o")
    assert run(*command, tmp_path / "here") == 0
    said = capsys.readouterr()
    assert run(*command, tmp_path / "there", "--scheduler", cluster.scheduler_address) == 0
    told = capsys.readouterr()
    assert told.out.splitlines()[0] == said.out.splitlines()[0]
    assert told.err == said.err
    assert contents(tmp_path / "there") == contents(tmp_path / "here")
    assert len(contents(tmp_path / "here")) == 2 * (FRAMES - 1)
    assert run(*command, tmp_path / "there", "--scheduler", cluster.scheduler_address) == 0
    assert "12 of them kept" in capsys.readouterr().out


def test_a_join_cannot_be_seen() -> None:
    """Behind the default warm-up a picture is off by less than a tenth of what a frame changes."""
    shape, join = (72, 128), WARM_UP + 8
    frames = list(room_frames(shape, join + 1))
    whole = shown(frames)
    (joined,) = shown(frames[join - WARM_UP :])[-1:]
    change, jump = psnr(whole[-1], whole[-2]), psnr(joined, whole[-1])
    assert jump > 50
    assert jump > change + 20
    (cold,) = shown(frames[join:])
    assert psnr(cold, whole[-1]) < 40, "without a warm-up it is seen"


def shown(frames: list) -> list[np.ndarray]:
    with Denoiser(frames[0].shape, settings=Kalman()) as denoiser:
        return [display(denoiser.denoise(frame)) for frame in frames]

"""A cluster of processes makes, bit by bit, what this one makes, whoever dies on the way."""

from __future__ import annotations

import os
import signal
import socket
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import dask
import numpy as np
import pytest
from distributed import LocalCluster

from svgf_cl import Frame
from svgf_cl.cli import main
from svgf_cl.io import cache
from svgf_cl.io.exr import read_channels
from svgf_cl_tracer import Goal, References, SceneError, Shot, builtin_scene, render_frame, scheduled, scheduling
from svgf_cl_tracer.references import CHUNK
from svgf_cl_tracer.scheduling import here

ROOM = Shot(builtin_scene(), (36, 64), frames=9)
WORKERS = 3


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """A scheduler with workers that are processes, each started again when it dies."""
    with LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=":0", protocol="tcp://") as cluster:
        yield cluster


def kill(cluster: LocalCluster, count: int) -> None:
    """End some workers as the system does where memory runs out."""
    for worker in list(cluster.workers.values())[:count]:
        os.kill(worker.pid, signal.SIGKILL)


def fail(shot: Shot, item: int) -> int:
    if item == 2:
        raise SceneError("scene: expected a roof")
    return item


def end_worker(shot: Shot, item: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def assert_same(found: Frame, expected: Frame) -> None:
    assert found.present().keys() == expected.present().keys()
    for name, values in expected.present().items():
        np.testing.assert_array_equal(getattr(found, name), values)


def test_without_a_cluster_work_is_done_when_it_is_asked_for() -> None:
    done: list[int] = []
    with scheduled(None) as run:
        results = run(lambda shot, item: done.append(item) or (shot, item), ROOM, range(5))
        assert not done
        assert next(results) == (ROOM, 0)
        assert done == [0]
    assert run is here


@pytest.mark.parametrize("killed", [1, WORKERS])
def test_a_reference_loses_nothing_when_workers_are_killed(
    killed: int, cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path / "local")
    expected = References(ROOM).render(4, 12 * CHUNK)
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path / "cluster")
    before = {worker.pid for worker in cluster.workers.values()}
    with scheduled(cluster.scheduler_address) as run:
        growing = References(ROOM).refine(4, Goal(12 * CHUNK), run)
        for _ in range(3):
            next(growing)
        kill(cluster, killed)
        *_, found = growing
    assert len(before - {worker.pid for worker in cluster.workers.values()}) == killed
    assert found.history == expected.history
    np.testing.assert_array_equal(found.light, expected.light)
    np.testing.assert_array_equal(found.squares, expected.squares)


def test_frames_come_in_order_when_a_worker_is_killed(cluster: LocalCluster) -> None:
    task, moving = partial(render_frame, spp=4, seed=3), replace(ROOM, scene=builtin_scene("swing"))
    with scheduled(cluster.scheduler_address) as run:
        frames = run(task, moving, range(ROOM.frames))
        found = [next(frames)]
        kill(cluster, 1)
        found += frames
    for one, other in zip(found, here(task, moving, range(ROOM.frames)), strict=True):
        assert_same(one, other)


def test_few_results_wait_to_be_fetched(cluster: LocalCluster) -> None:
    drawn: list[int] = []
    with scheduled(cluster.scheduler_address) as run:
        results = run(fail, ROOM, (drawn.append(item) or item for item in range(100, 200)))
        assert [next(results) for _ in range(10)] == list(range(100, 110))
        results.close()
    assert 10 <= len(drawn) <= 10 + 2 * WORKERS


def test_what_goes_wrong_in_a_task_is_raised_here(cluster: LocalCluster) -> None:
    with scheduled(cluster.scheduler_address) as run:
        results = run(fail, ROOM, range(9))
        assert [next(results), next(results)] == [0, 1]
        with pytest.raises(SceneError, match="expected a roof"):
            next(results)


def test_a_task_that_kills_every_worker_is_given_up() -> None:
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0", protocol="tcp://") as cluster,
        scheduled(cluster.scheduler_address) as run,
        pytest.raises(SceneError, match="workers die of a task"),
    ):
        next(run(end_worker, ROOM, range(3)))


def test_workers_with_another_tracer_are_refused(cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scheduling, "tracer_version", lambda: "another")
    with scheduled(cluster.scheduler_address) as run, pytest.raises(SceneError, match="workers with this version"):
        next(run(fail, ROOM, range(9)))


def test_render_on_a_cluster_writes_the_same_files(
    cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    render = ["render", "cornell", "--frames", "2", "--size", "32x18", "--reference-spp", "16", "--until-error", "0.1"]
    for folder, where in (("here", []), ("there", ["--scheduler", cluster.scheduler_address])):
        monkeypatch.setattr(cache, "cache_folder", lambda folder=folder: tmp_path / f"cache {folder}")
        with pytest.raises(SystemExit) as left:
            main([*render, *where, "-o", str(tmp_path / folder)])
        assert not left.value.code
    files = sorted(path.name for path in (tmp_path / "here").iterdir())
    assert files == ["frame.0000.exr", "frame.0001.exr", "reference.0000.exr", "reference.0001.exr"]
    for name in files:
        one, other = (read_channels(tmp_path / folder / name) for folder in ("here", "there"))
        assert one.keys() == other.keys()
        for channel, values in one.items():
            np.testing.assert_array_equal(other[channel], values)


def refused(address: str, words: str) -> None:
    with pytest.raises(SceneError, match=words), scheduled(address):
        pass


def test_a_scheduler_that_is_gone_in_between() -> None:
    with (
        LocalCluster(n_workers=1, processes=False, dashboard_address=":0", protocol="tcp://") as cluster,
        scheduled(cluster.scheduler_address) as run,
    ):
        results = run(fail, ROOM, range(100, 200))
        next(results)
        cluster.close()
        with pytest.raises(SceneError, match="the connection was lost"):
            list(results)


def test_a_scheduler_without_workers() -> None:
    with LocalCluster(n_workers=0, processes=False, dashboard_address=":0", protocol="tcp://") as cluster:
        refused(cluster.scheduler_address, "has no worker yet; start one: dask worker tcp://")


def test_a_worker_is_no_scheduler(cluster: LocalCluster) -> None:
    refused(next(iter(cluster.scheduler.workers)), "expected a Dask scheduler at tcp://.*, found a Worker")


@pytest.mark.parametrize("address", ["nonsense", "xyz://127.0.0.1:1", "tcp://127.0.0.1:{unused}", "tcp://{mute}"])
def test_an_address_without_a_scheduler(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scheduling, "PATIENCE", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as mute:  # accepts, and says nothing
        with socket.create_server(("127.0.0.1", 0)) as closed:
            unused = closed.getsockname()[1]
        where = address.format(unused=unused, mute=f"127.0.0.1:{mute.getsockname()[1]}")
        refused(where, f"expected a Dask scheduler at {where}, found none")


def test_dask_is_asked_for_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    refused("tcp://127.0.0.1:1", r"pip install '.\[dask\]'")

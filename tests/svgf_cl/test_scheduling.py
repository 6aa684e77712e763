"""A cluster of processes hands back what this one would, in order, whoever dies on the way; its errors are clear."""

from __future__ import annotations

import os
import signal
import socket
import sys
from collections.abc import Iterable
from pathlib import Path

import dask
import pytest
from distributed import LocalCluster

from svgf_cl import FileError, SchedulerError, scheduling
from svgf_cl.scheduling import here, scheduled
from tests.cluster import WORKERS, kill, local_cluster


def version() -> str:
    return "this"


def process() -> str:
    return str(os.getpid())


def added(shared: dict[str, int], item: int) -> int:
    if item == 2:
        raise FileError("file: expected a roof")
    return shared["summand"] + item


def end_worker(shared: str, item: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def results_of(run: scheduling.Map, items: Iterable[int], summand: int = 0):
    """Of `added`; what is shared cannot be hashed."""
    return run(added, {"summand": summand}, items)


def test_without_a_cluster_work_is_done_when_it_is_asked_for() -> None:
    done: list[int] = []
    with scheduled(None, version) as run:
        results = run(lambda shared, item: done.append(item) or (shared, item), "shared", range(5))
        assert not done
        assert next(results) == ("shared", 0)
        assert done == [0]
    assert run is here


def test_a_cluster_has_the_results_in_order_when_workers_are_killed(cluster: LocalCluster) -> None:
    with scheduled(cluster.scheduler_address, version) as run:
        results = results_of(run, range(100, 130), 1000)
        found = [next(results)]
        kill(cluster, WORKERS)
        found += results
    assert found == list(range(1100, 1130))


def test_few_results_wait_to_be_fetched(cluster: LocalCluster) -> None:
    drawn: list[int] = []
    with scheduled(cluster.scheduler_address, version) as run:
        results = results_of(run, (drawn.append(item) or item for item in range(100, 200)))
        assert [next(results) for _ in range(10)] == list(range(100, 110))
        results.close()
    assert 10 <= len(drawn) <= 10 + 2 * WORKERS


def test_what_goes_wrong_in_a_task_is_raised_here(cluster: LocalCluster) -> None:
    with scheduled(cluster.scheduler_address, version) as run:
        results = results_of(run, range(9))
        assert [next(results), next(results)] == [0, 1]
        with pytest.raises(FileError, match="expected a roof"):
            next(results)


def test_a_task_that_kills_every_worker_is_given_up() -> None:
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        local_cluster(1) as cluster,
        scheduled(cluster.scheduler_address, version) as run,
        pytest.raises(SchedulerError, match="workers die while they work on a task"),
    ):
        next(run(end_worker, "shared", range(1)))


def test_workers_with_another_version_are_refused(cluster: LocalCluster) -> None:
    with (
        scheduled(cluster.scheduler_address, process) as run,
        pytest.raises(SchedulerError, match="workers with this version"),
    ):
        next(results_of(run, range(9)))


def test_workers_without_a_package_are_named(
    cluster: LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "only_here.py").write_text("def function(shared, item):\n    return item\n")
    monkeypatch.syspath_prepend(tmp_path)
    import only_here

    with (
        scheduled(cluster.scheduler_address, version) as run,
        pytest.raises(SchedulerError, match=r"lacks a package \(No module named 'only_here'\)"),
    ):
        next(run(only_here.function, "shared", range(9)))


def refused(address: str, words: str) -> None:
    with pytest.raises(SchedulerError, match=words), scheduled(address, version):
        pass


def test_a_scheduler_that_is_gone_in_between() -> None:
    with (
        local_cluster(1, processes=False) as cluster,
        scheduled(cluster.scheduler_address, version) as run,
    ):
        results = results_of(run, range(100, 200))
        next(results)
        cluster.close()
        with pytest.raises(SchedulerError, match="the connection was lost"):
            list(results)


def test_a_scheduler_without_workers() -> None:
    with local_cluster(0, processes=False) as cluster:
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
    refused("tcp://127.0.0.1:1", r"pip install 'svgf-cl\[dask\]'")

"""A Dask cluster on this machine, whose workers can be killed."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager

import dask
from distributed import LocalCluster, Status
from distributed.utils import get_mp_context

from svgf_cl.device import tuning
from tests.denoising import NARROW

WORKERS = 2

# Workers are forked from one process that has imported what they need, which takes 1.5 seconds; it leaves out what is
# not installed. Such a worker begins so soon that it may ask a killed one for its results, of whose death the scheduler
# has not heard yet: it must not try for long.
IMPORTED = ["pytest", "distributed.nanny", "svgf_cl.cli", "svgf_cl.chunks", "svgf_cl_tracer.api", __name__]
dask.config.set({"distributed.worker.multiprocessing-method": "forkserver", "distributed.comm.timeouts.connect": "5s"})
get_mp_context().set_forkserver_preload(IMPORTED)


@contextmanager
def local_cluster(workers: int = WORKERS, *, processes: bool = True) -> Iterator[LocalCluster]:
    """A scheduler with workers that are processes, each started again when it dies; or threads."""
    cluster = LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=processes,
        dashboard_address=":0",
        protocol="tcp://",
        preload=__name__,
    )
    with cluster:
        yield cluster
        if processes:
            wait_for_workers(cluster)


def wait_for_workers(cluster: LocalCluster) -> None:
    """Wait until the same workers have run for half a second: Dask cannot close one that is being started again."""
    begin = since = time.monotonic()
    before = running(cluster)
    while time.monotonic() - since < 0.5 or len(before) < len(cluster.workers):
        time.sleep(0.05)
        now = running(cluster)
        since = since if now == before else time.monotonic()
        before = now
        assert time.monotonic() - begin < 60, "a killed worker is not replaced"


def running(cluster: LocalCluster) -> set[int]:
    """The processes of those workers that run; a nanny may take a moment to notice that its worker is dead."""
    nannies = cluster.workers.values()
    return {each.pid for each in nannies if each.process and each.process.status is Status.running}


def dask_setup(worker: object) -> None:
    """Let a worker that starts use vectors of the same width as this process."""
    tuning.default_tuning = lambda device: NARROW


def kill(cluster: LocalCluster, count: int) -> None:
    """End some workers as the system does where memory runs out."""
    for worker in list(cluster.workers.values())[:count]:
        os.kill(worker.pid, signal.SIGKILL)

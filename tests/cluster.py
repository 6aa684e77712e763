"""A Dask cluster on this machine, whose workers can be killed."""

from __future__ import annotations

import os
import signal

from distributed import LocalCluster

WORKERS = 3


def local_cluster(workers: int = WORKERS, *, processes: bool = True) -> LocalCluster:
    """A scheduler with workers that are processes, each started again when it dies; or threads."""
    return LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=processes, dashboard_address=":0", protocol="tcp://"
    )


def kill(cluster: LocalCluster, count: int) -> None:
    """End some workers as the system does where memory runs out."""
    for worker in list(cluster.workers.values())[:count]:
        os.kill(worker.pid, signal.SIGKILL)

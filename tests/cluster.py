"""A Dask cluster on this machine, whose workers can be killed."""

from __future__ import annotations

import os
import signal

import dask
from distributed import LocalCluster
from distributed.utils import get_mp_context

WORKERS = 2

# Workers are copies of a process that has imported all this once: otherwise it takes each 1.5 seconds. What is
# not installed is left out.
IMPORTED = ["distributed", "svgf_cl.cli", "svgf_cl.chunks", "svgf_cl_tracer.api"]


def local_cluster(workers: int = WORKERS, *, processes: bool = True) -> LocalCluster:
    """A scheduler with workers that are processes, each started again when it dies; or threads."""
    dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"})
    get_mp_context().set_forkserver_preload(IMPORTED)  # after the call, which sets what Dask imports
    return LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=processes, dashboard_address=":0", protocol="tcp://"
    )


def kill(cluster: LocalCluster, count: int) -> None:
    """End some workers as the system does where memory runs out."""
    for worker in list(cluster.workers.values())[:count]:
        os.kill(worker.pid, signal.SIGKILL)

"""Chunks of a shot that different processes denoise; each filters some frames before its own, for the history."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from svgf_cl.errors import DeviceError, FileError
from svgf_cl.fingerprint import library_version
from svgf_cl.io.separate import SeparateFiles
from svgf_cl.io.sequence import after_gaps
from svgf_cl.job import Chunk, Done, Job, run
from svgf_cl.scheduling import scheduled
from svgf_cl.shot_walk import Look

# Frames that are filtered before the first one that is written. With so many, the picture at a join differs from that
# of an uncut shot by an eighth at most of what changes from one frame to the next anyway, where rays are jittered
# (docs/farm.md has the table).
WARM_UP = 32
# Frames of a chunk on a cluster: with `WARM_UP` more, half as much work again as for the shot in one piece.
CHUNK = 64


def cut(job: Job, written: range, size: int, warm_up: int) -> list[Chunk]:
    """Divide the frames to write into chunks of this length.

    Each filters `warm_up` more before them, and as many behind them as the job looks ahead, as far as there are any
    between two gaps: history ends at a gap.
    """
    gaps = after_gaps(job.paths)
    begins = [index for index, path in enumerate(job.paths) if path in gaps]
    ahead = 0 if job.look_ahead is None else job.look_ahead or len(job.paths)
    chunks = []
    for start in written[::size]:
        stop = min(start + size, written.stop)
        first = max(0, start - warm_up, *(begin for begin in begins if begin <= start))
        end = min(len(job.paths), stop + ahead, *(begin for begin in begins if begin >= stop))
        chunks.append(Chunk(first, range(start, stop), end))
    return chunks


def denoise_on_cluster(address: str, job: Job, chunks: list[Chunk], look: Look | None = None) -> Iterator[Done]:
    """Denoise chunks on the workers of a Dask cluster, which read and write the files themselves.

    Parameters
    ----------
    address : str
        Of the scheduler.
    job : Job
        Its files must be the same for all machines.
    chunks : list of Chunk
    look : callable, optional
        As of `job.run`, called on the workers.

    Yields
    ------
    Done
        Of all frames in order; those of a chunk when all of it is done.

    Raises
    ------
    SchedulerError
        As of `scheduled`.
    SvgfError
        As of `job.run`; files and devices are named with the worker.
    """
    with scheduled(address, library_version) as run_on:
        for frames in run_on(partial(_on_worker, look), absolute(job), chunks):
            yield from frames


def absolute(job: Job) -> Job:
    """The same job for a process that runs in another folder."""
    separate = {
        field: {number: path.absolute() for number, path in files.items()}
        for field, files in job.separate.paths.items()
    }
    return replace(
        job,
        paths=tuple(path.absolute() for path in job.paths),
        targets=tuple(path.absolute() for path in job.targets),
        separate=SeparateFiles(separate),
    )


def _on_worker(look: Look | None, job: Job, chunk: Chunk) -> list[Done]:
    """One task; errors that depend on the machine name it."""
    try:
        return list(run(job, chunk, look))
    except (DeviceError, FileError) as error:
        raise type(error)(f"{error} (on the worker {socket.gethostname()})") from error

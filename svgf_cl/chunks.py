"""Divides a shot into chunks that different processes can denoise; each chunk also filters some earlier frames."""

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

# Frames that are filtered before the first one that is written. With this many, the picture at a join differs from that
# of an undivided shot by at most an eighth of the usual change between two frames, if rays are jittered (docs/farm.md
# has the table).
WARM_UP = 32
# Frames of a chunk on a cluster: with `WARM_UP` more, the work is 1.5 times that for the shot in one piece.
CHUNK = 64


def cut(job: Job, written: range, size: int, warm_up: int) -> list[Chunk]:
    """Divide the frames to write into chunks of `size` frames.

    Each chunk also filters `warm_up` frames before its own, and as many frames after them as the job looks ahead, but
    none beyond a gap, because history ends there.
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
        The scheduler's address.
    job : Job
        Its files must be the same on all machines.
    chunks : list of Chunk
    look : callable, optional
        As in `job.run`, but called on the workers.

    Yields
    ------
    Done
        For all frames in order; those of a chunk come when the whole chunk is done.

    Raises
    ------
    SchedulerError
        As in `scheduled`.
    SvgfError
        As in `job.run`; errors about files and devices name the worker.
    """
    with scheduled(address, library_version) as run_on:
        for frames in run_on(partial(_on_worker, look), absolute(job), chunks):
            yield from frames


def absolute(job: Job) -> Job:
    """Return the job with absolute paths, for a process in another folder."""
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
    """Run one task; errors that depend on the machine name it."""
    try:
        return list(run(job, chunk, look))
    except (DeviceError, FileError) as error:
        raise type(error)(f"{error} (on the worker {socket.gethostname()})") from error

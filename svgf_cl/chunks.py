"""A shot cut into chunks that different processes denoise: each filters some frames before its own to have a past."""

from __future__ import annotations

import socket
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from svgf_cl.errors import DeviceError, FileError
from svgf_cl.fingerprint import library_version
from svgf_cl.io.separate import SeparateFiles
from svgf_cl.io.sequence import after_gaps
from svgf_cl.job import Job, Look, run
from svgf_cl.scheduling import scheduled

# Frames that are filtered before the first one that is written. With so many, the picture at a join differs from that
# of an uncut shot by an eighth at most of what changes from one frame to the next anyway, where rays are jittered
# (docs/farm.md has the table).
WARM_UP = 32
# Frames of a chunk on a cluster: with `WARM_UP` more, half as much work again as for the shot in one piece.
CHUNK = 64


@dataclass(frozen=True)
class Chunk:
    """A stretch of a shot.

    Parameters
    ----------
    first : int
        Index of the first frame that is filtered.
    written : range
        Indices of the frames that are written.
    """

    first: int
    written: range


class FrameDone(NamedTuple):
    """What is told of a frame that is written: whether its file was there and the same, and milliseconds of passes."""

    kept: bool
    times: Mapping[str, float]


def cut(job: Job, written: range, size: int, warm_up: int) -> list[Chunk]:
    """Cut the frames that are to be written into chunks of so many.

    Each filters `warm_up` more before them, as far as there are any behind the last gap: history ends at a gap.
    """
    gaps = after_gaps(job.paths)
    begins = [index for index, path in enumerate(job.paths) if path in gaps]
    return [
        Chunk(
            max(0, start - warm_up, *(begin for begin in begins if begin <= start)),
            range(start, min(start + size, written.stop)),
        )
        for start in written[::size]
    ]


def denoise_chunk(job: Job, chunk: Chunk, look: Look | None = None) -> Iterator[FrameDone]:
    """Denoise a chunk and write its files; parameters and errors are those of `job.run`."""
    part = job.part(range(chunk.first, chunk.written.stop))
    for done in run(part, chunk.written.start - chunk.first, look):
        yield FrameDone(done.kept, done.times)


def denoise_on_cluster(address: str, job: Job, chunks: list[Chunk], look: Look | None = None) -> Iterator[FrameDone]:
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
    FrameDone
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


def _on_worker(look: Look | None, job: Job, chunk: Chunk) -> list[FrameDone]:
    """One task. What depends on the machine is told with its name."""
    try:
        return list(denoise_chunk(job, chunk, look))
    except (DeviceError, FileError) as error:
        raise type(error)(f"{error} (on the worker {socket.gethostname()})") from error

"""`Job`: reads the files of a shot and writes pictures, of the whole shot or of one of its chunks."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from svgf_cl.errors import FileError, SvgfError
from svgf_cl.filters.kalman import STANDARD_ERROR, Kalman
from svgf_cl.io.display import to_bytes
from svgf_cl.io.display import write_image as write_png
from svgf_cl.io.exr import write_image
from svgf_cl.io.image import Image
from svgf_cl.io.layers import RGB
from svgf_cl.io.overlap import in_order
from svgf_cl.io.patterns import has_number, numbered
from svgf_cl.io.pictures import channels, denoised_file, holds
from svgf_cl.io.reading import ReadAs
from svgf_cl.io.separate import SeparateFiles
from svgf_cl.io.sequence import after_gaps, number_of
from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.io.window import placed
from svgf_cl.lights import Denoised
from svgf_cl.look_ahead import blocks, both_ways
from svgf_cl.shot_denoiser import Method, ShotDenoiser
from svgf_cl.shot_walk import Look, ShotWalk

# While a frame is filtered, this many frames are read at once, and as many are written. Compression takes most of the
# time, and uses one thread for each frame; more frames need more memory.
AT_ONCE = min(4, max(2, (os.cpu_count() or 1) // 2))


@dataclass(frozen=True)
class Style:
    """What to write for each frame.

    Parameters
    ----------
    plain : bool
        Write only the picture, as ``R G B``.
    layer : str, optional
        A new layer for the denoised channels; by default they replace the noisy ones.
    png : bool
        Write a tone-mapped PNG, too.
    exposure : float
        Stops by which the PNG is brightened.
    """

    plain: bool = False
    layer: str | None = None
    png: bool = False
    exposure: float = 0.0


@dataclass(frozen=True)
class Job:
    """The description of how to denoise a shot; another process can denoise a part of it.

    Parameters
    ----------
    paths : tuple of Path
        The frames of the shot, in order.
    targets : tuple of Path
        The file to write for each.
    method : Method
    how : ReadAs
        How to read files.
    separate : SeparateFiles
        Further files of each frame.
    style : Style
        What to write.
    look_ahead : int, optional
        Number of later frames that each picture uses, too; 0 for all of them, None for none.

    Raises
    ------
    SvgfError
        If standard errors are on with `look_ahead`: the errors of the two runs are not independent.
    """

    paths: tuple[Path, ...]
    targets: tuple[Path, ...]
    method: Method
    how: ReadAs = field(default_factory=ReadAs)
    separate: SeparateFiles = field(default_factory=lambda: SeparateFiles({}))
    style: Style = field(default_factory=Style)
    look_ahead: int | None = None

    def __post_init__(self) -> None:
        settings = self.method.settings
        if self.look_ahead is not None and isinstance(settings, Kalman) and settings.standard_error:
            raise SvgfError("standard_error: expected off with --look-ahead, which does not estimate it, got on")


@dataclass(frozen=True)
class Chunk:
    """A range of frames of a shot, by index.

    Parameters
    ----------
    first : int
        The first frame that is filtered.
    written : range
        The frames that are written.
    end : int
        One after the last frame that is filtered, because `written` may need later frames.
    """

    first: int
    written: range
    end: int


@dataclass(frozen=True, eq=False)
class Made:
    """A denoised frame.

    Parameters
    ----------
    source : ShotFrame
        The frame as it was read.
    denoised : Denoised
    times : mapping of str to float
        Milliseconds of each pass on the device.
    """

    source: ShotFrame
    denoised: Denoised
    times: Mapping[str, float]


@dataclass(frozen=True)
class Done:
    """A written frame.

    Parameters
    ----------
    target : Path
    kept : bool
        Whether the same file was there already.
    times : mapping of str to float
        Milliseconds of each pass on the device.
    """

    target: Path
    kept: bool
    times: Mapping[str, float]


def steps(job: Job, chunk: Chunk) -> int:
    """Return how many frames `run` filters for a chunk, in both directions."""
    if job.look_ahead is None:
        return chunk.written.stop - chunk.first
    gaps = after_gaps(job.paths)
    cuts = [n for n, path in enumerate(job.paths[chunk.first : chunk.end]) if n and path in gaps]
    count = chunk.written.stop - chunk.first  # blocks that begin after these frames are not run
    found = [each for each in blocks(chunk.end - chunk.first, cuts, job.look_ahead or None) if each[0] < count]
    return count + sum(end - start for start, _, end in found)


def run(job: Job, chunk: Chunk, look: Look | None = None, advance: Callable[[], None] = lambda: None) -> Iterator[Done]:
    """Denoise a chunk of a shot and write its files; frames are read and written while others are filtered.

    Parameters
    ----------
    job : Job
    chunk : Chunk
    look : callable, optional
        Called for every frame before it is filtered, with the shot, the frame's index and the frame.
    advance : callable
        Called after each of `steps`.

    Yields
    ------
    Done
        For each frame that is written, in order.

    Raises
    ------
    FileError
        If a file cannot be read or written, or lacks a field.
    SvgfError
        As in `Denoiser.denoise`.
    """
    shot = Shot(job.paths, job.how, job.separate)
    frames = made(shot, job, chunk, look, advance)
    wanted = ((job.targets[index], frame) for index, frame in frames if index in chunk.written)
    yield from in_order(lambda each: finished(shot, job.style, *each), wanted, AT_ONCE)


def made(
    shot: Shot, job: Job, chunk: Chunk, look: Look | None, advance: Callable[[], None]
) -> Iterator[tuple[int, Made]]:
    """Yield the index and the result of each frame of a chunk, in order, up to the last one that is written."""
    if job.look_ahead is None:
        for each in made_forward(shot, job.method, range(chunk.first, chunk.written.stop), look):
            advance()
            yield each
        return
    walk = ShotWalk(shot, job.method, range(chunk.first, chunk.end), look, advance)
    for (index, source), parts in both_ways(walk, walk.cuts, job.look_ahead or None):
        yield index, Made(source, walk.composed(parts), walk.forward.profile())
        if index == chunk.written[-1]:  # so that the next block does not run
            return


def made_forward(shot: Shot, method: Method, places: range, look: Look | None) -> Iterator[tuple[int, Made]]:
    """Yield the same as `made`, from earlier frames only."""
    denoiser = ShotDenoiser(shot.shape, method, len(shot.reading.lights))
    first, second = shot.beginning()  # the same for all chunks, so that all are treated alike
    denoiser.settle(second.frame, second.lights, first.frame)
    for index, source in zip(places, in_order(shot.read, places, AT_ONCE), strict=True):
        if look:
            look(shot, index, source)
        if index in shot.cuts:
            denoiser.reset()
        yield index, Made(source, denoiser.denoise(source.frame, source.lights), denoiser.profile())


def finished(shot: Shot, style: Style, target: Path, made: Made) -> Done:
    """Write the files of a frame."""
    kept = write(target, result(shot, made.source, made.denoised, style))
    if style.png:
        shown = placed(made.denoised.picture, shot.window, made.source.image.windows.display, 0.0)
        write_png(png_of(target), to_bytes(shown, style.exposure))
    return Done(target, kept, made.times)


def result(shot: Shot, source: ShotFrame, denoised: Denoised, style: Style) -> Image:
    """Return the file of a denoised frame: its source file, with denoised channels in place of noisy ones or added."""
    own = source.image.windows.data
    planes = channels(placed(denoised.picture, shot.window, own, 0.0), RGB if style.plain else shot.reading.picture)
    for names, light in {} if style.plain else denoised.lights.items():
        planes |= channels(placed(light, shot.window, own, 0.0), names)
    if denoised.standard_error is not None:
        planes[STANDARD_ERROR] = placed(denoised.standard_error, shot.window, own, 0.0)
    if style.layer:
        planes = {in_layer(name, shot.reading.view_layer, style.layer): plane for name, plane in planes.items()}
        if there := planes.keys() & source.image.planes.keys():
            raise FileError(
                f"{source.path}: expected no layer {style.layer!r} yet, found {min(there)}; choose another name"
            )
    return denoised_file(planes, source.image, beside=shot.reading.picture[0], plain=style.plain)


def in_layer(channel: str, view_layer: str, layer: str) -> str:
    """Return a channel's name in another layer, which replaces its view layer if it has one."""
    return f"{layer}.{channel.removeprefix(f'{view_layer}.' if view_layer else '')}"


def write(target: Path, image: Image) -> bool:
    """Write the file of a frame, unless the same file exists, bit by bit; return whether it existed."""
    kept = holds(target, image)
    if not kept:
        write_image(target, image)
    return kept


def png_of(target: Path) -> Path:
    """Return the path of the PNG beside a picture's file."""
    return target.with_suffix(".png")


def target_paths(sources: Sequence[Path], output: Path) -> list[Path]:
    """Return the file to write for each frame: in a folder with the frame's own name, or by a pattern and its number.

    Raises
    ------
    FileError
        If one would replace a frame.
    """
    if has_number(output):
        targets = [numbered(output, number_of(source)) for source in sources]
    else:
        targets = [output / f"{s.stem if s.suffix.lower() == '.exr' else s.name}.exr" for s in sources]
    read = {os.path.realpath(source) for source in sources}
    for target, source in zip(targets, sources, strict=True):
        if os.path.realpath(target) in read:
            raise FileError(f"{target}: expected an output folder other than the input's, got {source.parent}")
    return targets

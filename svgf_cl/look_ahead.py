"""Makes pictures from earlier and later frames, for offline work: the mean of a forward and a backward run.

Equations: docs/algorithm.md, section 9.
"""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from svgf_cl.denoiser import Denoiser
from svgf_cl.errors import ArgumentError, FileError, shown
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import Frame
from svgf_cl.next_motion import check_on_host, motion_to_next

Item = TypeVar("Item")
Plane = NDArray[np.float32]
Key = tuple[str, ...]  # names a part of a frame, for example by the channels of a light
PICTURE = ("picture",)  # the key of a frame that is filtered as a whole
NextMotion = Callable[[int], Plane]


def look_ahead(
    frames: Sequence[Frame],
    forward: Denoiser,
    backward: Denoiser,
    *,
    ahead: int | None = None,
    cuts: Iterable[int] = (),
    next_motion: NextMotion | None = None,
) -> Iterator[Plane]:
    """Denoise a sequence; each picture uses earlier and later frames.

    One denoiser runs over each shot from its first frame to the last, the other from the last to the first. The two
    pictures of a frame are averaged by their certainty. With `ahead`, a shot is divided into blocks of this many
    frames. For each block the backward run starts again, `ahead` frames after the block's end. Then every frame is
    filtered backward about twice, and pictures are ready before the whole shot has been read.

    Two frames are in memory at a time. The backward run's results for a block are written to files in a temporary
    folder (the environment variable TMPDIR chooses it): 16 bytes a pixel, for `ahead` frames or for all frames of a
    shot.

    Parameters
    ----------
    frames : sequence of Frame
        Frames of one size with numpy arrays. Each is requested when it is needed, twice, or with `ahead` up to three
        times; so the sequence may read them from files.
    forward, backward : Denoiser
        Two denoisers with the same settings. Their history is discarded.
    ahead : int, optional
        Least number of frames to look ahead, unless the shot ends before, >= 1; by default to the end of the shot.
    cuts : iterable of int
        Indices of the frames right after a cut. Neither run crosses a cut.
    next_motion : callable, optional
        Returns the motion to the next frame for a frame's index, as `motion_to_next` does, if the renderer or the
        cameras give it. The default is `motion_to_next`.

    Yields
    ------
    (H, W, 3) float32
        The picture of each frame in order, linear HDR radiance. At this time the last frame of `forward` is the same
        frame, so that its stages and times can be read.

    Raises
    ------
    ArgumentError
        If `forward` and `backward` are the same denoiser, differ in shape or settings, or do not accumulate light over
        time, or if `ahead` or `cuts` is out of range.
    FrameError, DeviceError
        As in `Denoiser.denoise`, and if a field is not a numpy array.
    FileError
        If the files cannot be written.

    Examples
    --------
    >>> for picture in look_ahead(frames, Denoiser((height, width)), Denoiser((height, width)), ahead=8): ...
    """
    settings = check_denoisers(forward, backward)
    if ahead is not None and (type(ahead) is not int or ahead < 1):
        raise ArgumentError("look_ahead(ahead)", "a whole number of at least 1, or None", shown(ahead))
    starts = sorted(set(cuts))
    if starts and not 0 < starts[0] <= starts[-1] < len(frames):
        raise ArgumentError("look_ahead(cuts)", f"indices in 1..{len(frames) - 1}", shown(starts))
    walk = FramesWalk(frames, forward, backward, settings, next_motion)
    return pictures_of(both_ways(walk, starts, ahead))


def pictures_of(found: Iterator[tuple[Frame, dict[Key, Plane]]]) -> Iterator[Plane]:
    """Yield the pictures of results, without keeping any frame in memory."""
    for each in found:
        picture = each[1][PICTURE]
        del each
        yield picture


def check_denoisers(forward: Denoiser, backward: Denoiser) -> TemporalFilter:
    """Return the settings of two denoisers; raise `ArgumentError` unless their pictures can be averaged."""
    if forward is backward:
        raise ArgumentError("look_ahead(backward)", "another denoiser than forward", "the same")
    if (forward.shape, forward.settings) != (backward.shape, backward.settings):
        raise ArgumentError("look_ahead(backward)", f"one like {forward!r} with the same settings", repr(backward))
    if not isinstance(forward.settings, TemporalFilter):
        raise ArgumentError("look_ahead(forward)", "a filter that accumulates light over time", repr(forward))
    return forward.settings


class Walk(Protocol[Item]):
    """A shot, and two filters that run over it, one forward and one backward in time."""

    def __len__(self) -> int: ...

    def item(self, index: int) -> Item:
        """Return a frame."""

    def to_next(self, index: int, item: Item, later: Item) -> Plane:
        """Return the motion from a frame to the next one, as `motion_to_next` does."""

    def begin(self, *, backward: bool) -> None:
        """Discard the history of the filter for this direction."""

    def estimates(self, item: Item, motion: Plane | None, *, backward: bool) -> Mapping[Key, Estimate]:
        """Filter the next frame in this direction, and return the result for each part.

        If `motion` is given, it replaces the frame's own motion.
        """


def both_ways(walk: Walk[Item], cuts: Sequence[int], ahead: int | None) -> Iterator[tuple[Item, dict[Key, Plane]]]:
    """Run over a shot in both directions, and average the results of the two filters for each part of each frame.

    Parameters
    ----------
    walk : Walk
    cuts : sequence of int
        As in `look_ahead`, in order.
    ahead : int, optional
        As in `look_ahead`.

    Yields
    ------
    (Item, dict of Key to (H, W, 3) float32)
        Each frame in order, with the means of its parts. A part that only the forward filter has is not averaged; one
        that only the backward filter has is left out. At this time the last frame of the forward filter is the same
        frame.
    """
    for start, stop, end in blocks(len(walk), cuts, ahead):
        if start in (0, *cuts):
            walk.begin(backward=False)
        yield from block(walk, start, stop, end)


def blocks(count: int, cuts: Sequence[int], ahead: int | None) -> Iterator[tuple[int, int, int]]:
    """Yield the blocks of `count` frames: the first frame, the end of the block, and the end of the backward run."""
    length = ahead or max(1, count)
    for first, end in zip([0, *cuts], [*cuts, count], strict=True):
        for start in range(first, end, length):
            stop = min(start + length, end)
            yield start, stop, min(stop + length, end)


def block(walk: Walk[Item], start: int, stop: int, end: int) -> Iterator[tuple[Item, dict[Key, Plane]]]:
    """Yield the frames from `start` to before `stop`; the backward run begins at the frame before `end`."""
    with tempfile.TemporaryDirectory(prefix="svgf_cl-") as folder:
        for index, estimates in backward_run(walk, start, end):
            if index < stop:
                save(file_of(folder, index), estimates)
        for index in range(start, stop):
            item, after = walk.item(index), load(file_of(folder, index))
            before = walk.estimates(item, None, backward=False)
            yield item, {key: mean(one, after[key]) if key in after else one.picture for key, one in before.items()}


def backward_run(walk: Walk[Item], start: int, end: int) -> Iterator[tuple[int, Mapping[Key, Estimate]]]:
    """Yield each frame from the one before `end` back to `start`, with the results of the backward filter."""
    walk.begin(backward=True)
    later: Item | None = None  # the motion of the first one does not matter, because it has no history
    for index in reversed(range(start, end)):
        item = walk.item(index)
        motion = None if later is None else walk.to_next(index, item, later)
        yield index, walk.estimates(item, motion, backward=True)
        later = item


@dataclass(frozen=True, eq=False)
class FramesWalk:
    """A walk over frames; the parameters are those of `look_ahead`, and the denoisers' settings."""

    frames: Sequence[Frame]
    forward: Denoiser
    backward: Denoiser
    settings: TemporalFilter
    next_motion: NextMotion | None

    def __len__(self) -> int:
        return len(self.frames)

    def item(self, index: int) -> Frame:
        """Return a frame, which must be on the host."""
        frame = self.frames[index]
        check_on_host(frame)
        return frame

    def to_next(self, index: int, item: Frame, later: Frame) -> Plane:
        """Return the motion from a frame to the next one."""
        return motion_to_next(item, later) if self.next_motion is None else self.next_motion(index)

    def begin(self, *, backward: bool) -> None:
        """Discard the history."""
        (self.backward if backward else self.forward).reset()

    def estimates(self, item: Frame, motion: Plane | None, *, backward: bool) -> dict[Key, Estimate]:
        """Filter the next frame of a run."""
        denoiser = self.backward if backward else self.forward
        picture = denoiser.denoise(item if motion is None else replace(item, motion=motion))
        return {PICTURE: Estimate(picture, self.settings.uncertainty(denoiser.stage))}


@dataclass(frozen=True, eq=False)
class Estimate:
    """The result of one run for a frame.

    Parameters
    ----------
    picture : (H, W, 3)
    uncertainty : (H, W)
        The result of `TemporalFilter.uncertainty`.
    """

    picture: Plane
    uncertainty: Plane


def save(path: Path, estimates: Mapping[Key, Estimate]) -> None:
    """Write estimates; raise `FileError` if that fails."""
    try:
        with path.open("wb") as file:
            for key, estimate in estimates.items():
                pickle.dump(key, file)
                np.save(file, np.dstack((estimate.picture, estimate.uncertainty)))
    except OSError as error:
        raise FileError(
            f"{path}: cannot be written ({error.strerror or error}); set TMPDIR to a folder with more room, or "
            "look fewer frames ahead"
        ) from error


def load(path: Path) -> dict[Key, Estimate]:
    """Read the estimates that `save` wrote."""
    estimates = {}
    with path.open("rb") as file:
        while file.peek(1):
            key, planes = pickle.load(file), np.load(file)
            estimates[key] = Estimate(planes[..., :3], planes[..., 3])
    return estimates


def file_of(folder: str, index: int) -> Path:
    """Return the path of the backward estimates of a frame."""
    return Path(folder) / f"{index}.parts"


def mean(one: Estimate, other: Estimate) -> Plane:
    """Return the mean of two pictures, weighted by 1 / uncertainty, (H, W, 3); for equal values, exactly this value."""
    total = one.uncertainty + other.uncertainty  # 0 where nothing was hit
    least = np.minimum(one.uncertainty, other.uncertainty)
    share = np.divide(least, total, out=np.full_like(total, 0.5), where=total > 0)[..., None]  # of the less certain one
    swapped = (other.uncertainty < one.uncertainty)[..., None]
    first = np.where(swapped, other.picture, one.picture)
    picture: Plane = first + share * (np.where(swapped, one.picture, other.picture) - first)
    return picture

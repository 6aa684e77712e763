"""Pictures from earlier and later frames, for offline work: the mean of a forward and a backward run of a filter.

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
Key = tuple[str, ...]  # of a part of a frame: the channels of a light, say
PICTURE = ("picture",)  # the only part of a frame that is filtered as a whole
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

    One denoiser goes over each shot from its first frame on, the other from its last frame back, and the two pictures
    of a frame are averaged by how certain each is. With `ahead`, a shot is cut into blocks of so many frames, and the
    backward run begins anew for each, `ahead` frames after its end: then every frame runs backward about twice, and
    pictures come out before the whole shot has been read.

    It holds two frames at a time. What the backward run makes of a block is kept in files of a temporary folder (the
    environment variable TMPDIR says where): 16 bytes a pixel, of `ahead` frames, or of all frames of a shot.

    Parameters
    ----------
    frames : sequence of Frame
        Of numpy arrays and of one size. Each is asked for when it is needed, two times, with `ahead` up to three; so
        the sequence may read them from files.
    forward, backward : Denoiser
        Two with the same settings. They forget their past.
    ahead : int, optional
        To look at least so many frames ahead where the shot goes on so long, >= 1; by default to the end of the shot.
    cuts : iterable of int
        Indices of the frames that follow on a cut. Neither run goes across a cut.
    next_motion : callable, optional
        Gives the motion to the next frame by a frame's index, as `motion_to_next` returns it, where the renderer or
        the cameras tell it. By default it is that of `motion_to_next`.

    Yields
    ------
    (H, W, 3) float32
        The picture of each frame in order, linear HDR radiance. Meanwhile the last frame of `forward` is that same
        frame: its stages and times can be read.

    Raises
    ------
    ArgumentError
        If there is one denoiser in place of two, if they differ in shape or settings or do not accumulate light over
        time, or if `ahead` or `cuts` are out of their range.
    FrameError, DeviceError
        As `Denoiser.denoise`; and if a field is not a numpy array.
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
    """The pictures among what was found of frames; it holds no frame itself."""
    for each in found:
        picture = each[1][PICTURE]
        del each
        yield picture


def check_denoisers(forward: Denoiser, backward: Denoiser) -> TemporalFilter:
    """The settings of two denoisers; `ArgumentError` unless they can make pictures to be averaged."""
    if forward is backward:
        raise ArgumentError("look_ahead(backward)", "another denoiser than forward", "the same")
    if (forward.shape, forward.settings) != (backward.shape, backward.settings):
        raise ArgumentError("look_ahead(backward)", f"one like {forward!r} with the same settings", repr(backward))
    if not isinstance(forward.settings, TemporalFilter):
        raise ArgumentError("look_ahead(forward)", "a filter that accumulates light over time", repr(forward))
    return forward.settings


class Walk(Protocol[Item]):
    """A shot, and two filters that go along it, one forward and one backward in time."""

    def __len__(self) -> int: ...

    def item(self, index: int) -> Item:
        """All that there is of a frame."""

    def to_next(self, index: int, item: Item, later: Item) -> Plane:
        """The motion from a frame to the next one, as `motion_to_next` returns it."""

    def begin(self, *, backward: bool) -> None:
        """Have the filter of that direction forget its past."""

    def estimates(self, item: Item, motion: Plane | None, *, backward: bool) -> Mapping[Key, Estimate]:
        """What the filter of that direction makes of each part of its next frame, with its own motion or another."""


def both_ways(walk: Walk[Item], cuts: Sequence[int], ahead: int | None) -> Iterator[tuple[Item, dict[Key, Plane]]]:
    """Run over a shot in both directions, and average the results of the two filters for each part of each frame.

    Parameters
    ----------
    walk : Walk
    cuts : sequence of int
        In order; as of `look_ahead`.
    ahead : int, optional
        As of `look_ahead`.

    Yields
    ------
    (Item, dict of Key to (H, W, 3) float32)
        Each frame in order, with the means of its parts. A part that one of the filters does not have is the forward
        one's, or is left out. Meanwhile the last frame of the forward filter is that same frame.
    """
    for start, stop, end in blocks(len(walk), cuts, ahead):
        if start in (0, *cuts):
            walk.begin(backward=False)
        yield from block(walk, start, stop, end)


def blocks(count: int, cuts: Sequence[int], ahead: int | None) -> Iterator[tuple[int, int, int]]:
    """The blocks of so many frames: the first frame, and those behind the last and behind the backward run's first."""
    length = ahead or max(1, count)
    for first, end in zip([0, *cuts], [*cuts, count], strict=True):
        for start in range(first, end, length):
            stop = min(start + length, end)
            yield start, stop, min(stop + length, end)


def block(walk: Walk[Item], start: int, stop: int, end: int) -> Iterator[tuple[Item, dict[Key, Plane]]]:
    """The frames from `start` to before `stop`; the backward run begins at the frame before `end`."""
    with tempfile.TemporaryDirectory(prefix="svgf_cl-") as folder:
        for index, estimates in backward_run(walk, start, end):
            if index < stop:
                save(file_of(folder, index), estimates)
        for index in range(start, stop):
            item, after = walk.item(index), load(file_of(folder, index))
            before = walk.estimates(item, None, backward=False)
            yield item, {key: mean(one, after[key]) if key in after else one.picture for key, one in before.items()}


def backward_run(walk: Walk[Item], start: int, end: int) -> Iterator[tuple[int, Mapping[Key, Estimate]]]:
    """Each frame from that before `end` down to `start`, and what the backward filter makes of it."""
    walk.begin(backward=True)
    later: Item | None = None  # what the first one's motion leads to plays no part, for it has no history
    for index in reversed(range(start, end)):
        item = walk.item(index)
        motion = None if later is None else walk.to_next(index, item, later)
        yield index, walk.estimates(item, motion, backward=True)
        later = item


@dataclass(frozen=True, eq=False)
class FramesWalk:
    """A walk along frames; parameters as of `look_ahead`, and `settings` those of the denoisers."""

    frames: Sequence[Frame]
    forward: Denoiser
    backward: Denoiser
    settings: TemporalFilter
    next_motion: NextMotion | None

    def __len__(self) -> int:
        return len(self.frames)

    def item(self, index: int) -> Frame:
        """A frame, on the host."""
        frame = self.frames[index]
        check_on_host(frame)
        return frame

    def to_next(self, index: int, item: Frame, later: Frame) -> Plane:
        """From a frame to the next one."""
        return motion_to_next(item, later) if self.next_motion is None else self.next_motion(index)

    def begin(self, *, backward: bool) -> None:
        """Discard the history."""
        (self.backward if backward else self.forward).reset()

    def estimates(self, item: Frame, motion: Plane | None, *, backward: bool) -> dict[Key, Estimate]:
        """What a run makes of its next frame."""
        denoiser = self.backward if backward else self.forward
        picture = denoiser.denoise(item if motion is None else replace(item, motion=motion))
        return {PICTURE: Estimate(picture, self.settings.uncertainty(denoiser.stage))}


@dataclass(frozen=True, eq=False)
class Estimate:
    """What one run makes of a frame.

    Parameters
    ----------
    picture : (H, W, 3)
    uncertainty : (H, W)
        As of `TemporalFilter.uncertainty`.
    """

    picture: Plane
    uncertainty: Plane


def save(path: Path, estimates: Mapping[Key, Estimate]) -> None:
    """Write estimates; `FileError` where that fails."""
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
    """Read what `save` wrote."""
    estimates = {}
    with path.open("rb") as file:
        while file.peek(1):
            key, planes = pickle.load(file), np.load(file)
            estimates[key] = Estimate(planes[..., :3], planes[..., 3])
    return estimates


def file_of(folder: str, index: int) -> Path:
    """Where the backward estimate of a frame is kept."""
    return Path(folder) / f"{index}.parts"


def mean(one: Estimate, other: Estimate) -> Plane:
    """Mean of two pictures, weighted by 1 / uncertainty, (H, W, 3); of two equal values, exactly this value."""
    total = one.uncertainty + other.uncertainty  # 0 where nothing was hit
    least = np.minimum(one.uncertainty, other.uncertainty)
    share = np.divide(least, total, out=np.full_like(total, 0.5), where=total > 0)[..., None]  # of the less certain
    swapped = (other.uncertainty < one.uncertainty)[..., None]
    first = np.where(swapped, other.picture, one.picture)
    picture: Plane = first + share * (np.where(swapped, one.picture, other.picture) - first)
    return picture

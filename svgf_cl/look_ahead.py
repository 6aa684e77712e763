"""Pictures from earlier and from later frames, for work offline: a forward and a backward run of one filter, averaged.

Equations: docs/algorithm.md, section 9.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from svgf_cl.denoiser import Denoiser
from svgf_cl.errors import ArgumentError, FileError, shown
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import Frame
from svgf_cl.next_motion import check_on_host, motion_to_next

Plane = NDArray[np.float32]
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
    """Denoise a sequence, each frame with the help of those before it and of those after it.

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
    return Runs(frames, forward, backward, settings, next_motion).pictures(starts, ahead or max(1, len(frames)))


def check_denoisers(forward: Denoiser, backward: Denoiser) -> TemporalFilter:
    """The settings of two denoisers; `ArgumentError` unless they can make pictures to be averaged."""
    if forward is backward:
        raise ArgumentError("look_ahead(backward)", "another denoiser than forward", "the same")
    if (forward.shape, forward.settings) != (backward.shape, backward.settings):
        raise ArgumentError("look_ahead(backward)", f"one like {forward!r} with the same settings", repr(backward))
    if not isinstance(forward.settings, TemporalFilter):
        raise ArgumentError("look_ahead(forward)", "a filter that accumulates light over time", repr(forward))
    return forward.settings


@dataclass(frozen=True, eq=False)
class Runs:
    """Both runs over a sequence; parameters as of `look_ahead`, and `settings` those of the denoisers."""

    frames: Sequence[Frame]
    forward: Denoiser
    backward: Denoiser
    settings: TemporalFilter
    next_motion: NextMotion | None

    def pictures(self, cuts: Sequence[int], ahead: int) -> Iterator[Plane]:
        """All pictures, in blocks of `ahead` frames."""
        for first, end in zip([0, *cuts], [*cuts, len(self.frames)], strict=True):
            self.forward.reset()
            for start in range(first, end, ahead):
                stop = min(start + ahead, end)
                yield from self.block(start, stop, min(stop + ahead, end))

    def block(self, start: int, stop: int, end: int) -> Iterator[Plane]:
        """Pictures of the frames from `start` to before `stop`; the backward run begins at the frame before `end`."""
        with tempfile.TemporaryDirectory(prefix="svgf_cl-") as folder:
            self.backward.reset()
            for index, frame in self.reversed_frames(start, end):
                estimate = self.estimate(self.backward, frame)
                if index < stop:
                    estimate.save(file_of(folder, index))
            for index in range(start, stop):
                later = Estimate.load(file_of(folder, index))
                yield mean(self.estimate(self.forward, self.frames[index]), later)

    def reversed_frames(self, start: int, end: int) -> Iterator[tuple[int, Frame]]:
        """Index and frame, from that before `end` down to `start`: a sequence that runs backward in time."""
        later: Frame | None = None  # what the first one's motion leads to plays no part, for it has no history
        for index in reversed(range(start, end)):
            frame = self.frames[index]
            check_on_host(frame)
            yield index, frame if later is None else replace(frame, motion=self.motion(index, frame, later))
            later = frame

    def motion(self, index: int, frame: Frame, later: Frame) -> Plane:
        """From a frame to the next one."""
        return motion_to_next(frame, later) if self.next_motion is None else self.next_motion(index)

    def estimate(self, denoiser: Denoiser, frame: Frame) -> Estimate:
        """What a run makes of its next frame."""
        return Estimate(denoiser.denoise(frame), self.settings.uncertainty(denoiser.stage))


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

    def save(self, path: Path) -> None:
        """Write it; `FileError` where that fails."""
        try:
            np.save(path, np.dstack((self.picture, self.uncertainty)))
        except OSError as error:
            raise FileError(
                f"{path}: cannot be written ({error.strerror or error}); set TMPDIR to a folder with more room, or "
                "look fewer frames ahead"
            ) from error

    @classmethod
    def load(cls, path: Path) -> Estimate:
        """Read what `save` wrote."""
        planes = np.load(path)
        return cls(planes[..., :3], planes[..., 3])


def file_of(folder: str, index: int) -> Path:
    """Where the backward estimate of a frame is kept."""
    return Path(folder) / f"{index}.npy"


def mean(one: Estimate, other: Estimate) -> Plane:
    """Mean of two pictures, each weighted by one over its uncertainty, (H, W, 3); where both are equal, just that."""
    total = one.uncertainty + other.uncertainty  # 0 where nothing was hit
    least = np.minimum(one.uncertainty, other.uncertainty)
    share = np.divide(least, total, out=np.full_like(total, 0.5), where=total > 0)[..., None]  # of the less certain
    swapped = (other.uncertainty < one.uncertainty)[..., None]
    first = np.where(swapped, other.picture, one.picture)
    picture: Plane = first + share * (np.where(swapped, one.picture, other.picture) - first)
    return picture

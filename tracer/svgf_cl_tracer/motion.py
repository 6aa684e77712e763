"""Motion and change: values at keyframes, and the transforms of rigid objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import SceneError
from .vectors import Float64

# The least scale: an object without size keeps its directions, so that a lamp still shines along its axis.
SPECK = 1e-30


@dataclass(frozen=True, eq=False)
class Track:
    """A quantity over time, given at keyframes; before the first and after the last keyframe it is constant.

    Parameters
    ----------
    times : (n,) float
        Seconds, ascending.
    values : (n, C) float
        The values at these times.
    step : bool
        Keep each value until the next keyframe, instead of interpolating linearly.
    repeats : bool
        Repeat from the start after the last keyframe.

    Raises
    ------
    SceneError
        If there is no keyframe, if a number is not finite, or if times do not ascend or do not match the values.
    """

    times: ArrayLike
    values: ArrayLike
    step: bool = False
    repeats: bool = False

    def __post_init__(self) -> None:
        times, values = np.array(self.times, np.float64), np.array(self.values, np.float64)
        if times.ndim != 1 or values.ndim != 2 or len(times) != len(values) or not len(times):
            raise SceneError(f"keyframes: expected n times and n rows of values, got {times.shape} and {values.shape}")
        if not (np.isfinite(times).all() and np.isfinite(values).all() and (np.diff(times) > 0).all()):
            raise SceneError("keyframes: expected finite values at finite, ascending times")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    @property
    def changes(self) -> bool:
        """Whether the value ever changes; exporters also write keyframes for things that do not move."""
        values = np.asarray(self.values)
        return bool((values != values[0]).any())

    def at(self, time: float) -> Float64:
        """The values (C,) at `time` in seconds."""
        first, second, weight = self._between(time)
        values: Float64 = (1.0 - weight) * first + weight * second
        return values

    def rotation_at(self, time: float) -> Float64:
        """The unit quaternion (4,) at `time`, if the values are quaternions, by spherical linear interpolation."""
        first, second, weight = self._between(time)
        cosine = float(first @ second)
        if cosine < 0.0:  # the same rotation, along the shorter way
            second, cosine = -second, -cosine
        angle = np.arccos(min(cosine, 1.0))
        if angle < 1e-6:
            return _unit((1.0 - weight) * first + weight * second)
        return _unit((np.sin((1.0 - weight) * angle) * first + np.sin(weight * angle) * second) / np.sin(angle))

    def _between(self, time: float) -> tuple[Float64, Float64, float]:
        """The values at the keyframes before and after `time`, and the weight of the second one."""
        times, values = np.asarray(self.times), np.asarray(self.values)
        if self.repeats and times[-1] > times[0]:
            time = times[0] + (time - times[0]) % (times[-1] - times[0])
        after = int(np.searchsorted(times, time, side="right"))
        if after in (0, len(times)):
            only = values[min(after, len(times) - 1)]
            return only, only, 0.0
        span = times[after] - times[after - 1]
        return values[after - 1], values[after], 0.0 if self.step else float((time - times[after - 1]) / span)


@dataclass(frozen=True, eq=False)
class Keyframes:
    """A translation, rotation and scale with keyframes; a missing one has no effect.

    Parameters
    ----------
    translation : Track of (x, y, z), optional
    rotation : Track of (x, y, z, w), optional
        Unit quaternions.
    scale : Track of (x, y, z), optional
    """

    translation: Track | None = None
    rotation: Track | None = None
    scale: Track | None = None

    @property
    def changes(self) -> bool:
        """Whether anything in it changes over time."""
        return any(track.changes for track in self.tracks)

    @property
    def tracks(self) -> list[Track]:
        """The tracks that are not missing."""
        return [track for track in (self.translation, self.rotation, self.scale) if track is not None]

    def matrix(self, time: float) -> Float64:
        """The transform (4, 4) at `time` in seconds: scale first, then rotation, then translation."""
        matrix = np.eye(4)
        if self.rotation is not None:
            matrix[:3, :3] = rotation_matrix(self.rotation.rotation_at(time))
        if self.scale is not None:
            scale = self.scale.at(time)
            matrix[:3, :3] *= np.where(scale < 0.0, np.minimum(scale, -SPECK), np.maximum(scale, SPECK))
        if self.translation is not None:
            matrix[:3, 3] = self.translation.at(time)
        return matrix


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of an object: a product of transforms, with that of its outermost parent first.

    Parameters
    ----------
    links : sequence of Keyframes or (4, 4) float
    """

    links: Sequence[Keyframes | NDArray[np.floating]]

    @classmethod
    def sliding(cls, times: ArrayLike, positions: ArrayLike, *, repeats: bool = False) -> Motion:
        """Translation through `positions` (n, 3) at `times` (n,) in seconds."""
        return cls([Keyframes(translation=Track(times, positions, repeats=repeats))])

    @classmethod
    def turning(
        cls, pivot: ArrayLike, axis: ArrayLike, times: ArrayLike, degrees: ArrayLike, *, repeats: bool = False
    ) -> Motion:
        """Rotation about `axis` (3,) through `pivot` (3,) by `degrees` (n,) at `times` (n,).

        Each step is less than 180.
        """
        half = np.radians(np.asarray(degrees, np.float64))[:, None] / 2.0
        quaternions = np.hstack([_unit(np.asarray(axis, np.float64)) * np.sin(half), np.cos(half)])
        turn = Keyframes(rotation=Track(times, quaternions, repeats=repeats))
        return cls([translation(pivot), turn, translation(-np.asarray(pivot, np.float64))])

    def relative_to(self, origin: ArrayLike) -> Motion:
        """The same motion, with positions in the world relative to `origin` (3,)."""
        return Motion([translation(-np.asarray(origin, np.float64)), *self.links])

    @property
    def changes(self) -> bool:
        """Whether anything in it changes over time."""
        return any(isinstance(link, Keyframes) and link.changes for link in self.links)

    @property
    def span(self) -> tuple[float, float]:
        """The times in seconds at which it begins and ends to change; (0, 0) if it never changes."""
        tracks = [track for link in self.links if isinstance(link, Keyframes) for track in link.tracks if track.changes]
        times = [time for track in tracks for time in np.asarray(track.times)[[0, -1]]]
        return (float(min(times)), float(max(times))) if times else (0.0, 0.0)

    def matrix(self, time: float) -> Float64:
        """The transform (4, 4) into the world at `time` in seconds."""
        result = np.eye(4)
        for link in self.links:
            result = result @ (link.matrix(time) if isinstance(link, Keyframes) else np.asarray(link, np.float64))
        return result

    def turn(self, time: float) -> Float64:
        """The rotation (3, 3) of directions without any scale, such as a camera's, at `time` in seconds."""
        result = np.eye(3)
        for link in self.links:
            linear = (link.matrix(time) if isinstance(link, Keyframes) else np.asarray(link, np.float64))[:3, :3]
            lengths = np.linalg.norm(linear, axis=0)
            result = result @ (linear / np.where(lengths > 0.0, lengths, 1.0))
        return result


def translation(way: ArrayLike) -> Float64:
    """The transform (4, 4) that moves everything by `way` (3,)."""
    matrix = np.eye(4)
    matrix[:3, 3] = way
    return matrix


def rotation_matrix(quaternion: Float64) -> Float64:
    """The rotation (3, 3) of a unit quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _unit(values: Float64) -> Float64:
    length = np.linalg.norm(values)
    if not length > 0.0:
        raise SceneError("motion: expected an axis or a quaternion of a length above 0")
    unit: Float64 = values / length
    return unit

"""Noisy sequences and their references."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import svgf_cl_tracer
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.display import Linear
from svgf_cl_tracer.cli.scenes import open_scene
from svgf_cl_tracer.references import chunks


@dataclass(frozen=True)
class Footage:
    """A camera that moves through a scene at 1 sample per pixel, and the truth of a part of its last frames.

    At least two consecutive frames have a truth, for the temporal error. They are the last frames, because history is
    longest there. Only a band of rows has a truth, so that the truth of a large picture renders in minutes. Each truth
    is rendered as two independent halves, whose difference is its own noise.

    Parameters
    ----------
    name : str
        The light of the truth.
    jitter : bool
        True: rays pass through a different point of the pixel in every frame, and the truth is the mean over the
        pixel's area. False: all rays, including those of the truth, pass through the pixel's centre, so nothing is
        aliased.
    scene : str
        Name of a built-in scene, a folder with a scene.json, or a glTF, GLB or OBJ file.
    cameras : tuple of Camera
        Keyframes of the camera's path; none for the scene's own path.
    sky : (float, float, float), optional
        Light from outside, linear radiance.
    shape : (int, int)
        (height, width) in pixels.
    band : (float, float)
        The first and last of the measured rows, in picture heights. In the Cornell box these rows cross walls, a deep
        shadow, the ball, the ring, both blocks, the lattice and the tiles.
    frames : int, >= 2
    last : int, 2..frames
        The number of last frames that have a truth.
    spp : int, a multiple of 2 * CHUNK
        Samples per pixel of the truth.
    """

    name: str
    jitter: bool
    scene: str = "cornell"
    cameras: tuple[svgf_cl_tracer.Camera, ...] = ()
    sky: tuple[float, float, float] | None = None
    shape: Shape = (720, 1280)
    band: tuple[float, float] = (0.66, 0.78)
    frames: int = 24
    last: int = 2
    spp: int = 512

    @property
    def judged(self) -> range:
        """The numbers of the frames that have a truth."""
        return range(self.frames - self.last, self.frames)

    @property
    def rows(self) -> tuple[int, int]:
        """The first measured row, and the one after the last."""
        first, end = (round(share * self.shape[0]) for share in self.band)
        return first, end

    @property
    def chunks(self) -> int:
        """The number of times that `halves` calls `advance`."""
        return len(self.judged) * 2 * chunks(self.spp // 2)

    def noisy(self) -> Iterator[Frame]:
        """The frames to denoise."""
        return svgf_cl_tracer.render_sequence(self._shot, jitter=self.jitter)

    def halves(self, advance: Callable[[], None]) -> list[tuple[Linear, Linear]]:
        """Two independent halves of the truth of each measured frame; halves from an earlier run are reused."""
        return [(self._half(number, 0, advance), self._half(number, 1, advance)) for number in self.judged]

    @cached_property
    def _shot(self) -> svgf_cl_tracer.Shot:
        path = svgf_cl_tracer.CameraPath.through(self.cameras) if self.cameras else None
        return svgf_cl_tracer.Shot(open_scene(self.scene, self.sky), self.shape, self.frames, path)

    def _half(self, number: int, half: int, advance: Callable[[], None]) -> Linear:
        references = svgf_cl_tracer.References(self._shot, seed=half, jitter=self.jitter, rows=self.rows)
        return references.picture(references.render(number, self.spp // 2, advance))


FOOTAGE = (Footage("area", jitter=True), Footage("centre", jitter=False))

"""`ShotWalk`: filters a shot's files forward and backward, so that pictures can use later frames."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from svgf_cl.io.shot import Shot, ShotFrame
from svgf_cl.lights import Channels, Denoised, Parts, Picture
from svgf_cl.look_ahead import Estimate
from svgf_cl.next_motion import motion_to_next
from svgf_cl.shot_denoiser import Method, ShotDenoiser

Look = Callable[[Shot, int, ShotFrame], None]
Item = tuple[int, ShotFrame]


class ShotWalk:
    """A `svgf_cl.look_ahead.Walk` over a shot, with each light pass as a part.

    Parameters
    ----------
    shot : Shot
    method : Method
    places : range
        The indices of the frames.
    look : callable, optional
        Called for every frame before the forward filter, with the shot, the frame's index and the frame.
    advance : callable
        Called after every frame, in both directions.
    """

    def __init__(
        self,
        shot: Shot,
        method: Method,
        places: range,
        look: Look | None = None,
        advance: Callable[[], None] = lambda: None,
    ) -> None:
        self._shot, self._places, self._look, self._advance = shot, places, look, advance
        first, second = shot.beginning()  # the same for all chunks, so that all are treated alike
        lights = len(second.lights)
        self.forward, self._backward = (ShotDenoiser(shot.shape, method, lights, share=0.5) for _ in range(2))
        for denoiser in (self.forward, self._backward):
            denoiser.settle(second.frame, second.lights, first.frame)
        self._parts: Parts | None = None

    @property
    def cuts(self) -> list[int]:
        """The cuts of the shot inside the walk."""
        return [cut - self._places.start for cut in sorted(self._shot.cuts) if cut in self._places[1:]]

    def __len__(self) -> int:
        return len(self._places)

    def item(self, index: int) -> Item:
        """Return the index of a frame in the shot, and the frame."""
        return self._places[index], self._shot.read(self._places[index])

    def to_next(self, index: int, item: Item, later: Item) -> Picture:
        """Return the motion to the next frame, from the file or the cameras if they give it."""
        given = self._shot.motion_to_next(item[1])
        return motion_to_next(item[1].frame, later[1].frame) if given is None else given

    def begin(self, *, backward: bool) -> None:
        """Discard the history."""
        (self._backward if backward else self.forward).reset()

    def estimates(self, item: Item, motion: Picture | None, *, backward: bool) -> Mapping[Channels, Estimate]:
        """Filter the parts of the next frame of a direction."""
        index, source = item
        denoiser = self._backward if backward else self.forward
        if self._look and not backward:
            self._look(self._shot, index, source)
        frame = source.frame if motion is None else replace(source.frame, motion=motion)
        parts = denoiser.parts(frame, source.lights)
        if not backward:
            self._parts = parts
        made = denoiser.filtered(parts)
        self._advance()
        return {key: Estimate(picture, denoiser.uncertainty(key)) for key, picture in made.items()}

    def composed(self, means: Mapping[Channels, Picture]) -> Denoised:
        """Return the picture of the forward filter's last frame, from the means of its parts."""
        assert self._parts is not None
        return self._parts.composed(means)

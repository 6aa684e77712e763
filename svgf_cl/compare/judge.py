"""How good pictures of a sequence are: every measure of `svgf_cl.compare`, frame by frame, then of all frames.

Each measure that has a way not to count the truth's own noise goes it. SSIM, FLIP and relMSE have none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from svgf_cl.compare.halves import Mask, Pair, brightness, squared_change, squared_error
from svgf_cl.compare.kept import RADIUS, Plane, contrast, sharpness
from svgf_cl.compare.lag import lag, response, steps
from svgf_cl.compare.metrics import decibels, flip, relmse, ssim
from svgf_cl.compare.share import Share
from svgf_cl.compare.surfaces import one_surface, reflecting, relit, still, without_albedo
from svgf_cl.frame import LUMINANCE, Frame
from svgf_cl.io.display import Linear, display


@dataclass(frozen=True, eq=False)
class View:
    """A frame, and the truth about it: what its pictures are judged by.

    Parameters
    ----------
    frame : Frame
    halves : two of (H, W, 3)
        Independent halves of the truth, linear.
    jitter : bool
        Whether pixels of the truth are means over their areas, which the albedo of one ray is not.
    earlier : Frame and two of (H, W, 3), optional
        The frame before, and halves of the truth about it, if they are known.
    """

    frame: Frame
    halves: Pair
    jitter: bool
    earlier: tuple[Frame, Pair] | None = None

    @cached_property
    def truth(self) -> Linear:
        """The best there is, linear."""
        return 0.5 * (self.halves[0] + self.halves[1])

    @cached_property
    def shown(self) -> Linear:
        """The truth, display-referred."""
        return display(self.truth)

    @cached_property
    def shown_halves(self) -> Pair:
        """The halves, display-referred."""
        return display(self.halves[0]), display(self.halves[1])

    @cached_property
    def light(self) -> tuple[Plane, Plane]:
        """Luminance of the halves without albedo."""
        return self.light_in(self.halves[0]), self.light_in(self.halves[1])

    @cached_property
    def relit(self) -> Mask:
        """Around which of the lit pixels nothing moved since the frame before but light."""
        if self.earlier is None:
            return np.zeros(self.frame.shape, np.bool_)
        frame, halves = self.earlier
        past = self.light_in(halves[0]), self.light_in(halves[1])
        return self.lit & relit(past, self.light, still(frame, self.frame))

    @cached_property
    def plain(self) -> Mask:
        """Around which pixels there is one surface of one colour."""
        return one_surface(self.frame)

    @cached_property
    def lit(self) -> Mask:
        """Around which pixels a window shows one surface, and no lamp: contrast there is that of light.

        Where pixels of the truth are means, it shows one colour, too, as do the pixels around it: one ray does not tell
        what else there is in its pixel.
        """
        window = RADIUS + 1 if self.jitter else RADIUS
        return self.reflecting & one_surface(self.frame, window, one_colour=self.jitter)

    @cached_property
    def reflecting(self) -> Mask:
        """Where no lamp is seen."""
        return reflecting(self.frame)

    def light_in(self, picture: Linear) -> Plane:
        """Luminance of a picture of this frame without albedo."""
        return without_albedo(picture, self.frame)


@dataclass(frozen=True)
class Score:
    """One picture of one frame.

    Parameters
    ----------
    ssim, flip, relmse : float
    error, brightness, edges, shadows, moving_shadows : Share
    """

    ssim: float
    flip: float
    relmse: float
    error: Share
    brightness: Share
    edges: Share
    shadows: Share
    moving_shadows: Share

    @classmethod
    def of(cls, picture: Linear, view: View) -> Score:
        """Measure one linear picture."""
        shown, light = display(picture), view.light_in(picture)
        return cls(
            ssim=ssim(shown, view.shown),
            flip=flip(shown, view.shown),
            relmse=relmse(picture, view.truth),
            error=squared_error(shown, view.shown_halves),
            brightness=brightness(picture, view.halves, view.reflecting),
            edges=sharpness(shown, view.shown_halves, np.ones(view.frame.shape, np.bool_)),
            shadows=contrast(light, view.light, view.lit),
            moving_shadows=contrast(light, view.light, view.relit),
        )


@dataclass(frozen=True)
class Change:
    """How much the error changes from one picture to the next: everywhere, and on surfaces of one colour."""

    everywhere: Share
    on_surfaces: Share

    @classmethod
    def of(cls, earlier: Linear, later: Linear, before: View, now: View) -> Change:
        """Measure two consecutive linear pictures."""
        seen = display(earlier), display(later), before.shown_halves, now.shown_halves
        return cls(squared_change(*seen), squared_change(*seen, before.plain & now.plain))


@dataclass(frozen=True)
class Findings:
    """How good a filter's pictures of a sequence are.

    Parameters
    ----------
    psnr : float, dB
        Mean over frames, without the truth's noise.
    ssim, flip, relmse : float
        Means over frames.
    temporal, temporal_on_surfaces : float
        Temporal error, root mean square, without the truth's noise.
    bias : float
        Light too much, as a share of that of the truth; negative where light is lost.
    edges, shadows, moving_shadows : float
        Shares kept: of the sharpness of edges, of the contrast of light on a surface, of the same where the light has
        just changed. NaN without any.
    lags : tuple of int or None
        Frames until each switching of a lamp is followed; None where it is not, before the next or the end.
    """

    psnr: float
    ssim: float
    flip: float
    relmse: float
    temporal: float
    temporal_on_surfaces: float
    bias: float
    edges: float
    shadows: float
    moving_shadows: float
    lags: tuple[int | None, ...]


class Judge:
    """Judges the pictures that one filter makes of the frames of a sequence, one after another.

    Parameters
    ----------
    switches : sequence of int
        Among the judged frames, from 0, those before which a lamp was switched: `switches_in` of the truths.
    """

    def __init__(self, switches: Sequence[int] = ()) -> None:
        self._switches = switches
        self._scores: list[Score] = []
        self._changes: list[Change] = []
        self._responses: list[list[float]] = []
        self._last: tuple[Linear, View] | None = None
        self._unswitched: View | None = None

    def see(self, picture: Linear, view: View) -> None:
        """Judge the next linear picture, (H, W, 3)."""
        if self._last:
            (earlier, before) = self._last
            self._changes.append(Change.of(earlier, picture, before, view))
            if len(self._scores) in self._switches:
                self._unswitched = before
                self._responses.append([])
        if self._unswitched:
            where = self._unswitched.reflecting & view.reflecting
            followed = response(picture, self._unswitched.halves, view.halves, where)
            self._responses[-1].append(followed.value)
        self._scores.append(Score.of(picture, view))
        self._last = picture, view

    @property
    def findings(self) -> Findings:
        """What was found so far; at least two pictures were seen."""
        scores, changes = self._scores, self._changes
        return Findings(
            psnr=float(np.mean([decibels(score.error.value) for score in scores])),
            ssim=float(np.mean([score.ssim for score in scores])),
            flip=float(np.mean([score.flip for score in scores])),
            relmse=float(np.mean([score.relmse for score in scores])),
            temporal=root(pooled([change.everywhere for change in changes])),
            temporal_on_surfaces=root(pooled([change.on_surfaces for change in changes])),
            bias=pooled([score.brightness for score in scores]) - 1,
            edges=pooled([score.edges for score in scores]),
            shadows=pooled([score.shadows for score in scores]),
            moving_shadows=pooled([score.moving_shadows for score in scores]),
            lags=tuple(lag(responses) for responses in self._responses),
        )


def switches_in(truths: Sequence[Pair]) -> list[int]:
    """Which frames, from 0, are those before which a lamp was switched, by the halves of each frame's truth."""
    return steps([float(np.mean(0.5 * (first + second) @ np.array(LUMINANCE))) for first, second in truths])


def pooled(shares: Sequence[Share]) -> float:
    """Value of all shares together."""
    return sum(shares, Share()).value


def root(square: float) -> float:
    """The square root; 0 below 0, where the estimate of a square of next to nothing may lie."""
    return float(np.sqrt(np.maximum(square, 0.0)))

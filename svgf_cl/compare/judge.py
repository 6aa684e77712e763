"""Judges the pictures of a sequence by every measure of `svgf_cl.compare`, for each frame and for all frames.

The truth's own noise does not count, except in SSIM, FLIP, relMSE and the unsettled share, which have no way to exclude
it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from svgf_cl.compare.ghost import Uncovered
from svgf_cl.compare.halves import Pair
from svgf_cl.compare.lag import lag, response, steps
from svgf_cl.compare.metrics import decibels
from svgf_cl.compare.score import Change, Score, Sight
from svgf_cl.compare.share import Share
from svgf_cl.compare.stability import Flicker, excess, root
from svgf_cl.compare.view import View
from svgf_cl.frame import LUMINANCE
from svgf_cl.io.display import Linear


@dataclass(frozen=True)
class Findings:
    """The results for a filter's pictures of a sequence. A value is NaN if the frames show nothing that it measures.

    Parameters
    ----------
    psnr : float, dB
        Mean over frames, without the truth's noise.
    ssim, flip, relmse, relmse_trimmed : float
        Means over frames.
    bias : float
        Excess of light, as a share of the truth's light; negative if light is lost.
    temporal, temporal_on_surfaces : float
        Temporal error, root mean square, without the truth's noise.
    flicker, warped : float
        How much more the pictures change than the truth, where surfaces rest and where they move; negative if less.
    edges, shadows, moving_shadows, detail : float
        The share that is kept of the sharpness of edges, of the contrast of light on a surface, of that contrast where
        the light has just changed, and of the finest contrast of moving textures.
    ghost : float
        The share of the old picture that remains where a surface has come into view.
    unsettled : float
        The share of thin geometry that is clearly wrong.
    lags : tuple of int or None
        Frames until the picture has followed each switching of a lamp; None if it has not by the next switching or the
        end.
    """

    psnr: float
    ssim: float
    flip: float
    relmse: float
    relmse_trimmed: float
    bias: float
    temporal: float
    temporal_on_surfaces: float
    flicker: float
    warped: float
    edges: float
    shadows: float
    moving_shadows: float
    detail: float
    ghost: float
    unsettled: float
    lags: tuple[int | None, ...]


class Judge:
    """Judges the pictures that one filter makes of a sequence, one after another.

    Parameters
    ----------
    switches : sequence of int
        Indices, from 0, of the judged frames right before which a lamp was switched; see `switches_in`.
    """

    def __init__(self, switches: Sequence[int] = ()) -> None:
        self._switches = switches
        self._scores: list[Score] = []
        self._changes: dict[int, Change] = {}  # by number of the later picture, from 0
        self._responses: list[list[float]] = []
        self._flicker = Flicker()
        self._ghost = Share()
        self._uncovered: Uncovered | None = None
        self._last: Sight | None = None
        self._unswitched: View | None = None

    def see(self, picture: Linear, view: View) -> None:
        """Judge the next linear picture, (H, W, 3)."""
        sight = Sight(picture, view)
        if self._last and view.earlier:
            self._changes[len(self._scores)] = Change.of(self._last, sight)
            self._follow_lamps(sight, self._last.view)
            self._follow_ghosts(sight, self._last.view)
        else:  # after a gap in the frames nothing can be followed
            self._unswitched = self._uncovered = None
        resting = view.resting if self._last else np.ones(view.frame.shape, np.bool_)
        self._flicker.see(sight.shown, view.shown_halves, resting)
        self._scores.append(Score.of(sight))
        self._last = sight

    def _follow_lamps(self, sight: Sight, before: View) -> None:
        if len(self._scores) in self._switches:
            self._unswitched = before
            self._responses.append([])
        if self._unswitched:
            where = self._unswitched.reflecting & sight.view.reflecting
            followed = response(sight.picture, self._unswitched.halves, sight.view.halves, where)
            self._responses[-1].append(followed.value)

    def _follow_ghosts(self, sight: Sight, before: View) -> None:
        if sight.view.past:
            known = self._uncovered or Uncovered.none(before.frame.shape)
            self._uncovered = known.followed(sight.view.past, before.shown_halves)
            self._ghost += self._uncovered.left(sight.shown, sight.view.shown_halves, sight.view.interior)

    @property
    def findings(self) -> Findings:
        """The results so far."""
        scores, changes, curves = self._scores, self._changes.values(), self.curves
        return Findings(
            psnr=float(np.mean(curves["psnr"])),
            ssim=float(np.mean(curves["ssim"])),
            flip=float(np.mean(curves["flip"])),
            relmse=float(np.mean(curves["relmse"])),
            relmse_trimmed=float(np.mean([score.relmse_trimmed for score in scores])),
            bias=total(score.brightness for score in scores).value - 1,
            temporal=root(total(change.everywhere for change in changes).value),
            temporal_on_surfaces=root(total(change.on_surfaces for change in changes).value),
            flicker=self._flicker.value,
            warped=excess(total(change.warped for change in changes), total(change.warped_truth for change in changes)),
            edges=total(score.edges for score in scores).value,
            shadows=total(score.shadows for score in scores).value,
            moving_shadows=total(score.moving_shadows for score in scores).value,
            detail=total(score.detail for score in scores).value,
            ghost=self._ghost.value,
            unsettled=total(score.unsettled for score in scores).value,
            lags=tuple(lag(responses) for responses in self._responses),
        )

    @property
    def curves(self) -> dict[str, list[float]]:
        """Values of each frame so far, by the key of their measure; the temporal error after a gap is NaN."""
        return {
            "psnr": [decibels(score.error.value) for score in self._scores],
            "ssim": [score.ssim for score in self._scores],
            "flip": [score.flip for score in self._scores],
            "relmse": [score.relmse for score in self._scores],
            "temporal": [self._temporal(number) for number in range(len(self._scores))],
        }

    def _temporal(self, number: int) -> float:
        change = self._changes.get(number)
        return root(change.everywhere.value) if change else float("nan")


def switches_in(truths: Sequence[Pair]) -> list[int]:
    """Return the indices of the frames right before which a lamp was switched, by the halves of each frame's truth."""
    return steps([float(np.mean(0.5 * (first + second) @ np.array(LUMINANCE))) for first, second in truths])


def total(shares: Iterable[Share]) -> Share:
    """Return the sum of all shares."""
    return sum(shares, Share())

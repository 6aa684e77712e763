"""Measures one picture by itself, and in comparison with the previous one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import nan

import numpy as np

from svgf_cl.compare.halves import brightness, squared_change, squared_error
from svgf_cl.compare.kept import contrast, detail, sharpness
from svgf_cl.compare.metrics import flip, relmse, ssim, trimmed_relmse, why_no_flip
from svgf_cl.compare.share import Share
from svgf_cl.compare.stability import residual
from svgf_cl.compare.thin import unsettled
from svgf_cl.compare.view import View
from svgf_cl.io.display import Linear, display


@dataclass(frozen=True, eq=False)
class Sight:
    """A linear picture, (H, W, 3), and the view that judges it."""

    picture: Linear
    view: View

    @cached_property
    def shown(self) -> Linear:
        """The picture, display-referred."""
        return display(self.picture, self.view.exposure)


@dataclass(frozen=True)
class Score:
    """The measures of one picture.

    Parameters
    ----------
    ssim, flip, relmse, relmse_trimmed : float
    error, brightness, edges, shadows, moving_shadows, detail, unsettled : Share
    """

    ssim: float
    flip: float
    relmse: float
    relmse_trimmed: float
    error: Share
    brightness: Share
    edges: Share
    shadows: Share
    moving_shadows: Share
    detail: Share
    unsettled: Share

    @classmethod
    def of(cls, sight: Sight) -> Score:
        """Measure one picture."""
        picture, shown, view = sight.picture, sight.shown, sight.view
        light = view.light_in(picture)
        return cls(
            ssim=ssim(shown, view.shown),
            flip=nan if why_no_flip() else flip(shown, view.shown),
            relmse=relmse(picture, view.truth),
            relmse_trimmed=trimmed_relmse(picture, view.truth),
            error=squared_error(shown, view.shown_halves),
            brightness=brightness(picture, view.halves, view.reflecting),
            edges=sharpness(shown, view.shown_halves, np.ones(view.frame.shape, np.bool_)),
            shadows=contrast(light, view.light, view.lit),
            moving_shadows=contrast(light, view.light, view.relit),
            detail=detail(shown, view.shown_halves, view.textured),
            unsettled=unsettled(shown, view.shown, view.thin),
        )


@dataclass(frozen=True)
class Change:
    """The measures of the change from one picture to the next.

    Parameters
    ----------
    everywhere, on_surfaces : Share
        How much the error changes: everywhere, and on surfaces of one colour.
    warped, warped_truth : Share
        The change that exact motion does not explain, of the pictures and of the truth.
    """

    everywhere: Share
    on_surfaces: Share
    warped: Share
    warped_truth: Share

    @classmethod
    def of(cls, earlier: Sight, later: Sight) -> Change:
        """Measure two consecutive pictures."""
        before, now = earlier.view, later.view
        seen = earlier.shown, later.shown, before.shown_halves, now.shown_halves
        twice = (earlier.shown, earlier.shown), (later.shown, later.shown)
        return cls(
            everywhere=squared_change(*seen),
            on_surfaces=squared_change(*seen, before.plain & now.plain),
            warped=residual(*twice, now.past) if now.past else Share(),
            warped_truth=residual(before.shown_halves, now.shown_halves, now.past) if now.past else Share(),
        )

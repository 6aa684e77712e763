"""`View`: a frame, and the truth about it, with all of it that measures ask for more than once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from svgf_cl.compare.edges import interior
from svgf_cl.compare.halves import Mask, Pair
from svgf_cl.compare.kept import RADIUS, Plane
from svgf_cl.compare.reprojection import Reprojection
from svgf_cl.compare.surfaces import STILL, moving_texture, one_surface, reflecting, relit, speed, still, without_albedo
from svgf_cl.compare.thin import thin
from svgf_cl.frame import Frame
from svgf_cl.io.display import Linear, display


@dataclass(frozen=True, eq=False)
class View:
    """A frame, and the truth about it: what its pictures are judged by.

    Parameters
    ----------
    frame : Frame
        Of numpy arrays. What has to know a field that it lacks has no pixels to look at.
    halves : two of (H, W, 3)
        Independent halves of the truth, linear. Where it is known once, twice the same: then its noise counts.
    jitter : bool
        Whether pixels of the truth are means over their areas, which the albedo of one ray is not.
    earlier : Frame and two of (H, W, 3), optional
        The frame before, and halves of the truth about it, if they are known.
    exposure : float, stops
        Of all that is display-referred. What is linear stays as it is.
    """

    frame: Frame
    halves: Pair
    jitter: bool
    earlier: tuple[Frame, Pair] | None = None
    exposure: float = 0.0

    @cached_property
    def truth(self) -> Linear:
        """The best there is, linear."""
        return 0.5 * (self.halves[0] + self.halves[1])

    @cached_property
    def shown(self) -> Linear:
        """The truth, display-referred."""
        return display(self.truth, self.exposure)

    @cached_property
    def shown_halves(self) -> Pair:
        """The halves, display-referred."""
        return display(self.halves[0], self.exposure), display(self.halves[1], self.exposure)

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
    def past(self) -> Reprojection | None:
        """Where surfaces were in the frame before, if that is known."""
        return None if self.earlier is None else Reprojection.between(self.earlier[0], self.frame)

    @cached_property
    def resting(self) -> Mask:
        """Where the surface is known not to have moved since the frame before."""
        if self.past is None:
            return np.zeros(self.frame.shape, np.bool_)
        return self.past.found & (speed(self.frame) < STILL)

    @cached_property
    def textured(self) -> Mask:
        """Around which pixels a window shows one surface that moves, is no lamp, and has a texture."""
        return self.reflecting & moving_texture(self.frame, self._window)

    @cached_property
    def interior(self) -> Mask:
        """Where no edge of geometry touches a pixel."""
        return interior(self.frame)

    @cached_property
    def thin(self) -> Mask:
        """Where geometry is a few pixels thin."""
        return thin(self.frame)

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
        return self.reflecting & one_surface(self.frame, self._window, one_colour=self.jitter)

    @cached_property
    def reflecting(self) -> Mask:
        """Where no lamp is seen."""
        return reflecting(self.frame)

    def light_in(self, picture: Linear) -> Plane:
        """Luminance of a picture of this frame without albedo."""
        return without_albedo(picture, self.frame)

    @property
    def _window(self) -> int:
        return RADIUS + 1 if self.jitter else RADIUS

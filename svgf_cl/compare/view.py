"""`View`: a frame and its truth, with the values that several measures need."""

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
    """A frame and its truth, by which its pictures are judged.

    Parameters
    ----------
    frame : Frame
        It has numpy arrays. If it lacks a field, the measures that need the field find no pixels.
    halves : two of (H, W, 3)
        Independent halves of the truth, linear. If there is only one estimate, it is given twice, and its noise counts.
    jitter : bool
        Whether pixels of the truth are means over their areas; the albedo of one ray is not such a mean.
    earlier : Frame and two of (H, W, 3), optional
        The previous frame and the halves of its truth, if they are known.
    exposure : float, stops
        Exposure of all display-referred values; linear values stay as they are.
    """

    frame: Frame
    halves: Pair
    jitter: bool
    earlier: tuple[Frame, Pair] | None = None
    exposure: float = 0.0

    @cached_property
    def truth(self) -> Linear:
        """The best estimate of the truth: the mean of the halves, linear."""
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
        """The pixels of `lit` around which only the light has changed since the previous frame."""
        if self.earlier is None:
            return np.zeros(self.frame.shape, np.bool_)
        frame, halves = self.earlier
        past = self.light_in(halves[0]), self.light_in(halves[1])
        return self.lit & relit(past, self.light, still(frame, self.frame))

    @cached_property
    def past(self) -> Reprojection | None:
        """The positions of surfaces in the previous frame, if they are known."""
        return None if self.earlier is None else Reprojection.between(self.earlier[0], self.frame)

    @cached_property
    def resting(self) -> Mask:
        """The pixels whose surface is known not to have moved since the previous frame."""
        if self.past is None:
            return np.zeros(self.frame.shape, np.bool_)
        return self.past.found & (speed(self.frame) < STILL)

    @cached_property
    def textured(self) -> Mask:
        """The pixels whose window shows one moving surface with a texture and no lamp."""
        return self.reflecting & moving_texture(self.frame, self._window)

    @cached_property
    def interior(self) -> Mask:
        """The pixels that no edge of geometry touches."""
        return interior(self.frame)

    @cached_property
    def thin(self) -> Mask:
        """The pixels of geometry that is a few pixels thin."""
        return thin(self.frame)

    @cached_property
    def plain(self) -> Mask:
        """The pixels whose window shows one surface of one colour."""
        return one_surface(self.frame)

    @cached_property
    def lit(self) -> Mask:
        """The pixels whose window shows one surface and no lamp, so that all contrast there comes from the light.

        With `jitter`, the window is one pixel larger and shows one colour, too, because one ray does not say what else
        its pixel contains.
        """
        return self.reflecting & one_surface(self.frame, self._window, one_colour=self.jitter)

    @cached_property
    def reflecting(self) -> Mask:
        """The pixels that show no lamp and no sky."""
        return reflecting(self.frame)

    def light_in(self, picture: Linear) -> Plane:
        """Return the luminance of a picture of this frame without albedo."""
        return without_albedo(picture, self.frame)

    @property
    def _window(self) -> int:
        return RADIUS + 1 if self.jitter else RADIUS

"""`LightsDenoiser`: denoises a picture by its light passes, which still add up to the picture.

A pass such as Blender's DiffDir is light before the multiplication by an albedo without noise, DiffCol. The pass is
filtered first, and multiplied afterwards. So textures never pass through the filter, and the noise of indirect light
does not blur shadows of direct light. The difference between the picture and the sum of its passes is filtered as
another light. Where the passes add up to more than the picture, they are darkened to it before they are filtered.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from svgf_cl.denoisers import Denoisers
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.kalman import STANDARD_ERROR
from svgf_cl.frame import LUMINANCE, Frame, Shape
from svgf_cl.io.shot import Light

Picture = npt.NDArray[np.float32]
Channels = tuple[str, ...]

# The sum of 16-bit passes differs from the picture by up to this share of the light: each is rounded by up to 2^-12 of
# its size, and so are the factors and the picture.
ROUNDING = 2.0**-9
LEAST = 1e-6  # a difference that counts as 0 where there is no light
BACKDROP = 100.0  # depth of the background over that of the farthest surface
WHOLE, REST = ("picture",), ("rest",)
WEIGHTS = np.array(LUMINANCE, np.float32)


@dataclass(frozen=True, eq=False)
class Denoised:
    """The result of a frame.

    Parameters
    ----------
    picture : (H, W, 3) float32
        Linear HDR radiance.
    lights : mapping of tuple of str to (H, W, 3) float32
        The denoised passes and the factors that were filtered, by their channels. The picture is the sum of the passes
        times their factors.
    standard_error : (H, W) float32, optional
        The standard error of the picture's luminance, if the filter estimates it.
    """

    picture: Picture
    lights: Mapping[Channels, Picture]
    standard_error: Picture | None = None


@dataclass(frozen=True, eq=False)
class Parts:
    """A frame, split into the parts that are filtered separately.

    Parameters
    ----------
    frame : Frame
        The guides; its color is read if there are no lights.
    lights : sequence of Light
        Parts of the picture; empty to filter it as a whole.
    rest : (H, W, 3) float32, optional
        The picture minus the sum of the lights.
    factors : mapping of tuple of str to (H, W, 3) float32
        The factors of lights that differ from those in the file, by their channels.
    """

    frame: Frame
    lights: Sequence[Light] = ()
    rest: Picture | None = None
    factors: Mapping[Channels, Picture] = field(default_factory=dict)

    def composed(self, made: Mapping[Channels, Picture], error: Picture | None = None) -> Denoised:
        """Compose the picture from the filtered parts of `LightsDenoiser.filtered`."""
        if self.rest is None:
            return Denoised(made[WHOLE], {}, error)
        picture = np.minimum(self.rest, np.float32(0.0))
        for light in self.lights:
            picture += multiplied(made.get(light.channels, light.radiance), light.factor)
        if REST in made:
            picture += made[REST]
        lights = {light.channels: made.get(light.channels, light.radiance) for light in self.lights if light.filtered}
        return Denoised(picture, {**lights, **self.factors}, error)


class LightsDenoiser:
    """Denoises frames of one size, light by light.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    settings : Filter
        The same for all lights.
    share : float
        As in `Denoisers`.
    """

    def __init__(self, shape: Shape, settings: Filter, share: float = 1.0) -> None:
        self._denoisers = Denoisers(shape, settings, share)

    def filtered(self, parts: Parts) -> dict[Channels, Picture]:
        """Filter the parts of the next frame, and return them by their channels, or by `REST` or `WHOLE`.

        Parts that were always black so far are left out.

        Raises
        ------
        SvgfError
            As in `Denoiser.denoise`.
        """
        frame, rest = parts.frame, parts.rest
        if rest is None:
            return {WHOLE: self._denoisers.denoise(WHOLE, frame)}
        made, backed = {}, with_backdrop(frame)
        for light in parts.lights:
            if light.filtered and (light.channels in self._denoisers or light.radiance.any()):
                albedo = frame.albedo if light.factor is None or light.reflects else None
                made[light.channels] = self._denoisers.denoise(light.channels, single(backed, light.radiance, albedo))
        if REST in self._denoisers or rest.max(initial=0.0) > 0.0:
            made[REST] = self._denoisers.denoise(REST, single(frame, np.maximum(rest, 0.0), frame.albedo))
        return made

    def stage(self, key: Channels, name: str) -> Picture:
        """Return an intermediate result of the last frame of a part; errors as in `Denoiser.stage`."""
        return self._denoisers.stage(key, name)

    def standard_error(self, parts: Parts) -> Picture | None:
        """Return the standard error of the last frame's luminance, (H, W), or None if the filter does not estimate it.

        The noise of the parts is taken as independent.
        """
        factors = {light.channels: light.factor for light in parts.lights}
        squares = []
        for key in (*factors, REST, WHOLE):
            if self._denoisers.has_stage(key, STANDARD_ERROR):
                error, factor = self.stage(key, STANDARD_ERROR), factors.get(key)
                squares.append(np.square(error if factor is None else error * (factor @ WEIGHTS)))
        return np.sqrt(np.sum(squares, axis=0, dtype=np.float32)) if squares else None

    def update(self, settings: Filter) -> None:
        """Continue with other settings for all lights, as `Denoisers.update` does."""
        self._denoisers.update(settings)

    def reset(self) -> None:
        """Discard the history, as at a cut."""
        self._denoisers.reset()

    def profile(self) -> dict[str, float]:
        """Return the milliseconds on the device of each pass of the last frame, summed over all lights."""
        return self._denoisers.profile()


def with_backdrop(frame: Frame) -> Frame:
    """Return the frame with a surface far behind all others where nothing was hit.

    There a light pass has light only from something in between, such as fog. This light is filtered, too.
    """
    is_empty = ~np.any(frame.normal, axis=-1)
    seen = frame.depth[~is_empty & np.isfinite(frame.depth)]
    depth = np.where(is_empty, BACKDROP * seen.max(initial=1.0), frame.depth).astype(np.float32)
    normal = np.where(is_empty[..., None], np.array([0, 0, 1], np.float32), frame.normal)
    return replace(frame, normal=normal, depth=depth)


def single(frame: Frame, light: Picture, albedo: Picture | None) -> Frame:
    """Return a frame with one light as its color."""
    return Frame(color=light, normal=frame.normal, depth=frame.depth, motion=frame.motion, albedo=albedo, id=frame.id)


def finite(light: Light) -> Light:
    """Return the light, black where it or its factor is not finite, as the filter treats such pixels."""
    factor = None if light.factor is None else zeroed(light.factor)
    return replace(light, radiance=zeroed(light.radiance), factor=factor)


def zeroed(values: Picture) -> Picture:
    """Return the values, with 0 for those that are not finite."""
    usable = np.isfinite(values)
    return values if usable.all() else np.where(usable, values, np.float32(0.0))


def limited(lights: Sequence[Light], rest: Picture) -> tuple[Sequence[Light], Picture]:
    """Return the lights, darkened so that their sum is at most the picture, and the new rest of the picture.

    `rest` is the picture minus the lights, (H, W, 3). If it is negative, the renderer clamped a firefly in the picture
    but not in the pass, or something covers a part of the pixel. There all noisy lights are darkened by the same share.
    """
    if rest.min(initial=0.0) >= 0.0:
        return lights, rest
    noisy = np.zeros_like(rest)
    for light in lights:
        if light.filtered:
            noisy += multiplied(light.radiance, light.factor)
    taken = np.clip(-rest, 0.0, np.maximum(noisy, 0.0))
    share = np.float32(1.0) - np.divide(taken, noisy, out=np.zeros_like(noisy), where=taken > 0.0)
    darker = [replace(light, radiance=light.radiance * share) if light.filtered else light for light in lights]
    return darker, rest + taken


def multiplied(light: Picture, factor: Picture | None) -> Picture:
    """Return a pass times its factor: its part of the picture."""
    return light if factor is None else light * factor


def remainder(frame: Frame, lights: Sequence[Light]) -> Picture:
    """Return the picture minus the sum of its lights, (H, W, 3); 0 where this is only rounding."""
    if frame.color is None:
        return np.zeros_like(lights[0].radiance)
    rest, size = np.array(frame.color), np.abs(frame.color)
    for light in lights:
        term = multiplied(light.radiance, light.factor)
        rest -= term
        size += np.abs(term)
    return np.where(np.abs(rest) > ROUNDING * size + LEAST, rest, np.float32(0.0))

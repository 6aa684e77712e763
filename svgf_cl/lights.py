"""`LightsDenoiser`: denoises a picture by the light passes that it is the sum of, so that they still add up to it.

A pass such as Blender's DiffDir is light before it was multiplied by an albedo that has no noise, DiffCol. It is
filtered as it is and multiplied afterwards: textures never pass through the filter, and shadows of direct light are
not blurred by the noise of indirect light. What the picture has beyond the passes of its file is filtered as one more
light. Where the passes add up to more than the picture, they are darkened to it before they are filtered.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from svgf_cl.denoisers import Denoisers
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.kalman import STANDARD_ERROR
from svgf_cl.frame import LUMINANCE, Frame, Shape
from svgf_cl.io.shot import Light

Picture = npt.NDArray[np.float32]
Channels = tuple[str, ...]

# Passes in 16 bits add up to the picture but for this share of the light: each is rounded by up to 2^-12 of its size,
# and so are the factors and the picture.
ROUNDING = 2.0**-9
LEAST = 1e-6  # a difference that is nothing, where there is no light
WHOLE, REST = ("picture",), ("rest",)
WEIGHTS = np.array(LUMINANCE, np.float32)


@dataclass(frozen=True, eq=False)
class Denoised:
    """What was made of a frame.

    Parameters
    ----------
    picture : (H, W, 3) float32
        Linear HDR radiance.
    lights : mapping of tuple of str to (H, W, 3) float32
        The denoised passes, by their channels, and the factors of passes that were filtered; the picture is their sum.
    standard_error : (H, W) float32, optional
        Of the picture's luminance, where the filter tells it.
    """

    picture: Picture
    lights: Mapping[Channels, Picture]
    standard_error: Picture | None = None


class LightsDenoiser:
    """Denoises frames of one size, light by light.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    settings : Filter
        For all lights alike.
    share : float
        As of `Denoisers`.
    """

    def __init__(self, shape: Shape, settings: Filter, share: float = 1.0) -> None:
        self._denoisers = Denoisers(shape, settings, share)

    def whole(self, frame: Frame) -> Denoised:
        """Denoise the picture of the next frame as a whole; errors as of `Denoiser.denoise`."""
        picture = self._denoisers.denoise(WHOLE, frame)
        return Denoised(picture, {}, self._error({WHOLE: None}))

    def parts(self, frame: Frame, lights: Sequence[Light], rest: Picture) -> Denoised:
        """Denoise the parts of the picture of the next frame.

        Parameters
        ----------
        frame : Frame
            Its color is not read.
        lights : sequence of Light
        rest : (H, W, 3) float32
            What the picture has beyond the sum of the lights; below 0 where it has less.

        Raises
        ------
        SvgfError
            As `Denoiser.denoise`.
        """
        made = {light.channels: self._light(frame, light) for light in lights if light.filtered}
        terms = [multiplied(made.get(light.channels, light.radiance), light.factor) for light in lights]
        terms.append(np.minimum(rest, 0.0))
        if rest.max(initial=0.0) > 0.0 or REST in self._denoisers:
            terms.append(self._denoisers.denoise(REST, single(frame, np.maximum(rest, 0.0), frame.albedo)))
        error = self._error({light.channels: light.factor for light in lights} | {REST: None})
        return Denoised(np.sum(terms, axis=0, dtype=np.float32), made, error)

    def reset(self) -> None:
        """Forget the past, as at a cut."""
        self._denoisers.reset()

    def profile(self) -> dict[str, float]:
        """Milliseconds on the device of each pass of the last frame, all lights together."""
        return self._denoisers.profile()

    def _light(self, frame: Frame, light: Light) -> Picture:
        """A light, filtered; one that has been dark so far takes no filter."""
        if light.channels not in self._denoisers and not light.radiance.any():
            return light.radiance
        albedo = frame.albedo if light.factor is None or light.reflects else None
        return self._denoisers.denoise(light.channels, single(frame, light.radiance, albedo))

    def _error(self, factors: Mapping[Channels, Picture | None]) -> Picture | None:
        """The standard error of the sum of lights, by their channels and factors, whose noise is independent."""
        squares = []
        for key, factor in factors.items():
            error = self._denoisers.stage(key, STANDARD_ERROR)
            if error is not None:
                squares.append(np.square(error if factor is None else error * (factor @ WEIGHTS)))
        return np.sqrt(np.sum(squares, axis=0, dtype=np.float32)) if squares else None


def single(frame: Frame, light: Picture, albedo: Picture | None) -> Frame:
    """A frame of one light."""
    return Frame(color=light, normal=frame.normal, depth=frame.depth, motion=frame.motion, albedo=albedo, id=frame.id)


def finite(light: Light) -> Light:
    """The light, black where it or its factor is not finite, as the filter has it."""
    factor = None if light.factor is None else zeroed(light.factor)
    return replace(light, radiance=zeroed(light.radiance), factor=factor)


def zeroed(values: Picture) -> Picture:
    """The values, 0 in place of those that are not finite."""
    usable = np.isfinite(values)
    return values if usable.all() else np.where(usable, values, np.float32(0.0))


def limited(frame: Frame, lights: Sequence[Light]) -> Sequence[Light]:
    """The lights, no brighter together than the picture: noisy ones are darkened where they are, all by one share.

    There the renderer clamped a firefly in the picture but not in the pass, or something covers a part of the pixel.
    """
    excess = np.maximum(-remainder(frame, lights), 0.0)
    if not excess.any():
        return lights
    noisy = np.sum([multiplied(light.radiance, light.factor) for light in lights if light.filtered], axis=0)
    share = 1.0 - np.divide(np.minimum(excess, noisy), noisy, out=np.zeros_like(noisy), where=noisy > 0.0)
    return [replace(light, radiance=light.radiance * share) if light.filtered else light for light in lights]


def multiplied(light: Picture, factor: Picture | None) -> Picture:
    """A pass's part in the picture."""
    return light if factor is None else light * factor


def remainder(frame: Frame, lights: Sequence[Light]) -> Picture:
    """What the picture has beyond the sum of its lights, (H, W, 3); 0 where that is what rounding leaves."""
    terms = [multiplied(light.radiance, light.factor) for light in lights]
    if frame.color is None:
        return np.zeros_like(terms[0])
    rest: Picture = frame.color - np.sum(terms, axis=0, dtype=np.float32)
    size = np.sum(np.abs(terms), axis=0, dtype=np.float32) + np.abs(frame.color)
    return np.where(np.abs(rest) > ROUNDING * size + LEAST, rest, np.float32(0.0))

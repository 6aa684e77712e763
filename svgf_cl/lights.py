"""`LightsDenoiser`: denoises a picture by the light passes that it is the sum of, so that they still add up to it.

A pass such as Blender's DiffDir is light before it was multiplied by an albedo that has no noise, DiffCol. It is
filtered as it is and multiplied afterwards: textures never pass through the filter, and shadows of direct light are
not blurred by the noise of indirect light. What the picture has beyond the passes of its file is filtered as one more
light. Where the passes add up to more than the picture, they are darkened to it before they are filtered.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from svgf_cl.denoiser import Denoiser
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
# The share of the first frame's pixels that may be darker than the sum of their lights. If it is greater, the passes
# are not parts of the picture.
STRAY = 0.01
WHOLE, REST = ("picture",), ("rest",)


@dataclass(frozen=True, eq=False)
class Denoised:
    """What was made of a frame.

    Parameters
    ----------
    picture : (H, W, 3) float32
        Linear HDR radiance.
    lights : mapping of tuple of str to (H, W, 3) float32
        The denoised passes, by their channels; their sum, each times its factor, is the picture.
    standard_error : (H, W) float32, optional
        Of the picture's luminance, where the filter tells it.
    """

    picture: Picture
    lights: Mapping[Channels, Picture]
    standard_error: npt.NDArray[np.float32] | None = None


class LightsDenoiser:
    """Denoises frames of one size, with the light passes that their pictures are the sum of.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    settings : Filter
        For all lights alike.
    """

    def __init__(self, shape: Shape, settings: Filter) -> None:
        self._shape, self._settings = shape, settings
        self._denoisers: dict[Channels, Denoiser] = {}
        self._are_parts: bool | None = None

    def denoise(self, frame: Frame, lights: Sequence[Light] = ()) -> Denoised:
        """Denoise the next frame.

        Parameters
        ----------
        frame : Frame
        lights : sequence of Light
            What its picture is the sum of; none to filter the picture as a whole.

        Raises
        ------
        SvgfError
            As `Denoiser.denoise`.
        """
        if not lights:
            return Denoised(self._filtered(WHOLE, frame), {}, self._error(WHOLE))
        lights = [finite(light) for light in lights]
        rest = remainder(frame, lights)
        if not self._checked(rest):
            alone = replace(frame, direct=None, indirect=None, emission=None)
            return Denoised(self._filtered(WHOLE, alone), {}, self._error(WHOLE))
        lights, rest = limited(lights, rest)
        made = {light.channels: self._light(frame, light) for light in lights if light.filtered}
        picture = np.minimum(rest, np.float32(0.0))
        for light in lights:
            picture += multiplied(made.get(light.channels, light.radiance), light.factor)
        if rest.max(initial=0.0) > 0.0 or REST in self._denoisers:
            picture += self._filtered(REST, single(frame, np.maximum(rest, 0.0), frame.albedo))
        return Denoised(picture, made, self._error_of_sum(lights))

    def reset(self) -> None:
        """Forget the past, as at a cut."""
        for denoiser in self._denoisers.values():
            denoiser.reset()

    def profile(self) -> dict[str, float]:
        """Milliseconds on the device of each pass of the last frame, all lights together."""
        total: dict[str, float] = {}
        for denoiser in self._denoisers.values():
            for name, time in denoiser.profile().items():
                total[name] = total.get(name, 0.0) + time
        return total

    def _light(self, frame: Frame, light: Light) -> Picture:
        """A light, filtered; one that has been dark so far takes no filter."""
        if light.channels not in self._denoisers and not light.radiance.any():
            return light.radiance
        albedo = frame.albedo if light.factor is None else None
        return self._filtered(light.channels, single(frame, light.radiance, albedo))

    def _filtered(self, key: Channels, frame: Frame) -> Picture:
        if key not in self._denoisers:
            self._denoisers[key] = Denoiser(self._shape, settings=self._settings)
        result: Picture = self._denoisers[key].denoise(frame)
        return result

    def _checked(self, rest: Picture) -> bool:
        """Whether the passes are parts of the picture, told from the first frame; a warning where they are not."""
        if self._are_parts is None:
            share = float((rest.min(axis=-1) < 0.0).mean())
            self._are_parts = share <= STRAY
            if not self._are_parts:
                warnings.warn(
                    f"the light passes add up to more than the picture in {100 * share:.0f} % of the pixels, so they"
                    " are left as they are, and the picture is denoised as a whole",
                    stacklevel=3,
                )
        return self._are_parts

    def _error(self, key: Channels) -> npt.NDArray[np.float32] | None:
        denoiser = self._denoisers.get(key)
        return denoiser.stage(STANDARD_ERROR) if denoiser and STANDARD_ERROR in denoiser.stages else None

    def _error_of_sum(self, lights: Sequence[Light]) -> npt.NDArray[np.float32] | None:
        """The standard error of the sum of lights, whose noise is independent."""
        factors = {light.channels: light.factor for light in lights}
        squares = []
        for key in self._denoisers:
            error, factor = self._error(key), factors.get(key)
            if error is not None:
                squares.append(
                    np.square(error if factor is None else error * (factor @ np.array(LUMINANCE, np.float32)))
                )
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


def limited(lights: Sequence[Light], rest: Picture) -> tuple[Sequence[Light], Picture]:
    """The lights, no brighter together than the picture, and what it then has beyond their sum.

    Where `rest`, what the picture has beyond the lights (H, W, 3), is negative, the renderer clamped a firefly in the
    picture but not in the pass, or something covers a part of the pixel. Noisy lights are darkened there, all by one
    share.
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
    """A pass's part in the picture."""
    return light if factor is None else light * factor


def remainder(frame: Frame, lights: Sequence[Light]) -> Picture:
    """What the picture has beyond the sum of its lights, (H, W, 3); 0 where that is what rounding leaves."""
    if frame.color is None:
        return np.zeros_like(lights[0].radiance)
    rest, size = np.array(frame.color), np.abs(frame.color)
    for light in lights:
        term = multiplied(light.radiance, light.factor)
        rest -= term
        size += np.abs(term)
    return np.where(np.abs(rest) > ROUNDING * size + LEAST, rest, np.float32(0.0))

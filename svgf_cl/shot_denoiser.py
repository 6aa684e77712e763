"""`ShotDenoiser`: denoises the frames of a shot from its files, with guides and light passes."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from svgf_cl.check.noise import has_noisy_depth, lacks_motion
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.shot import Light
from svgf_cl.lights import Channels, Denoised, LightsDenoiser, Parts, Picture, finite, limited, remainder
from svgf_cl.prefilter import Effort, Prefilter

# Of pixels that are darker than the sum of their lights: where they are more, the passes are not parts of the picture.
STRAY = 0.01
GUIDES = 4  # denoisers beside those of lights and their factors, at most: albedo, normals, depth, the rest of the light


@dataclass(frozen=True)
class Method:
    """How the frames of a shot are denoised.

    Parameters
    ----------
    settings : Filter
    lights : bool
        Whether the light passes that a picture is the sum of are denoised one by one; else the picture as a whole.
    prefilter : {"auto", "on", "off"}
        Whether noise is taken out of depth and the factors of light passes, and holes in normals are filled: "auto"
        does it where the depth of the shot is noisy. Albedo is filtered unless it is "off".
    """

    settings: Filter
    lights: bool = True
    prefilter: Effort = "auto"


class ShotDenoiser:
    """Denoises the frames of a shot, in order; of a shot that is run backward, in that order.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    method : Method
    lights : int
        How many light passes frames have.
    share : float
        Of the device's memory, for all that is filtered of a frame together.
    """

    def __init__(self, shape: Shape, method: Method, lights: int = 0, share: float = 1.0) -> None:
        self._method = method
        self._share = share / (GUIDES + 2 * lights)  # each light may have a factor that is filtered, too
        self._shape = shape
        self._lights = LightsDenoiser(shape, method.settings, self._share)
        self._prefilter: Prefilter | None = None
        self._is_settled = self._has_parts = self._lacks_motion = False

    def settle(self, frame: Frame, lights: Sequence[Light] = (), previous: Frame | None = None) -> None:
        """Decide from a frame for the whole shot how guides are filtered, and whether lights are parts of the picture.

        By default that is the first frame that comes. With the frame before it, it tells whether motion is missing:
        then each frame is filtered alone. Other parameters are those of `denoise`.
        """
        self._lacks_motion = previous is not None and lacks_motion(frame, previous)
        if self._method.prefilter != "off":
            is_noisy = self._method.prefilter == "on" or has_noisy_depth(frame)
            is_followed = bool(np.any(frame.motion)) or not (previous is None or self._lacks_motion)
            self._prefilter = Prefilter(self._shape, is_noisy=is_noisy, is_followed=is_followed, share=self._share)
        if lights and self._method.lights:
            self._has_parts = is_sum(remainder(frame, [finite(light) for light in lights]))
        self._is_settled = True

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
            As of `Denoiser.denoise`.
        """
        parts = self.parts(frame, lights)
        made = self.filtered(parts)
        return parts.composed(made, self._lights.standard_error(parts))

    def parts(self, frame: Frame, lights: Sequence[Light] = ()) -> Parts:
        """What is to be filtered of the next frame, with its guides filtered already; parameters of `denoise`."""
        if not self._is_settled:
            self.settle(frame, lights)
        if self._lacks_motion:
            frame = replace(frame, motion=np.full_like(frame.motion, np.nan))  # a pixel without history
        guided = self._prefilter.frame(frame) if self._prefilter else frame
        if not (lights and self._method.lights):
            return Parts(guided)
        if not self._has_parts:  # light that is seen directly may be of another picture, too
            return Parts(replace(guided, direct=None, indirect=None, emission=None))
        lights = [finite(light) for light in lights]
        lights, rest = limited(lights, remainder(frame, lights))
        better = self._guided_lights(frame, lights)
        return Parts(guided, better, rest, new_factors(lights, better))

    def filtered(self, parts: Parts) -> dict[Channels, Picture]:
        """Filter the parts of the next frame; errors as of `denoise`."""
        return self._lights.filtered(parts)

    def uncertainty(self, channels: Channels) -> Picture:
        """How uncertain a part of the last frame is, (H, W), as `TemporalFilter.uncertainty` has it."""
        settings = self._method.settings
        assert isinstance(settings, TemporalFilter)
        return settings.uncertainty(partial(self._lights.stage, channels))

    def update(self, settings: Filter) -> None:
        """Go on with other settings or another filter, as `Denoisers.update`; guides are filtered as before."""
        self._lights.update(settings)
        self._method = replace(self._method, settings=settings)

    def reset(self) -> None:
        """Discard the history, as at a cut."""
        self._lights.reset()
        if self._prefilter:
            self._prefilter.reset()

    def profile(self) -> dict[str, float]:
        """Milliseconds on the device of each pass of the last frame, all lights together."""
        return self._lights.profile()

    def _guided_lights(self, frame: Frame, lights: Sequence[Light]) -> Sequence[Light]:
        """Lights with better factors; without a prefilter, the albedo of what is reflected is too noisy to be used."""
        if self._prefilter:
            return self._prefilter.lights(frame, lights)
        return [replace(light, reflects=False) for light in lights]


def new_factors(before: Sequence[Light], after: Sequence[Light]) -> dict[Channels, Picture]:
    """The factors of lights that are others than before, by their channels."""
    return {
        new.factor_channels: new.factor
        for old, new in zip(before, after, strict=True)
        if new.factor is not None and new.factor is not old.factor
    }


def is_sum(rest: Picture) -> bool:
    """Whether the passes add up to at most the picture, given the rest of the picture; warns if not."""
    share = float((rest.min(axis=-1) < 0.0).mean())
    if share > STRAY:
        warnings.warn(
            f"the light passes add up to more than the picture in {100 * share:.0f} % of the pixels, so they stay"
            " unchanged, and the picture is denoised as a whole",
            stacklevel=3,
        )
    return share <= STRAY

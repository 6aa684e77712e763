"""`ShotDenoiser`: denoises the frames of a shot, with their guides and light passes."""

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

# If a larger share of pixels is darker than the sum of their lights, the passes are not parts of the picture.
STRAY = 0.01
GUIDES = 4  # most denoisers in addition to those of lights and factors: albedo, normals, depth, the rest of the light


@dataclass(frozen=True)
class Method:
    """The method to denoise the frames of a shot.

    Parameters
    ----------
    settings : Filter
    lights : bool
        Whether the light passes whose sum is the picture are denoised one by one; else the picture as a whole.
    prefilter : {"auto", "on", "off"}
        Whether depth and the factors of light passes are denoised, and holes in normals are filled: "auto" does it if
        the depth of the shot is noisy. Albedo is denoised unless it is "off".
    """

    settings: Filter
    lights: bool = True
    prefilter: Effort = "auto"


class ShotDenoiser:
    """Denoises the frames of a shot in order, forward or backward in time.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    method : Method
    lights : int
        Number of light passes of the frames.
    share : float
        The share of the device's memory for all denoisers of a frame together.
    """

    def __init__(self, shape: Shape, method: Method, lights: int = 0, share: float = 1.0) -> None:
        self._method = method
        self._share = share / (GUIDES + 2 * lights)  # each light may have a factor that is filtered, too
        self._shape = shape
        self._lights = LightsDenoiser(shape, method.settings, self._share)
        self._prefilter: Prefilter | None = None
        self._is_settled = self._has_parts = self._lacks_motion = False

    def settle(self, frame: Frame, lights: Sequence[Light] = (), previous: Frame | None = None) -> None:
        """Decide for the whole shot how guides are filtered, and whether the picture is the sum of its lights.

        By default the first frame that comes decides. With the previous frame, this also finds whether motion is
        missing; then each frame is filtered alone. The other parameters are those of `denoise`.
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
            The lights whose sum is its picture; empty to filter the picture as a whole.

        Raises
        ------
        SvgfError
            As in `Denoiser.denoise`.
        """
        parts = self.parts(frame, lights)
        made = self.filtered(parts)
        return parts.composed(made, self._lights.standard_error(parts))

    def parts(self, frame: Frame, lights: Sequence[Light] = ()) -> Parts:
        """Return the parts of the next frame to filter, with filtered guides; the parameters are those of `denoise`."""
        if not self._is_settled:
            self.settle(frame, lights)
        if self._lacks_motion:
            frame = replace(frame, motion=np.full_like(frame.motion, np.nan))  # a pixel without history
        guided = self._prefilter.frame(frame) if self._prefilter else frame
        if not (lights and self._method.lights):
            return Parts(guided)
        if not self._has_parts:  # directly visible light may belong to another picture, too
            return Parts(replace(guided, direct=None, indirect=None, emission=None))
        lights = [finite(light) for light in lights]
        lights, rest = limited(lights, remainder(frame, lights))
        better = self._guided_lights(frame, lights)
        return Parts(guided, better, rest, new_factors(lights, better))

    def filtered(self, parts: Parts) -> dict[Channels, Picture]:
        """Filter the parts of the next frame; errors as in `denoise`."""
        return self._lights.filtered(parts)

    def uncertainty(self, channels: Channels) -> Picture:
        """Return the uncertainty of a part of the last frame, (H, W); see `TemporalFilter.uncertainty`."""
        settings = self._method.settings
        assert isinstance(settings, TemporalFilter)
        return settings.uncertainty(partial(self._lights.stage, channels))

    def update(self, settings: Filter) -> None:
        """Continue with other settings or another filter, as `Denoisers.update` does; guides are filtered as before."""
        self._lights.update(settings)
        self._method = replace(self._method, settings=settings)

    def reset(self) -> None:
        """Discard the history, as at a cut."""
        self._lights.reset()
        if self._prefilter:
            self._prefilter.reset()

    def profile(self) -> dict[str, float]:
        """Return the milliseconds on the device of each pass of the last frame, summed over all lights."""
        return self._lights.profile()

    def _guided_lights(self, frame: Frame, lights: Sequence[Light]) -> Sequence[Light]:
        """Return lights with filtered factors; without a prefilter, the reflected albedo is too noisy to be used."""
        if self._prefilter:
            return self._prefilter.lights(frame, lights)
        return [replace(light, reflects=False) for light in lights]


def new_factors(before: Sequence[Light], after: Sequence[Light]) -> dict[Channels, Picture]:
    """Return the factors of lights that have changed, by their channels."""
    return {
        new.factor_channels: new.factor
        for old, new in zip(before, after, strict=True)
        if new.factor is not None and new.factor is not old.factor
    }


def is_sum(rest: Picture) -> bool:
    """Return whether the sum of the passes is at most the picture, by the rest of the picture; warn if not."""
    share = float((rest.min(axis=-1) < 0.0).mean())
    if share > STRAY:
        warnings.warn(
            f"the light passes add up to more than the picture in {100 * share:.0f} % of the pixels, so they stay"
            " unchanged, and the picture is denoised as a whole",
            stacklevel=3,
        )
    return share <= STRAY

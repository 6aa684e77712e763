"""`ShotDenoiser`: denoises the frames of a shot as its files have them, guides and light passes included."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Frame
from svgf_cl.io.shot import Light, Shot, ShotFrame
from svgf_cl.lights import Denoised, LightsDenoiser, Picture, remainder
from svgf_cl.prefilter import Effort, Prefilter, has_noisy_depth

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
        Whether noise is taken out of depth and the factors of light passes: "auto" does it where the depth of the first
        frame is noisy. Albedo is filtered unless it is "off".
    """

    settings: Filter
    lights: bool = True
    prefilter: Effort = "auto"


class ShotDenoiser:
    """Denoises the frames of a shot, in order; of a shot that is run backward, in that order.

    Parameters
    ----------
    shot : Shot
    method : Method
    """

    def __init__(self, shot: Shot, method: Method) -> None:
        self._shot, self._method = shot, method
        self._share = 1.0 / (GUIDES + 2 * max(1, len(shot.reading.lights)))
        self._lights = LightsDenoiser(shot.shape, method.settings, self._share)
        self._prefilter: Prefilter | None = None
        self._has_parts: bool | None = None if method.lights else False

    def denoise(self, source: ShotFrame, motion: Picture | None = None) -> Denoised:
        """Denoise the next frame.

        Parameters
        ----------
        source : ShotFrame
        motion : (H, W, 2 or 3) float32, optional
            In place of the frame's own, to the frame that was denoised before.

        Raises
        ------
        SvgfError
            As of `Denoiser.denoise`.
        """
        frame = source.frame if motion is None else replace(source.frame, motion=motion)
        rest = remainder(frame, source.lights) if source.lights and self._has_parts is not False else None
        if self._has_parts is None:
            self._has_parts = rest is not None and is_sum(rest)
        prefilter = self._prefilter_for(frame)
        guided = prefilter.frame(frame) if prefilter else frame
        if rest is None or not self._has_parts:
            return self._lights.whole(guided)
        return self._lights.parts(guided, self._guided_lights(frame, source.lights), rest)

    def reset(self) -> None:
        """Forget the past, as at a cut."""
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

    def _prefilter_for(self, frame: Frame) -> Prefilter | None:
        if self._prefilter is None and self._method.prefilter != "off":
            is_noisy = self._method.prefilter == "on" or has_noisy_depth(frame)
            self._prefilter = Prefilter(self._shot.shape, is_noisy=is_noisy, share=self._share)
        return self._prefilter


def is_sum(rest: Picture) -> bool:
    """Whether passes are parts of a picture that has so much beyond them; a warning where they are not."""
    share = float((rest.min(axis=-1) < 0.0).mean())
    if share > STRAY:
        warnings.warn(
            f"the light passes add up to more than the picture in {100 * share:.0f} % of the pixels, so they are left"
            " as they are, and the picture is denoised as a whole",
            stacklevel=3,
        )
    return share <= STRAY

"""`Prefilter`: takes the noise out of what guides the filter, before the light is filtered.

Renderers average albedo, normals and depth over the same samples as light. Under depth of field and motion blur they
are as noisy as light is, and the albedo of a rough mirror is that of whatever a sample reflected. Each of them goes
through the filter itself, as light without surfaces: what noise changes from frame to frame is smoothed, the rest is
kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from svgf_cl.denoisers import Denoisers
from svgf_cl.filters import DEFAULT
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.shot import Light

Array = npt.NDArray[np.float32]
Effort = Literal["auto", "on", "off"]
EFFORTS: tuple[Effort, ...] = ("auto", "on", "off")

# A mean of unit normals is shorter than 1. Where so many of those that were hit are, it is not edges alone that are
# means of several surfaces: there is depth of field, motion blur or fog.
SHORT, SHARE = 0.98, 0.04
LEAST_NORMAL = 0.3  # of the length of a normal that was hit: less is mostly background


@dataclass(frozen=True)
class Noise:
    """Which guides of a shot are noisy.

    Parameters
    ----------
    surfaces : bool
        Normals and depth.
    factors : bool
        Albedos that light passes are multiplied by, and light that is seen directly.
    """

    surfaces: bool
    factors: bool

    @classmethod
    def told(cls, frame: Frame, effort: Effort, *, averaged: bool) -> Noise:
        """Tell it from the first frame, and from whether its pixels are means over several places."""
        if effort != "auto":
            return cls(effort == "on", effort == "on")
        length = np.linalg.norm(frame.normal, axis=-1)
        hit = length > 0.0
        is_mixed = float((hit & (length < SHORT)).sum()) > SHARE * max(1, int(hit.sum()))
        return cls(averaged, averaged and is_mixed)


class Prefilter:
    """Filters the guides of the frames of a shot.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    noise : Noise
        What is filtered beside albedo, which always is.
    share : float
        As of `Denoisers`.
    """

    def __init__(self, shape: Shape, noise: Noise, share: float = 1.0) -> None:
        self._noise = noise
        self._denoisers = Denoisers(shape, DEFAULT(), share)
        self._flat = np.zeros((*shape, 3), np.float32)
        self._flat[..., 2] = 1.0

    def frame(self, frame: Frame) -> Frame:
        """The same frame with better guides."""
        better: dict[str, Array] = {}
        if frame.albedo is not None:
            better["albedo"] = self._filtered("albedo", frame, frame.albedo)
        if self._noise.surfaces:
            normal = 2.0 * self._filtered("normal", frame, 0.5 * frame.normal + 0.5) - 1.0
            length = np.linalg.norm(normal, axis=-1, keepdims=True)
            hit = length > LEAST_NORMAL
            better["normal"] = np.where(hit, normal / np.maximum(length, LEAST_NORMAL), np.float32(0.0))
            with np.errstate(divide="ignore"):
                nearness = np.where(frame.depth > 0.0, 1.0 / frame.depth, np.float32(0.0))
                smooth = self._filtered("nearness", frame, np.repeat(nearness[..., None], 3, axis=-1))
                better["depth"] = 1.0 / np.maximum(smooth[..., 0], np.float32(0.0))
        return replace(frame, **better)

    def lights(self, frame: Frame, lights: Sequence[Light]) -> tuple[Light, ...]:
        """The same lights with better factors; those that are seen directly become ones to be filtered."""
        if not self._noise.factors:
            return tuple(lights)
        factors: dict[tuple[str, ...], Array] = {}
        for light in lights:
            if light.factor is not None and light.factor_channels not in factors:
                name = " ".join(light.factor_channels)
                factors[light.factor_channels] = self._filtered(name, frame, light.factor)
        return tuple(replace(light, factor=factors.get(light.factor_channels), filtered=True) for light in lights)

    def reset(self) -> None:
        """Forget the past, as at a cut."""
        self._denoisers.reset()

    def _filtered(self, name: str, frame: Frame, value: Array) -> Array:
        """A guide (H, W, 3), filtered as light that lies on no surface."""
        depth, motion = self._flat[..., 2], frame.motion[..., :2]
        whole = Frame(color=np.asarray(value, np.float32), normal=self._flat, depth=depth, motion=motion)
        return self._denoisers.denoise(name, whole)

"""`Prefilter`: removes noise from the guides of the filter before the light is filtered.

The albedo of a rough mirror is that of the surface that a sample reflected, so it is noisy. With depth of field, motion
blur, fog or jittered rays, depth and the factors of light passes are noisy, too. Each of these guides is filtered like
light without surfaces: the filter smooths the noise that changes from frame to frame, and keeps the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from svgf_cl.check.noise import extremes
from svgf_cl.denoisers import Denoisers
from svgf_cl.filters import DEFAULT
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.shot import Light

Array = npt.NDArray[np.float32]
# Whether guides other than albedo are filtered: "auto" if depth is noisy, "on" always. "off" filters no guide at all.
Effort = Literal["auto", "on", "off"]
EFFORTS: tuple[Effort, ...] = ("auto", "on", "off")

# Lower albedos are not filtered: they are those of lamps, whose light must not leak into their surroundings.
BLACK = 0.01
LEAST_HIT = 0.3  # least length of a mean of normals, some of which are 0, where something was hit


class Prefilter:
    """Filters the guides of the frames of a shot.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    is_noisy : bool
        Whether depth is filtered, too, and holes in normals are filled; albedo always is filtered.
    is_followed : bool
        Whether motion is known. Only then are factors of lights, and directly visible light, filtered like depth: they
        contain textures, which would be smeared if objects move and motion is 0, as with Blender's motion blur.
    share : float
        As in `Denoisers`.
    """

    def __init__(self, shape: Shape, *, is_noisy: bool, is_followed: bool = True, share: float = 1.0) -> None:
        self._is_noisy, self._filters_lights = is_noisy, is_noisy and is_followed
        self._denoisers = Denoisers(shape, DEFAULT(), share)
        self._flat = np.zeros((*shape, 3), np.float32)
        self._flat[..., 2] = 1.0

    def frame(self, frame: Frame) -> Frame:
        """Return the frame with filtered guides."""
        better: dict[str, Array] = {}
        if frame.albedo is not None:
            filtered = self._filtered("albedo", frame, frame.albedo)
            better["albedo"] = np.where(is_black_area(frame.albedo), frame.albedo, filtered)
        if self._is_noisy:
            with np.errstate(divide="ignore"):
                nearness = np.where(frame.depth > 0.0, 1.0 / frame.depth, np.float32(0.0))
                smooth = self._filtered("nearness", frame, np.repeat(nearness[..., None], 3, axis=-1))
                better["depth"] = 1.0 / np.maximum(smooth[..., 0], np.float32(0.0))
            better["normal"] = self._without_holes(frame)
        return replace(frame, **better)

    def lights(self, frame: Frame, lights: Sequence[Light]) -> tuple[Light, ...]:
        """Return the lights with filtered factors; directly visible lights are then marked as noisy, too."""
        if not self._filters_lights:
            return tuple(lights)
        factors: dict[tuple[str, ...], Array] = {}
        for light in lights:
            if light.factor is not None and light.factor_channels not in factors:
                name = " ".join(light.factor_channels)
                factors[light.factor_channels] = self._filtered(name, frame, light.factor)
        return tuple(replace(light, factor=factors.get(light.factor_channels), filtered=True) for light in lights)

    def _without_holes(self, frame: Frame) -> Array:
        """Return the normals, with holes filled that scattered rays left."""
        normal = 2.0 * self._filtered("normal", frame, 0.5 * frame.normal + 0.5) - 1.0
        length = np.linalg.norm(normal, axis=-1, keepdims=True)
        is_hole = ~frame.normal.any(axis=-1, keepdims=True) & (length > LEAST_HIT)
        filled: Array = np.where(is_hole, normal / np.maximum(length, LEAST_HIT), frame.normal)
        return filled

    def reset(self) -> None:
        """Discard the history, as at a cut."""
        self._denoisers.reset()

    def _filtered(self, name: str, frame: Frame, value: Array) -> Array:
        """Return a guide (H, W, 3), filtered like light without surfaces."""
        depth, motion = self._flat[..., 2], frame.motion[..., :2]
        whole = Frame(color=np.asarray(value, np.float32), normal=self._flat, depth=depth, motion=motion)
        least, most = extremes(whole.color)
        smooth: Array = np.clip(self._denoisers.denoise(name, whole), least, most)
        return smooth


def is_black_area(albedo: Array) -> npt.NDArray[np.bool_]:
    """Return where a pixel and most of its eight neighbours are black, (H, W, 1): a single black pixel is noise."""
    padded = np.pad(albedo.max(axis=-1) < BLACK, 1, mode="edge").astype(np.int8)
    height, width = albedo.shape[:2]
    count = sum(padded[y : y + height, x : x + width] for y in range(3) for x in range(3))
    is_area: npt.NDArray[np.bool_] = (padded[1:-1, 1:-1] > 0) & (count > 4)
    return is_area[..., None]

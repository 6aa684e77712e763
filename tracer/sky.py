"""Light from everywhere outside the scene: a constant, or an image all around."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError
from .vectors import Float32, Float64


@dataclass(frozen=True, eq=False)
class Environment:
    """An image of all directions, in equirectangular projection.

    Parameters
    ----------
    image : (h, w, 3) float32
        Linear radiance, finite, >= 0; row 0 is straight up. In the image's own frame (+y up) its middle column lies
        towards +z, and +x is a quarter turn to the left of it: OpenEXR's convention for latitude-longitude maps.
    to_world : (3, 3) float
        Rotation from the image's frame into the world's.

    Raises
    ------
    SceneError
        The image has another shape or holds a value that is no radiance, or `to_world` is no rotation.
    """

    image: Float32
    to_world: Float64 = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        image: NDArray[np.floating] = np.asarray(self.image)
        if image.ndim != 3 or image.shape[2] != 3 or not image.size:
            raise SceneError(f"sky: expected an image of shape (h, w, 3), got {image.shape}")
        if not (np.isfinite(image).all() and image.min() >= 0.0):
            raise SceneError("sky: expected finite radiance >= 0 in every pixel of the image")
        if not np.allclose(self.to_world @ np.transpose(self.to_world), np.eye(3), atol=1e-4):
            raise SceneError(f"sky: expected a rotation from the image into the world, got {self.to_world}")

"""Intermediate results in the device's planes as images, for debugging and for tests against the oracle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from svgf_cl.filters.pipeline import Pipeline, Quantity, Resource
from svgf_cl.frame import LUMINANCE


@dataclass(frozen=True)
class Stage:
    """A stage: one quantity of a resource, shown as an image."""

    resource: Resource
    quantity: Quantity

    def image(self, planes: np.ndarray) -> np.ndarray:
        """Convert planes (n, H, W) of the whole resource to an image ([signals,] H, W[, channels]), float32, a copy.

        All planes must have the type of the quantity's format.
        """
        first = self.resource.begin(self.quantity.name) // self.quantity.format.nbytes
        return self.decoded(planes[first : first + self.quantity.planes])

    def decoded(self, planes: np.ndarray) -> np.ndarray:
        """Convert the planes of this quantity alone."""
        quantity = self.quantity
        stack = planes.reshape(-1, quantity.channels, *planes.shape[1:])
        images = quantity.format.decoded(np.moveaxis(stack, 1, -1))
        if quantity.is_light:
            red, green, blue = LUMINANCE
            images[..., 1] = (images[..., 1] - red * images[..., 0] - blue * images[..., 2]) / green
        if quantity.channels == 1:
            images = images[..., 0]
        return images if quantity.signals else images[0]


def stages(pipeline: Pipeline) -> dict[str, Stage]:
    """All stages of a pipeline by name, in the order of its passes."""
    return {name: Stage(resource, quantity) for name, resource, quantity in pipeline.shown()}

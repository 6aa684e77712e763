"""Planes of a whole image in the host's memory; one part at a time is copied to the device and back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from svgf_cl.device.layout import HALO, Layout
from svgf_cl.filters.pipeline import Quantity, Resource
from svgf_cl.frame import Shape

Corner = tuple[int, int]  # row, column


class HostPlanes:
    """The values of resources at every pixel of an image, without halo or padding.

    Parameters
    ----------
    quantities : mapping of Resource to iterable of Quantity
        The quantities to keep of each resource. The resources must hold every pixel.
    shape : (int, int)
        (height, width) of the image.
    """

    def __init__(self, quantities: Mapping[Resource, Iterable[Quantity]], shape: Shape) -> None:
        self._planes: dict[Resource, dict[Quantity, NDArray[Any]]] = {
            resource: {each: np.zeros((each.planes, *shape), each.format.dtype) for each in wanted}
            for resource, wanted in quantities.items()
        }

    @property
    def resources(self) -> tuple[Resource, ...]:
        """The resources that have quantities here."""
        return tuple(self._planes)

    @property
    def nbytes(self) -> int:
        """Host memory in use, in bytes."""
        return sum(planes.nbytes for kept in self._planes.values() for planes in kept.values())

    def forget(self) -> None:
        """Mark all values as unknown."""
        for kept in self._planes.values():
            for quantity, planes in kept.items():
                planes[...] = 0 if quantity.unknown is None else quantity.format.encoded(quantity.unknown)

    def holds(self, resource: Resource, quantity: Quantity) -> bool:
        """Whether a quantity of a resource is kept here."""
        return quantity in self._planes.get(resource, ())

    def of(self, resource: Resource, quantity: Quantity) -> NDArray[Any]:
        """Return a copy of a quantity's planes, (n, H, W)."""
        planes: NDArray[Any] = self._planes[resource][quantity].copy()
        return planes

    def upload(
        self, queue: cl.CommandQueue, resource: Resource, to: Place, corner: Corner, size: Shape
    ) -> list[cl.Event]:
        """Queue copies from the part of the image that begins at `corner` to a place on the device."""
        copies = []
        for quantity, planes in self._planes[resource].items():
            where = rectangle(resource, quantity, planes, to, corner, size)
            copies.append(cl.enqueue_copy(queue, to.memory, planes, is_blocking=False, **where))
        return copies

    def download(
        self, queue: cl.CommandQueue, resource: Resource, source: Place, corner: Corner, size: Shape
    ) -> list[cl.Event]:
        """Queue copies from a place on the device to the part of the image that begins at `corner`."""
        copies = []
        for quantity, planes in self._planes[resource].items():
            where = rectangle(resource, quantity, planes, source, corner, size)
            copies.append(cl.enqueue_copy(queue, planes, source.memory, is_blocking=False, **where))
        return copies


@dataclass(frozen=True)
class Place:
    """A part of an image on the device.

    Parameters
    ----------
    memory : pyopencl.Buffer
    layout : Layout
        The layout of the image in that buffer.
    corner : (int, int)
        Row and column of the part's first pixel in that image.
    """

    memory: cl.Buffer
    layout: Layout
    corner: Corner = (0, 0)


def rectangle(
    resource: Resource, quantity: Quantity, planes: NDArray[Any], place: Place, corner: Corner, size: Shape
) -> dict[str, Any]:
    """Return pyopencl's arguments to copy a part of every plane of a quantity; sizes along rows are in bytes."""
    nbytes, layout = planes.itemsize, place.layout
    (count, height, width), (top, left) = planes.shape, place.corner
    return {
        "buffer_origin": ((HALO + left) * nbytes, HALO + top, resource.begin(quantity.name) // nbytes),
        "buffer_pitches": (layout.pitch * nbytes, layout.plane * nbytes),
        "host_origin": (corner[1] * nbytes, corner[0], 0),
        "host_pitches": (width * nbytes, width * height * nbytes),
        "region": (size[1] * nbytes, size[0], count),
    }

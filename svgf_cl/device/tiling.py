"""Cuts a filter's frames into tiles, and computes how much device memory the tiles take."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from svgf_cl.device.layout import WIDEST_VECTOR, Layout
from svgf_cl.device.memory import Memory
from svgf_cl.device.memory_plan import Slot, memory_slots
from svgf_cl.device.tiles import Tile, best_window, tiles_of, window_lengths
from svgf_cl.filters.margins import widest_margin
from svgf_cl.filters.pipeline import Buffer, Pipeline, Quantity, Resource, history_of
from svgf_cl.frame import Shape

SLACK = 64  # pixels that a window on the past has more on every side, for motion that differs within the tile


@dataclass(frozen=True)
class Tiling:
    """How a pipeline's frames are cut into tiles.

    Parameters
    ----------
    pipeline : Pipeline
        Its lasting buffers must hold every pixel, and be read along motion.
    shape : (int, int)
        (height, width) of the image.
    row_alignment : int, pixels
        See `svgf_cl.device.layout.Layout`.
    """

    pipeline: Pipeline
    shape: Shape
    row_alignment: int

    def __post_init__(self) -> None:
        for entry in self.pipeline.passes:
            if self.pipeline.past_of(entry) and not entry.follows_motion:
                raise ValueError(
                    f"{entry.label}: expected to read the previous frame along motion, or to work on whole frames"
                )
        for resource in (*self.past, *self.results):
            if resource.spacing > 1:
                raise ValueError(f"{resource.name}: expected a resource that is kept on the host to have every pixel")

    @cached_property
    def past(self) -> dict[Resource, tuple[Quantity, ...]]:
        """The quantities that passes read of the previous frame, by resource."""
        found: dict[Resource, dict[Quantity, None]] = {}
        for entry in self.pipeline.passes:
            for each in self.pipeline.past_of(entry):
                found.setdefault(each.resource, {}).update(dict.fromkeys(use.quantity for use in each.uses))
        return {resource: tuple(quantities) for resource, quantities in found.items()}

    @cached_property
    def results(self) -> dict[Resource, tuple[Quantity, ...]]:
        """The quantities that are written only to be shown: no pass reads them or reuses their memory."""
        last = {slot.buffers[-1] for slot in self.slots}
        return {each: each.quantities for each in self.pipeline.unread if Buffer(each) in last}

    @cached_property
    def margin(self) -> int:
        """Pixels around the kept part of a tile that are computed too."""
        return widest_margin(self.pipeline)

    @property
    def unit(self) -> int:
        """Windows begin at multiples of this many pixels."""
        return WIDEST_VECTOR * max(entry.coarse_spacing for entry in self.pipeline.passes)

    def past_window(self, window: Shape) -> Shape:
        """Return the shape of a window on the previous frame."""
        height, width = (min(side, most + 2 * SLACK) for side, most in zip(self.shape, window, strict=True))
        return height, width

    def layout(self, shape: Shape) -> Layout:
        """Return the layout of an image of this shape."""
        return Layout(*shape, self.row_alignment)

    @cached_property
    def slots(self) -> list[Slot]:
        """The memory of all buffers except those of the previous frame."""
        left = [(slot, [each for each in slot.buffers if not each.previous]) for slot in memory_slots(self.pipeline)]
        return [replace(slot, buffers=buffers) for slot, buffers in left if buffers]

    @property
    def past_slots(self) -> list[Slot]:
        """The memory of the previous frame's buffers."""
        return [Slot([history_of(resource)], resource.planes, 0) for resource in self.past]

    def sizes(self, window: Shape) -> list[int]:
        """Return the bytes of every buffer on the device for windows of this shape."""
        parts = ((self.layout(window), self.slots), (self.layout(self.past_window(window)), self.past_slots))
        own = [size for layout, slots in parts for size in Memory(layout, slots).sizes]
        user = self.pipeline.user_nbytes
        copied = [*user.values(), user.get("motion", 0)]  # motion twice: it may lead into several windows
        return own + [nbytes * window[0] * window[1] for nbytes in copied]

    def whole(self) -> list[int]:
        """Return the bytes of every buffer on the device for whole frames, without tiles."""
        own = Memory(self.layout(self.shape), memory_slots(self.pipeline)).sizes
        return [*own] + [nbytes * self.shape[0] * self.shape[1] for nbytes in self.pipeline.user_nbytes.values()]

    def indexable(self, window: Shape) -> bool:
        """Whether the kernels' indices reach all pixels of the largest buffer."""
        return self.layout(self.past_window(window)).indexable(self.pipeline.widest)

    def window(self, total: int, largest: int) -> Shape | None:
        """Return the best window shape for `total` bytes in all and `largest` in one buffer; None if none fits."""

        def fits(window: Shape) -> bool:
            sizes = self.sizes(window)
            return sum(sizes) <= total and max(sizes) <= largest and self.indexable(window)

        return best_window(self.shape, self.margin, self.unit, fits)

    def least(self) -> int:
        """Return the bytes of all buffers for the smallest windows."""
        height, width = (window_lengths(side, self.margin, self.unit)[-1] for side in self.shape)
        return sum(self.sizes((height, width)))

    def tiles(self, window: Shape) -> list[Tile]:
        """Return the tiles, row by row."""
        return tiles_of(self.shape, window, self.margin, self.unit)

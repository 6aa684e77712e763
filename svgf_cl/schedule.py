"""`Schedule`: a pipeline for frames of one size, as launches and memory, the same for all devices.

`svgf_cl.plan.Plan` runs it, and `svgf_cl.export` writes it to files for hosts in other languages.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from svgf_cl.device.launch import Grid, scalar_arguments
from svgf_cl.device.layout import HALO, Layout, rounded_up
from svgf_cl.device.memory import Memory
from svgf_cl.device.memory_plan import memory_slots
from svgf_cl.device.programs import Define
from svgf_cl.device.tuning import Tuning
from svgf_cl.filters.pipeline import OUT, PAST, Buffer, Pass, Pipeline
from svgf_cl.frame import CHANNELS, element_type

# The offset of a whole frame's pixels in the previous frame.
IN_PLACE: Mapping[str, int] = dict.fromkeys(PAST, 0)


@dataclass(frozen=True)
class ArrayType:
    """The shape and type of an array of the user, which is in C order from its buffer's first byte."""

    shape: tuple[int, ...]
    dtype: np.dtype[np.generic]


@dataclass(frozen=True, eq=False)
class ScheduledPass:
    """A pass of a schedule.

    Parameters
    ----------
    entry : Pass
    sizes : mapping of str to (4,) int32
        Arguments that are layouts, by the kernel's names.
    work_items : (int, int)
        Number of vectors along a row, and number of rows; on a device both are rounded up to whole work-groups.
    """

    entry: Pass
    sizes: Mapping[str, np.ndarray]
    work_items: Grid

    @property
    def values(self) -> dict[str, np.ndarray | np.generic]:
        """Arguments that stay the same from frame to frame and are no buffers, by the kernel's names."""
        return {**self.sizes, **scalar_arguments(self.entry)}

    @property
    def own(self) -> dict[str, Buffer]:
        """Arguments that are the denoiser's buffers."""
        return {each.argument: each.of for each in self.entry.accesses if isinstance(each.of, Buffer)}

    @property
    def user(self) -> dict[str, str]:
        """Arguments that are the user's arrays."""
        return {each.argument: each.of for each in self.entry.accesses if isinstance(each.of, str)}


@dataclass(frozen=True, eq=False)
class Schedule:
    """A pipeline for frames of one size.

    Parameters
    ----------
    pipeline : Pipeline
    layout : Layout
    tuning : Tuning
    past : Layout, optional
        Layout of the previous frame's buffers, if it differs from that of the others.

    Raises
    ------
    ValueError
        If a pass reads farther from a pixel than the halo reaches.
    """

    pipeline: Pipeline
    layout: Layout
    tuning: Tuning
    past: Layout | None = None

    def __post_init__(self) -> None:
        if self.pipeline.reach > HALO:
            raise ValueError(f"expected taps within the halo of {HALO} pixels, got some {self.pipeline.reach} away")

    @property
    def defines(self) -> dict[str, Define]:
        """The macros of all kernels."""
        return {**self.tuning.defines, **self.pipeline.defines}

    @cached_property
    def memory(self) -> Memory:
        """The memory of all buffers of whole frames."""
        return Memory(self.layout, memory_slots(self.pipeline))

    @cached_property
    def arrays(self) -> dict[str, ArrayType]:
        """The user's arrays by name: those that are read, and then `OUT`."""
        channels = {
            each.of: each.uses[0].quantity.channels
            for scheduled in self.passes
            for each in scheduled.entry.accesses
            if isinstance(each.of, str)
        }
        return {name: self._array(name, channels[name]) for name in (*self.pipeline.fields, OUT)}

    @cached_property
    def passes(self) -> tuple[ScheduledPass, ...]:
        """The passes, in order."""
        return tuple(map(self._scheduled, self.pipeline.passes))

    def _array(self, name: str, channels: int) -> ArrayType:
        plain = CHANNELS.get(name) == (0,)
        shape = self.layout.height, self.layout.width, *(() if plain else (channels,))
        return ArrayType(shape, np.dtype(element_type(name)))

    def _scheduled(self, entry: Pass) -> ScheduledPass:
        layouts = {
            "size": self.layout,
            "coarse_size": self.layout.every(entry.coarse_spacing),
            "past_size": self.past or self.layout,
        }
        written = self.layout.every(entry.spacing)
        work_items = written.vectors(self.tuning.vector_width, entry.row_step)
        return ScheduledPass(entry, {name: layouts[name].size for name in entry.sizes}, work_items)


def whole_groups(work_items: Grid, work_group: Grid) -> Grid:
    """Return the work-items, rounded up to whole work-groups; kernels skip those outside the image."""
    return rounded_up(work_items[0], work_group[0]), rounded_up(work_items[1], work_group[1])

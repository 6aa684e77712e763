"""A kernel launch that is made ready once, so that it costs the host next to nothing in every frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pyopencl as cl

from svgf_cl.filters.pipeline import Pass

Grid = tuple[int, int]


class Launch:
    """A kernel that keeps its arguments, but for the user's arrays.

    Parameters
    ----------
    entry : Pass
        What is launched.
    kernel : pyopencl.Kernel
        For this launch alone.
    arguments : sequence
        The kernel's, in order. A string is the name of one of the user's arrays.
    work_items, work_group : (int, int)
        Along a row and down.
    """

    def __init__(
        self, entry: Pass, kernel: cl.Kernel, arguments: Sequence[Any], work_items: Grid, work_group: Grid
    ) -> None:
        self.entry = entry
        self._kernel = kernel
        self._grid = work_items, work_group
        self._user = [(index, value) for index, value in enumerate(arguments) if isinstance(value, str)]
        for index, value in enumerate(arguments):
            if not isinstance(value, str):
                kernel.set_arg(index, value)

    def enqueue(self, queue: cl.CommandQueue, user: Mapping[str, cl.Buffer]) -> cl.Event:
        """Put the kernel on the queue, to work on these arrays of the user."""
        for index, name in self._user:
            self._kernel.set_arg(index, user[name])
        return cl.enqueue_nd_range_kernel(queue, self._kernel, *self._grid)

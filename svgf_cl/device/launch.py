"""A kernel launch that is prepared once, so that it takes the host almost no time in each frame."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Integral

import numpy as np
import pyopencl as cl

from svgf_cl.filters.pipeline import FRAME_SCALARS, Pass

Grid = tuple[int, int]
Argument = np.ndarray | np.generic | cl.Buffer


class Launch:
    """A kernel whose arguments are set once, except the user's arrays and the numbers that change with the frame.

    Parameters
    ----------
    entry : Pass
        The pass to launch.
    kernel : pyopencl.Kernel
        No other launch may use it.
    fixed : mapping of str to argument
        The arguments that do not change from frame to frame, by the kernel's names. All others come with every frame.
    work_items, work_group : (int, int)
        Numbers along a row and down.
    """

    def __init__(
        self, entry: Pass, kernel: cl.Kernel, fixed: Mapping[str, Argument], work_items: Grid, work_group: Grid
    ) -> None:
        self.entry = entry
        self._kernel = kernel
        self._grid = work_items, work_group
        self._fixed = fixed  # a kernel does not keep the memory of its arguments
        self._index = {name: index for index, name in enumerate(entry.arguments)}
        self._user = {each.argument: each.of for each in entry.accesses if isinstance(each.of, str)}
        for name, value in fixed.items():
            kernel.set_arg(self._index[name], value)

    def set_scalars(self, entry: Pass) -> None:
        """Set the scalar arguments to those of `entry`, a pass that differs only in them."""
        for name, value in scalar_arguments(entry).items():
            self._kernel.set_arg(self._index[name], value)

    def enqueue(self, queue: cl.CommandQueue, user: Mapping[str, cl.Buffer], frame: Mapping[str, int]) -> cl.Event:
        """Put the kernel on the queue, with the user's arrays and the numbers of this frame."""
        for argument, name in self._user.items():
            self._kernel.set_arg(self._index[argument], user[name])
        for name in self.entry.per_frame:
            self._kernel.set_arg(self._index[name], FRAME_SCALARS[name](frame[name]))
        return cl.enqueue_nd_range_kernel(queue, self._kernel, *self._grid)


def scalar_arguments(entry: Pass) -> dict[str, np.generic]:
    """Return a pass's scalars in the types that kernels take."""
    return {name: np.int32(n) if isinstance(n, Integral) else np.float32(n) for name, n in entry.scalars.items()}

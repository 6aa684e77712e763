"""`Window`: the data and display windows of OpenEXR files, which say where their pixels lie on the picture."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

Number = TypeVar("Number", bound=np.generic)


class Window(NamedTuple):
    """A rectangle of pixels; x and y are its upper left pixel, in the coordinates that all windows of a shot share."""

    x: int
    y: int
    width: int
    height: int

    def __str__(self) -> str:
        """Return a text such as 160x64 at 8,0."""
        return f"{self.width}x{self.height} at {self.x},{self.y}"

    @property
    def area(self) -> int:
        """Number of pixels."""
        return self.width * self.height


def union(windows: Iterable[Window]) -> Window:
    """Return the smallest window that contains all `windows`."""
    boxes = np.array([(w.x, w.y, w.x + w.width, w.y + w.height) for w in windows])
    (left, top), (right, bottom) = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
    return Window(left, top, right - left, bottom - top)


def placed(plane: npt.NDArray[Number], have: Window, want: Window, outside: float) -> npt.NDArray[Number]:
    """Cut or extend an array from one window to another.

    Parameters
    ----------
    plane : (H, W) or (H, W, C) array
        The pixels of window `have`.
    have, want : Window
    outside : float
        The value of pixels of `want` that are not in `have`.
    """
    if have == want:
        return plane
    result = np.full((want.height, want.width, *plane.shape[2:]), outside, plane.dtype)
    left, top = max(have.x, want.x), max(have.y, want.y)
    right = min(have.x + have.width, want.x + want.width)
    bottom = min(have.y + have.height, want.y + want.height)
    if left < right and top < bottom:
        common = plane[top - have.y : bottom - have.y, left - have.x : right - have.x]
        result[top - want.y : bottom - want.y, left - want.x : right - want.x] = common
    return result

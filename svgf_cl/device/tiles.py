"""Cuts an image into tiles: windows of one size, each with a part that is kept and a margin around it.

All windows have the same shape, so that kernels and memory are prepared once. They begin at whole vectors of the
coarsest buffer's pixels. All lie inside the image: a window at the image's border ends there, so that the kernels treat
the border as they do in a whole image.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

from svgf_cl.frame import Shape


@dataclass(frozen=True)
class Span:
    """A tile along one axis, in pixels of the image.

    Parameters
    ----------
    origin, length : int
        Begin and length of the window that is computed.
    begin, end : int
        Begin and end of the part that is kept; the kept parts of all tiles make up the image.
    """

    origin: int
    length: int
    begin: int
    end: int

    @property
    def window(self) -> slice:
        """The part of the image that is computed."""
        return slice(self.origin, self.origin + self.length)

    @property
    def kept(self) -> slice:
        """The part of the image that is kept."""
        return slice(self.begin, self.end)

    def around(self, margin: int) -> slice:
        """Return the part of the window that is kept, with `margin` pixels around it."""
        begin, end = self.begin - margin - self.origin, self.end + margin - self.origin
        return slice(max(begin, 0), min(end, self.length))


@dataclass(frozen=True)
class Tile:
    """A window of the image, and the part of it that is kept."""

    rows: Span
    columns: Span

    @property
    def window(self) -> tuple[slice, slice]:
        """Rows and columns of the image that are computed."""
        return self.rows.window, self.columns.window

    @property
    def kept(self) -> tuple[slice, slice]:
        """Rows and columns of the image that are kept."""
        return self.rows.kept, self.columns.kept

    @property
    def origin(self) -> tuple[int, int]:
        """First row and column of the window."""
        return self.rows.origin, self.columns.origin

    def around(self, margin: int = 0) -> tuple[slice, slice]:
        """Return the rows and columns of the window that are kept, with `margin` pixels around them."""
        return self.rows.around(margin), self.columns.around(margin)


def spans(length: int, window: int, margin: int, unit: int) -> list[Span]:
    """Return the tiles along an axis of `length` pixels: windows of `window` pixels that begin at multiples of `unit`.

    `window` is one of `window_lengths`.
    """
    found, begin = [], 0
    for number in range(count(length, window, margin, unit)):
        origin = min(number * stride(window, margin, unit), length - window)
        is_last = origin + window == length
        found.append(Span(origin, window, begin, length if is_last else origin + window - margin))
        begin = found[-1].end
    return found


def count(length: int, window: int, margin: int, unit: int) -> int:
    """Return how many windows an axis of `length` pixels takes."""
    return 1 if window == length else 1 - (window - length) // stride(window, margin, unit)


def stride(window: int, margin: int, unit: int) -> int:
    """Return the pixels from one window to the next. The kept parts of neighbouring windows leave no gap."""
    return (window - 2 * margin) // unit * unit


def window_lengths(length: int, margin: int, unit: int) -> list[int]:
    """Return, for each possible number of windows along an axis, the least length of a window; the longest first."""
    least = {1: length}
    for window in range(length - unit, 0, -unit):  # then the last window begins at a multiple of `unit` as well
        if stride(window, margin, unit) < unit:
            break
        least[count(length, window, margin, unit)] = window
    return list(least.values())


def best_window(shape: Shape, margin: int, unit: int, fits: Callable[[Shape], bool]) -> Shape | None:
    """Return the window shape with the fewest pixels to compute among those that fit; None if none fits."""
    height, width = shape

    def work(window: Shape) -> int:
        return count(height, window[0], margin, unit) * count(width, window[1], margin, unit) * window[0] * window[1]

    choices = product(window_lengths(height, margin, unit), window_lengths(width, margin, unit))
    return next((window for window in sorted(choices, key=work) if fits(window)), None)


def tiles_of(shape: Shape, window: Shape, margin: int, unit: int) -> list[Tile]:
    """Return the tiles of an image, row by row."""
    rows, columns = (spans(*each, margin, unit) for each in zip(shape, window, strict=True))
    return [Tile(*each) for each in product(rows, columns)]

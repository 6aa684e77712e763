"""How an image is cut into tiles: windows of one size, of which each has a part that is right, and a margin around it.

All windows have the same shape, so that kernels and memory are made ready once. They begin at whole vectors of the
coarsest buffer's pixels, and all lie inside the image: one at its border ends there, so that what lies outside of the
image lies outside of the window too.
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
        Of the window that is worked on.
    begin, end : int
        Of the part whose pixels are kept; the parts of all tiles make up the image.
    """

    origin: int
    length: int
    begin: int
    end: int

    @property
    def window(self) -> slice:
        """Of the image: what is worked on."""
        return slice(self.origin, self.origin + self.length)

    @property
    def kept(self) -> slice:
        """Of the image: what is kept."""
        return slice(self.begin, self.end)

    def around(self, margin: int) -> slice:
        """Of the window: what is kept, and so many pixels around it."""
        begin, end = self.begin - margin - self.origin, self.end + margin - self.origin
        return slice(max(begin, 0), min(end, self.length))


@dataclass(frozen=True)
class Tile:
    """A window on the image, and the part of it that is kept."""

    rows: Span
    columns: Span

    @property
    def window(self) -> tuple[slice, slice]:
        """Rows and columns of the image that are worked on."""
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
        """Rows and columns of the window that are kept, and so many pixels around them."""
        return self.rows.around(margin), self.columns.around(margin)


def spans(length: int, window: int, margin: int, unit: int) -> list[Span]:
    """The tiles along an axis of `length` pixels, by windows of `window` pixels that begin at multiples of `unit`.

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
    """How many windows it takes."""
    return 1 if window == length else 1 - (window - length) // stride(window, margin, unit)


def stride(window: int, margin: int, unit: int) -> int:
    """Pixels from one window to the next: each begins where the one before has its margin, or earlier."""
    return (window - 2 * margin) // unit * unit


def window_lengths(length: int, margin: int, unit: int) -> list[int]:
    """The least length of a window for each number of them that an axis may be cut into, the longest first."""
    least = {1: length}
    for window in range(length - unit, 0, -unit):  # the last one then begins at a multiple of `unit` as well
        if stride(window, margin, unit) < unit:
            break
        least[count(length, window, margin, unit)] = window
    return list(least.values())


def best_window(shape: Shape, margin: int, unit: int, fits: Callable[[Shape], bool]) -> Shape | None:
    """The shape of windows with the least work of all that fit; None where none does."""
    height, width = shape

    def work(window: Shape) -> int:
        return count(height, window[0], margin, unit) * count(width, window[1], margin, unit) * window[0] * window[1]

    choices = product(window_lengths(height, margin, unit), window_lengths(width, margin, unit))
    return next((window for window in sorted(choices, key=work) if fits(window)), None)


def tiles_of(shape: Shape, window: Shape, margin: int, unit: int) -> list[Tile]:
    """The tiles of an image, row by row."""
    rows, columns = (spans(*each, margin, unit) for each in zip(shape, window, strict=True))
    return [Tile(*each) for each in product(rows, columns)]

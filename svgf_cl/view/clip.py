"""The frames that are played, each with its reference if there is one."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from svgf_cl.compare.recorded import with_color
from svgf_cl.errors import SvgfError
from svgf_cl.frame import CARRIED, Frame, Shape, extent
from svgf_cl.io.shot import Light
from svgf_cl.prefilter import Effort

Picture = npt.NDArray[np.float32]

MEMORY = 4 * 2**30  # bytes, for all frames of a rendered clip


@dataclass(frozen=True, eq=False)
class Item:
    """One frame of a clip.

    Parameters
    ----------
    frame : Frame
    lights : tuple of Light
        The light passes that add up to the picture; empty if they are not known.
    reference : (H, W, 3) float32, optional
        The picture without noise.
    """

    frame: Frame
    lights: tuple[Light, ...] = ()
    reference: Picture | None = None

    @property
    def noisy(self) -> Picture:
        """The picture as it was rendered, (H, W, 3)."""
        return np.asarray(with_color(self.frame).color[..., :3], np.float32)

    @property
    def nbytes(self) -> int:
        """Bytes of memory that it needs."""
        arrays = [*self.frame.present().values(), self.reference]
        arrays += [array for light in self.lights for array in (light.radiance, light.factor)]
        return sum(array.nbytes for array in arrays if array is not None)


def without_carried(frame: Frame) -> Frame:
    """The frame without the fields that no filter reads, to save memory."""
    return replace(frame, **dict.fromkeys(CARRIED))


class Clip(Protocol):
    """Frames by their index.

    Attributes
    ----------
    name, note : str
        What is shown, and how it was made, as text for the page.
    shape : (int, int)
        (height, width) of all frames.
    numbers : sequence of int
        The frames' numbers, as in the files' names.
    cuts : collection of int
        Indices of the frames that do not follow the previous frame, and so begin without history.
    has_references : bool
        Whether any frame has a reference.
    prefilter : {"auto", "on", "off"}
        Which guides are filtered, as in `Method`.
    """

    @property
    def name(self) -> str: ...  # noqa: D102  # described above, as are all
    @property
    def note(self) -> str: ...  # noqa: D102
    @property
    def shape(self) -> Shape: ...  # noqa: D102
    @property
    def numbers(self) -> Sequence[int]: ...  # noqa: D102
    @property
    def cuts(self) -> Collection[int]: ...  # noqa: D102
    @property
    def has_references(self) -> bool: ...  # noqa: D102
    @property
    def prefilter(self) -> Effort: ...  # noqa: D102

    def read(self, index: int) -> Item:
        """One frame; `SvgfError` if it cannot be read."""

    def beginning(self) -> tuple[Item, Item]:
        """The first two frames, which show which fields the clip has; the first one twice if there is only one."""


class RenderedClip:
    """A clip that is rendered while it is played for the first time. Its frames stay in memory for playing it again.

    Parameters
    ----------
    name, note : str
        As in `Clip`.
    shape : (int, int)
        (height, width) of all frames.
    count : int
        How many frames there are.
    items : iterator of Item
        The frames in order.
    has_references : bool
        Whether they have references.
    """

    cuts: Collection[int] = ()
    prefilter: Effort = "off"  # the rendered guides have no noise

    def __init__(
        self, name: str, note: str, shape: Shape, count: int, items: Iterator[Item], *, has_references: bool
    ) -> None:
        self.name, self.note, self.shape, self.has_references = name, note, shape, has_references
        self.numbers = range(count)
        self._items = items
        self._rendered: list[Item] = []

    def read(self, index: int) -> Item:
        """One frame; earlier frames are rendered first.

        Raises
        ------
        SvgfError
            If a frame cannot be rendered, or if all frames would need more than `MEMORY`.
        """
        while len(self._rendered) <= index:
            item = next(self._items, None)
            if item is None:
                raise SvgfError("rendering broke off at an earlier frame; start svgf-cl view again")
            item = replace(item, frame=without_carried(item.frame))
            self._check_memory(item)
            self._rendered.append(item)
        return self._rendered[index]

    def beginning(self) -> tuple[Item, Item]:
        """The first two frames, as in `Clip`."""
        return self.read(0), self.read(min(1, len(self.numbers) - 1))

    def _check_memory(self, item: Item) -> None:
        """Raise `SvgfError` if all frames of this size would need too much memory."""
        if item.nbytes * len(self.numbers) > MEMORY:
            raise SvgfError(
                f"--frames: expected at most {MEMORY // item.nbytes} frames of {extent(self.shape)} pixels, which stay"
                f" in {MEMORY >> 30} GiB of memory, got {len(self.numbers)}; render them to files with svgf-cl render"
            )

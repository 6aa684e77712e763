"""What is played: the frames of a clip, each with the picture that it converges to, where that is known."""

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

MEMORY = 4 * 2**30  # bytes, for all frames of a clip that is rendered


@dataclass(frozen=True, eq=False)
class Item:
    """One frame of a clip.

    Parameters
    ----------
    frame : Frame
    lights : tuple of Light
        What the picture is the sum of; none where that is not known.
    reference : (H, W, 3) float32, optional
        What it converges to.
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
        """How much memory it takes."""
        arrays = [*self.frame.present().values(), self.reference]
        arrays += [array for light in self.lights for array in (light.radiance, light.factor)]
        return sum(array.nbytes for array in arrays if array is not None)


def without_carried(frame: Frame) -> Frame:
    """The frame without the fields that no filter reads, which would take memory."""
    return replace(frame, **dict.fromkeys(CARRIED))


class Clip(Protocol):
    """Frames by their index.

    Attributes
    ----------
    name, note : str
        What is shown, and how it was made.
    shape : (int, int)
        (height, width) of all frames.
    numbers : sequence of int
        Of the frames, as files have them.
    cuts : collection of int
        Indices of the frames that do not follow on the one before them.
    has_references : bool
        Whether any frame has a reference.
    prefilter : {"auto", "on", "off"}
        Which guides are filtered, as `Method` has it.
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
        """One frame; `SvgfError` where it cannot be had."""

    def beginning(self) -> tuple[Item, Item]:
        """The first two frames, which tell what holds for all; the first one twice if there is no other."""


class RenderedClip:
    """A clip that is rendered while it is first played. Its frames stay in memory, for it is played again and again.

    Parameters
    ----------
    name, note : str
        As of `Clip`.
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
    prefilter: Effort = "off"  # its guides have no noise

    def __init__(
        self, name: str, note: str, shape: Shape, count: int, items: Iterator[Item], *, has_references: bool
    ) -> None:
        self.name, self.note, self.shape, self.has_references = name, note, shape, has_references
        self.numbers = range(count)
        self._items = items
        self._rendered: list[Item] = []

    def read(self, index: int) -> Item:
        """One frame; those before it are rendered first.

        Raises
        ------
        SvgfError
            Where a frame cannot be rendered, or all of them would need more than `MEMORY`.
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
        """The first two frames, as of `Clip`."""
        return self.read(0), self.read(min(1, len(self.numbers) - 1))

    def _check_memory(self, item: Item) -> None:
        """Raise `SvgfError` where all frames are too many, by the size of one."""
        if item.nbytes * len(self.numbers) > MEMORY:
            raise SvgfError(
                f"--frames: expected at most {MEMORY // item.nbytes} frames of {extent(self.shape)} pixels, which stay"
                f" in {MEMORY >> 30} GiB of memory, got {len(self.numbers)}; render them to files with svgf-cl render"
            )

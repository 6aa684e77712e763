"""Clips of scenes, which an installed package renders, and of a room that needs no other package."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from svgf_cl.compare.footage import Choice, Footage, opener
from svgf_cl.frame import Shape
from svgf_cl.io.synthetic import LIGHT, room_frames
from svgf_cl.view.clip import Item, Picture, RenderedClip

ROOM_FRAMES = 32
ALL = 1_000_000  # frames, more than any scene has


def room(shape: Shape, count: int | None) -> RenderedClip:
    """The clip of a tiled room in even light; its references are exact."""
    count = count or ROOM_FRAMES
    frames = room_frames(shape, count)
    items = (Item(frame, reference=np.float32(LIGHT) * frame.albedo) for frame in frames)
    return RenderedClip("room", "1 sample per pixel, exact reference", shape, count, items, has_references=True)


def open_footage(name: str, shape: Shape, count: int | None, spp: int | None, *, jitter: bool) -> Footage:
    """Open a scene by its name, folder or file.

    Parameters
    ----------
    name : str
    shape : (int, int)
    count : int, optional
        Number of frames; by default, as many as the scene needs.
    spp : int, optional
        Samples per pixel of the references; without it there are no references.
    jitter : bool
        Whether rays go through a different point of the pixel in each frame; references are then means over the pixel.

    Raises
    ------
    SvgfError
        If no package renders scenes here, or there is no such scene.
    """
    return opener()(name, Choice(shape, count, ALL, spp or 2, jitter=jitter))


def scene(footage: Footage, *, has_references: bool, advance: Callable[[], None]) -> RenderedClip:
    """The clip of a scene; references that are not stored from an earlier run are rendered first.

    While references are rendered, `advance` is called ``footage.steps`` times.
    """
    truths = dict(truths_of(footage, advance)) if has_references else {}
    rays = "rays move within the pixel" if footage.jitter else "rays go through pixel centres"
    note = footage.note if has_references else f"1 sample per pixel, {rays}; no reference"
    return RenderedClip(
        footage.name, note, footage.shape, len(footage.numbers), items(footage, truths), has_references=has_references
    )


def truths_of(footage: Footage, advance: Callable[[], None]) -> Iterator[tuple[int, Picture]]:
    """The number and the reference of each frame; the reference is the mean of the two halves."""
    for number, (first, second) in footage.truths(advance).items():
        yield number, np.asarray(0.5 * (first + second), np.float32)


def items(footage: Footage, truths: Mapping[int, Picture]) -> Iterator[Item]:
    """Render the frames of a scene one by one."""
    for number, frame in zip(footage.numbers, footage.frames(), strict=True):
        yield Item(frame, reference=truths.get(number))

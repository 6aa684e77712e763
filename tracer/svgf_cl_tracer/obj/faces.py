"""The faces of an OBJ file: the indices at their corners."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError

from .text import Indices, Lines, parsed, uncommented

# The index of a corner without texture coordinates or without a normal.
ABSENT = -1
# Used instead while the text is read, because -1 means the last element there.
BLANK = np.iinfo(np.int64).min

CORNER = re.compile(r"[+-]?\d+(/([+-]?\d+)?){0,2}")

# The elements to which the three indices of a corner refer.
KINDS = ("v", "vt", "vn")


class Faces(NamedTuple):
    """Faces as arrays: the number of corners and the line of each face, and three indices from 0 for each corner.

    Shapes: `counts` and `lines` (F,); `corners` (C, 3), indices of positions, texture coordinates and normals, or
    `ABSENT`.
    """

    counts: Indices
    lines: Indices
    corners: Indices

    @classmethod
    def read(cls, faces: Lines, elements: tuple[Lines, Lines, Lines]) -> Faces:
        """Read the lines of faces; `elements` are the lines of the elements to which they refer.

        Raises
        ------
        SceneError
            If a line has something other than corners, or there is no element with an index.
        """
        text, starts, counts = faces.words()
        try:
            given = _numbers(text, starts)
        except ValueError as error:
            raise SceneError(_complaint(faces)) from error
        lines = np.array(faces.numbers, np.int64)
        line_of = lines.repeat(counts)
        corners = np.full(given.shape, ABSENT)
        for column, element in enumerate(elements):
            number, there = given[:, column], len(element.numbers)
            index = np.where(number < 0, element.in_force(lines).repeat(counts) + number, number - 1)
            wrong = (number == 0) | (index < 0) | (index >= there)
            if column:
                wrong &= number != BLANK
            if wrong.any():
                first = int(wrong.argmax())
                raise SceneError(
                    f"line {line_of[first]}: expected a number in 1..{there} of a line {KINDS[column]}, or one below 0 "
                    f"of a line above, found {number[first]}"
                )
            corners[:, column] = np.where(number == BLANK, ABSENT, index)
        return cls(counts, lines, corners)

    def with_area(self) -> Faces:
        """The faces with three corners or more."""
        kept = self.counts >= 3
        return Faces(self.counts[kept], self.lines[kept], self.corners[kept.repeat(self.counts)])


def _numbers(text: bytes, starts: Indices) -> Indices:
    """The numbers (C, 3) of corners such as ``1``, ``1/2``, ``1//3`` and ``1/2/3``; `BLANK` for a missing number."""
    places = np.flatnonzero(np.frombuffer(text, np.uint8) == ord("/"))
    slashes = np.bincount(np.searchsorted(starts, places, "right") - 1, minlength=len(starts))
    if slashes.max(initial=0) > 2:
        raise ValueError("a corner of more than three numbers")
    if len(places):
        blank = b"/%d" % BLANK
        text = re.sub(rb"/(?=[/\s])", blank, text).replace(b"/", b" ")
    given = np.arange(3) <= slashes[:, None]
    numbers = np.full(given.shape, BLANK)
    numbers[given] = parsed(text, given.sum(), np.int64)
    return numbers


def _complaint(faces: Lines) -> str:
    """What is wrong in the first line that does not consist of corners."""
    for line, text in zip(faces.numbers, faces.texts, strict=True):
        for word in uncommented(text).split():
            if not CORNER.fullmatch(word):
                return f"line {line}: expected corners such as 1, 1/2, 1//3 or 1/2/3, found {shown(word)}"
    return "expected corners of faces, found something else"

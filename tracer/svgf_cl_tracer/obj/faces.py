"""The faces of an OBJ file: whose corners they have, and what each belongs to."""

from __future__ import annotations

from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError

from .text import Lines, uncommented

Indices = NDArray[np.int64]

# Where a corner names no texture coordinates or no normal.
ABSENT = -1
# In its place while the text is read, where any number that a file may hold has a meaning.
BLANK = np.iinfo(np.int64).min

# What the numbers of a corner are indices of.
KINDS = ("v", "vt", "vn")


class Faces(NamedTuple):
    """Faces as arrays: of each the number of its corners and its line; of each corner three indices from 0.

    Shapes: `counts` and `lines` (F,); `corners` (C, 3), into positions, texture coordinates and normals, or `ABSENT`.
    """

    counts: Indices
    lines: Indices
    corners: Indices

    @classmethod
    def read(cls, faces: Lines, elements: tuple[Lines, Lines, Lines]) -> Faces:
        """Read the lines of faces; `elements` are those of what they name.

        Raises
        ------
        SceneError
            Something else than indices is on a line, or there is nothing with such an index.
        """
        rows = [uncommented(text).split() for text in faces.texts]
        counts = np.fromiter(map(len, rows), np.int64, len(rows))
        lines = np.array(faces.numbers, np.int64)
        words = list(chain.from_iterable(rows))
        numbers = _numbers(words, lines.repeat(counts))
        corners = np.full(numbers.shape, ABSENT)
        for column, (kind, element) in enumerate(zip(KINDS, elements, strict=True)):
            before = element.in_force(lines).repeat(counts)
            given = numbers[:, column]
            index = np.where(given < 0, before + given, given - 1)
            blank = given == BLANK
            wrong = ~blank & ((given == 0) | (index < 0) | (index >= len(element.numbers)))
            wrong |= blank & (kind == "v")
            if wrong.any():
                first = int(wrong.argmax())
                line = lines.repeat(counts)[first]
                raise SceneError(
                    f"line {line}: expected the number of one of {len(element.numbers)} lines {kind} "
                    f"from 1 or, backwards, -1 on, found {given[first]}"
                )
            corners[:, column] = np.where(blank, ABSENT, index)
        return cls(counts, lines, corners)

    def with_area(self) -> Faces:
        """Those of three corners or more."""
        kept = self.counts >= 3
        return Faces(self.counts[kept], self.lines[kept], self.corners[kept.repeat(self.counts)])


def _numbers(words: list[str], lines: Indices) -> Indices:
    """The numbers (C, 3) of corners such as ``1``, ``1/2``, ``1//3`` and ``1/2/3``; `BLANK` where there is none."""
    slashes = np.fromiter((word.count("/") for word in words), np.int64, len(words))
    text = " ".join(words) + " "
    if slashes.max(initial=0) > 2:
        raise SceneError(_complaint(words, lines))
    if slashes.any():
        text = text.replace("//", f"/{BLANK}/").replace("/ ", f"/{BLANK} ").replace("/", " ")
    given = np.arange(3) <= slashes[:, None]
    numbers = np.full(given.shape, BLANK)
    try:
        numbers[given] = np.fromiter(map(int, text.split()), np.int64)
    except (ValueError, OverflowError) as error:
        raise SceneError(_complaint(words, lines)) from error
    return numbers


def _complaint(words: list[str], lines: Indices) -> str:
    """What is wrong with the first of `words` that is no corner."""
    for word, line in zip(words, lines, strict=True):
        parts = word.split("/")
        try:
            good = len(parts) <= 3 and all(abs(int(part)) < -BLANK for part in parts if part) and parts[0]
        except ValueError:
            good = False
        if not good:
            return f"line {line}: expected corners such as 1, 1/2, 1//3 or 1/2/3, found {shown(word)}"
    return "expected corners of faces, found something else"

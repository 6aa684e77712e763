"""The text that OBJ and MTL files are made of: lines, each a keyword and what follows it."""

from __future__ import annotations

import codecs
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.vectors import Float64

BYTE_ORDER_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}


@dataclass
class Lines:
    """Lines with the same keyword: their numbers in the file, from 1 and ascending, and what follows the keyword."""

    numbers: list[int] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    def table(self, least: int, most: int, *, finite: bool = True) -> Float64:
        """The first numbers of each line (lines, most), NaN where a line has fewer.

        Raises
        ------
        SceneError
            A line has fewer than `least` numbers, something else, or what is not `finite`.
        """
        rows = [uncommented(text).split()[:most] for text in self.texts]
        counts = np.fromiter(map(len, rows), np.int64, len(rows))
        try:
            flat = np.fromiter(map(float, chain.from_iterable(rows)), np.float64, counts.sum())
        except ValueError:
            for line, row in zip(self.numbers, rows, strict=True):
                floats(row, line)
            raise
        given = np.arange(most) < counts[:, None]
        table = np.full(given.shape, np.nan)
        table[given] = flat
        wrong = counts < least
        if finite:
            wrong |= (~np.isfinite(table) & given).any(1)
        if wrong.any():
            first = int(wrong.argmax())
            expected = f"{least} finite numbers" if finite else f"{least} numbers"
            raise SceneError(f"line {self.numbers[first]}: expected {expected}, found {shown(self.texts[first])}")
        return table

    def words(self) -> list[str]:
        """What follows the keyword on each line, without comments."""
        return [uncommented(text).strip() for text in self.texts]

    def in_force(self, lines: NDArray[np.int64]) -> NDArray[np.int64]:
        """How many of these lines stand above each of `lines`, numbers in the file: the last of them counts there."""
        return np.searchsorted(self.numbers, lines)


NONE = Lines()


def read_text(path: Path) -> str:
    """The text of a file: UTF-8 or UTF-16 where it says so or is such, else Latin-1, with lines that end alike.

    Raises
    ------
    SceneError
        It is no text.
    """
    data = path.read_bytes()
    marked = next((encoding for mark, encoding in BYTE_ORDER_MARKS.items() if data.startswith(mark)), None)
    try:
        text = data.decode(marked or "utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise SceneError("expected a text, found zeros in it")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def statements(text: str) -> Iterator[tuple[int, str, str]]:
    """Number of the line, keyword, and what follows it, of each line that is neither empty nor a comment.

    A backslash at the end of a line joins the next one to it.
    """
    begun, first = "", 0
    for number, line in enumerate(text.split("\n"), 1):
        if begun:
            line = begun + line
        else:
            first = number
        if line.endswith("\\"):
            begun = line[:-1] + " "
            continue
        begun = ""
        keyword, *rest = line.split(None, 1)[:2] or ("#",)
        if not keyword.startswith("#"):
            yield first, keyword, rest[0] if rest else ""


def by_keyword(text: str) -> dict[str, Lines]:
    """All lines of `text` by their keyword in lower case; there are none of one that it does not have."""
    found = defaultdict[str, Lines](Lines)
    for number, keyword, rest in statements(text):
        lines = found[keyword.lower()]
        lines.numbers.append(number)
        lines.texts.append(rest)
    return dict(found)


def uncommented(text: str) -> str:
    """`text` up to a comment. Names may hold a #: this is for numbers."""
    return text[: text.index("#")] if "#" in text else text


def floats(words: list[str], line: int) -> list[float]:
    """The numbers that `words` of that line are; `SceneError` where one is none."""
    for word in words:
        if not is_number(word):
            raise SceneError(f"line {line}: expected numbers, found {shown(word)}")
    return [float(word) for word in words]


def is_number(word: str) -> bool:
    """Whether `word` is one, be it infinite or none."""
    try:
        float(word)
    except ValueError:
        return False
    return True

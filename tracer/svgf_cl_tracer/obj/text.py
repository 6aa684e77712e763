"""Reads the text of OBJ and MTL files: lines with a keyword and its arguments."""

from __future__ import annotations

import codecs
import re
import warnings
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from svgf_cl.errors import shown
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.vectors import Float64

Indices = NDArray[np.int64]

BYTE_ORDER_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}

# The beginnings of lines of which files have millions, with their keywords.
COMMON = {"v ": "v", "v\t": "v", "vt": "vt", "vn": "vn", "f ": "f", "f\t": "f"}


@dataclass
class Lines:
    """Lines with the same keyword: their numbers in the file, from 1 and ascending, and the text after the keyword."""

    numbers: list[int] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    def table(self, least: int, most: int, *, finite: bool = True) -> Float64:
        """The first numbers of each line (lines, most); NaN if a line has fewer.

        Raises
        ------
        SceneError
            If a line has fewer than `least` numbers, or something else, or (with `finite`) numbers that are not finite.
        """
        text, _, counts = self.words()
        try:
            flat = parsed(text, counts.sum(), np.float64)
        except ValueError:
            for line, words in zip(self.numbers, self.texts, strict=True):
                floats(uncommented(words).split(), line)
            raise
        given = np.arange(counts.max(initial=most)) < counts[:, None]
        table = np.full(given.shape, np.nan)
        table[given] = flat
        wrong = counts < least
        if finite:
            wrong |= (~np.isfinite(table) & given).any(1)
        if wrong.any():
            first = int(wrong.argmax())
            expected = f"{least} finite numbers" if finite else f"{least} numbers"
            raise SceneError(f"line {self.numbers[first]}: expected {expected}, found {shown(self.texts[first])}")
        return table[:, :most]

    def words(self) -> tuple[bytes, Indices, Indices]:
        """All lines as one text without comments, the start of each word, and the number of words of each line."""
        joined = "\n".join([*self.texts, ""])
        text = re.sub("#.*", "", joined).encode("ascii", "replace")
        codes = np.frombuffer(text, np.uint8)
        blank = (codes == ord(" ")) | ((codes >= ord("\t")) & (codes <= ord("\r")))
        starts = np.flatnonzero(~blank & np.append(True, blank[:-1])[: len(blank)])
        counts = np.diff(np.searchsorted(starts, np.flatnonzero(codes == ord("\n"))), prepend=0)
        return text, starts, counts

    def in_force(self, lines: Indices) -> Indices:
        """For each of `lines` (numbers in the file), how many of these lines are above it.

        The last of those applies there.
        """
        return np.searchsorted(self.numbers, lines)

    def named(self, lines: Indices) -> tuple[list[str], Indices]:
        """All names on these lines, each once after an empty name, and the index of the one that holds at `lines`."""
        numbers = {"": 0}
        number = np.array([0, *(numbers.setdefault(clean(text), len(numbers)) for text in self.texts)])
        return list(numbers), number[self.in_force(lines)]


NONE = Lines()


def read_text(path: Path) -> list[str]:
    """The lines of a file: UTF-8 or UTF-16, if it is marked or valid as such, otherwise Latin-1.

    A backslash at the end of a line joins it with the next line, which is replaced by an empty one.

    Raises
    ------
    SceneError
        If it is not text.
    """
    data = path.read_bytes()
    marked = next((encoding for mark, encoding in BYTE_ORDER_MARKS.items() if data.startswith(mark)), None)
    try:
        text = data.decode(marked or "utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise SceneError("expected a text, found zeros in it")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return list(_joined(text.split("\n"))) if "\\\n" in text else text.split("\n")


def _joined(lines: list[str]) -> Iterator[str]:
    begun, left = "", 0
    for line in lines:
        if line.endswith("\\"):
            begun, left = f"{begun}{line[:-1]} ", left + 1
            continue
        yield begun + line
        yield from left * [""]
        begun, left = "", 0
    yield begun


def statements(lines: list[str], first: int = 1) -> Iterator[tuple[int, str, str]]:
    """The number (counted from `first`), the keyword and the rest of each line that is not empty and not a comment."""
    for number, line in enumerate(lines, first):
        keyword, *rest = line.split(None, 1) or ("#",)
        if not keyword.startswith("#"):
            yield number, keyword, rest[0] if rest else ""


def by_keyword(lines: list[str]) -> dict[str, Lines]:
    """The lines of a file by their keyword in lower case."""
    found = defaultdict[str, Lines](Lines)
    number = 1
    for beginning, alike in groupby(lines, itemgetter(slice(2))):
        run = list(alike)
        if beginning in COMMON:
            common = found[COMMON[beginning]]
            common.numbers += range(number, number + len(run))
            common.texts += [line[2:] for line in run]
        else:
            for place, keyword, rest in statements(run, number):
                found[keyword.lower()].numbers.append(place)
                found[keyword.lower()].texts.append(rest)
        number += len(run)
    return dict(found)


def parsed(text: bytes, count: int, kind: type[Any]) -> NDArray[Any]:
    """The `count` numbers of type `kind` in a text; `ValueError` if the text has anything else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            numbers = np.fromstring(text, kind, sep=" ") if count else np.zeros(0, kind)
        except DeprecationWarning as error:  # NumPy's warning for words that are not numbers
            raise ValueError(str(error)) from error
    if len(numbers) != count:
        raise ValueError(f"expected {count} numbers, found {len(numbers)}")
    return numbers


def uncommented(text: str) -> str:
    """`text` without a comment. Only for numbers, because names may contain a #."""
    return text[: text.index("#")] if "#" in text else text


def clean(name: str) -> str:
    """The name of a material or object in the form in which names are compared: words separated by one space."""
    return " ".join(name.split())


def floats(words: list[str], line: int) -> list[float]:
    """The numbers in `words` of a line; `SceneError` if a word is not a number."""
    for word in words:
        if not is_number(word):
            raise SceneError(f"line {line}: expected numbers, found {shown(word)}")
    return [float(word) for word in words]


def is_number(word: str) -> bool:
    """Whether `word` is a number, which may be infinite or NaN."""
    try:
        float(word)
    except ValueError:
        return False
    return True

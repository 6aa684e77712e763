"""MTL files: the statements of each material, and the images to which they refer."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from svgf_cl_tracer.errors import SceneError

from .text import clean, floats, is_number, read_text, statements, uncommented

# Options of an image, and the most words that may follow each: the first is always taken, further ones if they are
# numbers.
OPTIONS = {
    "-blendu": 1,
    "-blendv": 1,
    "-bm": 1,
    "-boost": 1,
    "-cc": 1,
    "-clamp": 1,
    "-imfchan": 1,
    "-mm": 2,
    "-o": 3,
    "-s": 3,
    "-t": 3,
    "-texres": 1,
    "-type": 1,
}


class Map(NamedTuple):
    """An image of a material: its file, and the words after each option."""

    name: str
    options: dict[str, list[str]]

    @classmethod
    def of(cls, text: str) -> Map:
        """Split options from a name that may contain spaces; some programs write options after the name."""
        words, options, name = list(re.finditer(r"\S+", text)), dict[str, list[str]](), list[re.Match[str]]()
        while words:
            word = words.pop(0)
            option = word.group().lower()
            if option not in OPTIONS:
                name.append(word)
                continue
            taken = options[option] = list[str]()
            while words and len(taken) < OPTIONS[option] and (not taken or is_number(words[0].group())):
                taken.append(words.pop(0).group())
        return cls(text[name[0].start() : name[-1].end()] if name else "", options)

    def placement(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The factor of texture coordinates (-s), and the offset that is added afterwards (-o)."""
        return self._pair("-s", 1.0), self._pair("-o", 0.0)

    def _pair(self, option: str, default: float) -> tuple[float, float]:
        numbers = [float(word) for word in self.options.get(option, ()) if is_number(word)]
        first, second, *_ = [*numbers, default, default]
        return first, second


class Statement(NamedTuple):
    """One line of a material, with its keyword as written."""

    line: int
    keyword: str
    text: str

    def numbers(self, *counts: int) -> list[float]:
        """The numbers of the statement.

        Raises
        ------
        SceneError
            If their count is none of `counts`, or if there is something else.
        """
        numbers = floats(uncommented(self.text).split(), self.line)
        if len(numbers) not in counts:
            expected = " or ".join(map(str, counts))
            raise SceneError(f"line {self.line}: {self.keyword}: expected numbers, {expected}, found {len(numbers)}")
        return numbers


@dataclass(frozen=True)
class Definition:
    """A material as in an MTL file.

    Parameters
    ----------
    library : Path
        The file.
    statements : dict of Statement
        By keyword in lower case.
    maps : dict of Map
        The images of those statements that have one.
    """

    library: Path
    statements: dict[str, Statement] = field(default_factory=dict)
    maps: dict[str, Map] = field(default_factory=dict)

    def add(self, statement: Statement) -> None:
        """Add a statement; it replaces an earlier one with the same keyword."""
        keyword = statement.keyword.lower()
        self.statements[keyword] = statement
        if keyword.startswith("map_"):
            self.maps[keyword] = Map.of(statement.text)


def read_library(path: Path) -> dict[str, Definition]:
    """The materials of an MTL file by name; if several have the same name, the first one."""
    definitions: dict[str, Definition] = {}
    current = Definition(path)  # statements before the first material belong to none
    for line, keyword, rest in statements(read_text(path)):
        if keyword.lower() == "newmtl":
            current = Definition(path)
            definitions.setdefault(clean(rest), current)
        else:
            current.add(Statement(line, keyword, rest))
    return definitions

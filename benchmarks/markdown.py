"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def markdown(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown: a line with the columns, a separator, and a line for each row."""
    lines = (columns, ["---"] * len(columns), *rows)
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"

"""Tables in Markdown."""

from __future__ import annotations

from benchmarks.markdown import markdown


def test_a_table() -> None:
    assert markdown(("a", "b"), [("1", "2")]) == "| a | b |\n| --- | --- |\n| 1 | 2 |\n"

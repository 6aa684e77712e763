"""Every example is named in the README, and run by a test."""

from __future__ import annotations

from pathlib import Path


def test_readme_has_a_line_for_each_example() -> None:
    folder = Path(__file__).parents[2] / "examples"
    text = (folder / "README.md").read_text(encoding="utf-8")
    for example in folder.glob("*.py"):
        assert f"- [{example.name}]({example.name}): " in text
        assert (Path(__file__).parent / f"test_{example.name}").exists()

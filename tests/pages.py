"""The pages that users read, and the code in them."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]

OTHERS = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "tracer/README.md")
PAGES = [*(ROOT / name for name in OTHERS), *sorted(ROOT.glob("examples/*.md")), *sorted(ROOT.glob("docs/**/*.md"))]


def name_of(page: Path) -> str:
    """A page as tests are called by it."""
    return str(page.relative_to(ROOT))


def blocks(text: str, language: str) -> list[str]:
    """The blocks of code in this language."""
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def without_code(text: str) -> str:
    """The text around all code."""
    return re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)

"""What says which release this is says the same everywhere: svgf_cl.__version__ declares it."""

from __future__ import annotations

import re

from svgf_cl import __version__
from tests.pages import ROOT


def cited(key: str) -> str:
    """What CITATION.cff says."""
    (value,) = re.findall(rf"^{key}: (.+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    return str(value)


def test_the_changelog_begins_with_this_release_and_its_date() -> None:
    heading = re.search(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert heading is not None
    assert heading[1] == f"{__version__} ({cited('date-released')})"


def test_the_citation_is_of_this_release_and_its_repository() -> None:
    assert cited("version") == __version__
    assert f'\nRepository = "{cited("repository-code")}"\n' in (ROOT / "pyproject.toml").read_text()

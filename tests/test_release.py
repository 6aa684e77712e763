"""What says which release this is says the same everywhere: svgf_cl.__version__ declares it."""

from __future__ import annotations

import re
from importlib.metadata import metadata

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


def test_the_extras_of_the_installation_page_are_those_of_the_package() -> None:
    rows = re.findall(r"^\| (`[^|]+`) \|", (ROOT / "docs" / "installation.md").read_text(), re.MULTILINE)
    assert sorted(re.findall(r"`([\w-]+)`", " ".join(rows))) == sorted(metadata("svgf_cl").get_all("Provides-Extra"))

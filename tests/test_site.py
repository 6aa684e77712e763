"""The pages of the documentation site, before Sphinx sees them; `make site` builds them, and fails on any warning."""

from __future__ import annotations

import dataclasses
from itertools import chain

import pytest
import typer

import svgf_cl
from scripts import settings_page
from scripts.site import reference
from scripts.site.__main__ import MADE
from scripts.site.contents import SECTIONS, sources
from scripts.site.links import for_site, repository
from svgf_cl.cli import application
from svgf_cl.filters import FILTERS


def test_every_page_is_in_the_navigation_once() -> None:
    listed = list(chain.from_iterable(SECTIONS.values()))
    assert sorted(listed) == sorted((sources().keys() | MADE.keys()) - {"index.md"})


def test_everything_that_users_import_is_in_the_api() -> None:
    assert sorted(chain.from_iterable(reference.TOPICS.values())) == sorted(svgf_cl.__all__)


def test_the_settings_are_all_there_with_their_defaults() -> None:
    page = settings_page.page()
    for kind in FILTERS.values():
        part = page.split(f"\n## {kind.__name__}\n")[1].split("\n## ")[0]
        assert all(f"- **`{each.name}`** `= {each.default!r}`" in part for each in dataclasses.fields(kind))


def test_the_commands_are_all_there_with_their_options() -> None:
    page = reference.command_line()
    for name, command in typer.main.get_group(application()).commands.items():
        part = page.split(f"\n## {name}\n")[1].split("\n## ")[0]
        options = [option for option in command.params if not option.hidden and option.param_type_name == "option"]
        assert all(option.opts[-1] in part for option in options)


@pytest.mark.parametrize(
    ("path", "link", "expected"),
    [
        ("README.md", "docs/gpu.md", "gpu.md"),
        ("README.md", "docs/results.md#bars", "results.md#bars"),
        ("README.md", "docs/filters.webp", "filters.webp"),
        ("README.md", "examples/README.md", "examples.md"),
        ("docs/gpu.md", "#drivers", "#drivers"),
        ("docs/gpu.md", "results.md", "results.md"),
        ("docs/gpu.md", "../README.md", "index.md"),
        ("docs/gpu.md", "https://example.org/a.md", "https://example.org/a.md"),
        ("docs/gpu.md", "../kernels/atrous.cl", f"{repository()}/blob/main/kernels/atrous.cl"),
        ("docs/renderers/other.md", "../filters.webp", "../filters.webp"),
        ("docs/renderers/other.md", "../../examples/README.md", "../examples.md"),
        ("tracer/README.md", "../docs/scenes.md", "scenes.md"),
    ],
)
def test_links_lead_to_pages_of_the_site_or_to_the_repository(path: str, link: str, expected: str) -> None:
    assert for_site(f"See [`a page`]({link}).", path) == f"See [`a page`]({expected})."


def test_code_is_left_as_it_is() -> None:
    page = "`[a](docs/gpu.md)`\n\n```md\n[a](docs/gpu.md)\n```\n"
    assert for_site(page, "README.md") == page


def test_a_link_that_leads_nowhere_is_refused() -> None:
    with pytest.raises(ValueError, match=r"docs/gpu\.md: .*\.\./absent\.cl"):
        for_site("[a](../absent.cl)", "docs/gpu.md")

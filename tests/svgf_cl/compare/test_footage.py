"""Scenes are rendered by whatever package says that it can; where none does, it is said which to install."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from svgf_cl.compare import footage
from svgf_cl.compare.footage import GROUP, opener
from svgf_cl.errors import SvgfError


def declare(monkeypatch: pytest.MonkeyPatch, *values: str) -> None:
    """As if these functions were declared, and no others."""
    found = [EntryPoint("scenes", value, GROUP) for value in values]
    monkeypatch.setattr(footage, "entry_points", lambda group: [each for each in found if each.group == group])


def test_the_function_of_a_package_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    declare(monkeypatch, "svgf_cl.compare.footage:opener")
    assert opener() is footage.opener


@pytest.mark.parametrize("values", [(), ("svgf_cl_no_such_package:open_footage",)])
def test_without_one_that_works_it_is_said_what_to_install(
    values: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    declare(monkeypatch, *values)
    with pytest.raises(SvgfError, match=r"needs the tracer.*pip install 'svgf-cl\[tracer\]'"):
        opener()

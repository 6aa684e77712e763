"""Converts links in pages: to the page on the site if there is one, otherwise to the file in the repository."""

from __future__ import annotations

import os
import re
from pathlib import PurePosixPath

from scripts.site.contents import ROOT, page_of

PICTURES = (".png", ".webp")
CODE = re.compile(r"(^```.*?^```|`[^`\n]*`)", re.DOTALL | re.MULTILINE)
TARGET = re.compile(r"(?<=\]\()([^)\s#]+)")


def repository() -> str:
    """The address of the repository, as pyproject.toml declares it."""
    (address,) = re.findall(r'^Repository = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    return str(address)


def for_site(text: str, path: str) -> str:
    """The text of a page for the site.

    Parameters
    ----------
    text : str
        The page as it is in the repository.
    path : str
        Its path there, such as ``docs/renderers/blender.md``.
    """
    parts = CODE.split(text)  # text and code alternate
    parts[::2] = [TARGET.sub(lambda found: _target(found[1], path), part) for part in parts[::2]]
    return "".join(parts)


def _target(target: str, path: str) -> str:
    """The target on the site of a link in the page at `path`."""
    if "://" in target:
        return target
    file = os.path.normpath(PurePosixPath(path).parent / target)
    if page := page_of(file):
        return _relative(page, path)
    if file.startswith("docs/") and file.endswith(PICTURES):
        return _relative(file.removeprefix("docs/"), path)
    if not (ROOT / file).exists():
        raise ValueError(f"{path}: expected a link to a file of the repository, got {target}")
    return f"{repository()}/blob/main/{file}"


def _relative(page: str, path: str) -> str:
    """The path to a page or picture of the site, relative to the page on the site for `path`."""
    here = page_of(path)
    assert here is not None, path
    return os.path.relpath(page, PurePosixPath(here).parent)

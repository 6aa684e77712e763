"""Links of a page for the site: to the page there, else to the file in the repository."""

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
        Where it lies there, such as ``docs/renderers/blender.md``.
    """
    parts = CODE.split(text)  # text and code by turns
    parts[::2] = [TARGET.sub(lambda found: _target(found[1], path), part) for part in parts[::2]]
    return "".join(parts)


def _target(target: str, path: str) -> str:
    """Where a link of the page at `path` leads on the site."""
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
    """A page or picture of the site as seen from what the page at `path` is there."""
    here = page_of(path)
    assert here is not None, path
    return os.path.relpath(page, PurePosixPath(here).parent)

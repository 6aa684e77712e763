"""Builds the documentation site: `make site`. Any warning of Sphinx fails it.

The pages are copied to a folder with links that fit the site. The pages that are made from the code are written there,
too.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from scripts.site import reference
from scripts.site.contents import ROOT, navigation, sources
from scripts.site.links import PICTURES, for_site

MADE = {"api.rst": reference.api, "command_line.md": reference.command_line}


def write_pages(folder: Path) -> None:
    """Write every page and picture of the site into `folder`."""
    pages = {page: for_site(file.read_text(), file.relative_to(ROOT).as_posix()) for page, file in sources().items()}
    pages["index.md"] += navigation()
    pages |= {page: make() for page, make in MADE.items()}
    for page, text in pages.items():
        (folder / page).parent.mkdir(parents=True, exist_ok=True)
        (folder / page).write_text(text)
    for picture in (ROOT / "docs").rglob("*"):
        if picture.suffix in PICTURES:
            shutil.copy(picture, folder / picture.relative_to(ROOT / "docs"))


def main(output: Path = ROOT / "out" / "site") -> None:
    """Build the site into `output`."""
    with tempfile.TemporaryDirectory() as folder:
        write_pages(Path(folder))
        sphinx = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--quiet", "-c", str(Path(__file__).parent)]
        built = subprocess.run([*sphinx, folder, str(output)], check=False)
    if built.returncode:
        sys.exit(built.returncode)
    print(output / "index.html")


if __name__ == "__main__":
    main()

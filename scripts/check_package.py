"""Builds the source archive and the wheel, and checks both: `make package`.

The archive contains the repository, the wheel contains all packages, and a package index accepts both. In a new
environment, in another folder, the wheel alone runs the example of README.md, and says what its other commands need.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Iterable
from email import message_from_bytes
from pathlib import Path
from typing import Annotated

import typer

from svgf_cl import __version__

ROOT = Path(__file__).parents[1]
MADE = re.compile(r"PKG-INFO|setup\.cfg|svgf_cl\.egg-info/.*")  # files that setuptools adds to the archive
# The folders of the packages in the repository, and in the wheel.
PACKAGES = {"svgf_cl/": "svgf_cl/", "kernels/": "svgf_cl/kernels/", "tracer/svgf_cl_tracer/": "svgf_cl_tracer/"}


def tracked() -> set[str]:
    """All files of the repository, including those that are about to be added."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    return {name for name in listed if (ROOT / name).is_file()}


def build(names: Iterable[str], output: Path) -> tuple[Path, Path]:
    """Build the archive from these files, and the wheel from the archive; return the paths of both."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, Path(folder) / name)
        run(sys.executable, "-m", "build", "--no-isolation", "--outdir", output, folder, quiet=True)
    stem = f"svgf_cl-{__version__}"
    return output / f"{stem}.tar.gz", output / f"{stem}-py3-none-any.whl"


def check_same(what: str, expected: set[str], found: set[str]) -> None:
    """Fail if `what` lacks a file or has an additional one."""
    if expected != found:
        lacks, extra = sorted(expected - found), sorted(found - expected)
        sys.exit(f"{what}: expected the files of the repository; it lacks {lacks} and has {extra} beside them")


def check_source(archive: Path, names: set[str]) -> None:
    """The archive contains the repository, except files for a forge or an editor, whose names begin with a dot."""
    with tarfile.open(archive) as opened:
        found = {each.name.partition("/")[2] for each in opened.getmembers() if each.isfile()}
    check_same(
        archive.name,
        {name for name in names if not name.startswith(".")},
        {name for name in found if not MADE.fullmatch(name)},
    )


def check_wheel(wheel: Path, names: set[str]) -> None:
    """The wheel contains all files of the packages and nothing else; its description has no links to local files."""
    with zipfile.ZipFile(wheel) as opened:
        found = opened.namelist()
        (described,) = (name for name in found if name.endswith(".dist-info/METADATA"))
        text = str(message_from_bytes(opened.read(described)).get_payload())
    expected = {new + name.removeprefix(old) for old, new in PACKAGES.items() for name in names if name.startswith(old)}
    check_same(wheel.name, expected, {name for name in found if ".dist-info/" not in name})
    relative = [link for link in re.findall(r"\]\(([^)\s]+)\)", text) if not link.startswith(("https://", "#"))]
    if relative:
        sys.exit(f"{wheel.name}: expected absolute links in its description, found {relative}")


def check_use(wheel: Path, python: str) -> None:
    """Use the wheel as a new user would: install it, run README's example, call commands that need more packages."""
    (example,) = re.findall(r"^```python\n(.*?)^```", (ROOT / "README.md").read_text(), re.DOTALL | re.MULTILINE)
    with tempfile.TemporaryDirectory() as folder:
        bin_folder = Path(folder) / "env" / "bin"
        run(python, "-m", "venv", "--without-pip", bin_folder.parent)
        pip = (sys.executable, "-m", "pip", "--python", bin_folder / "python", "--disable-pip-version-check")
        run(*pip, "install", "--quiet", "--no-compile", wheel)
        run(bin_folder / "python", "-c", example, cwd=folder)
        run(bin_folder / "svgf-cl", "--version", cwd=folder)
        refused = subprocess.run(
            [bin_folder / "svgf-cl", "render", "cornell", "-o", "out"],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
    if refused.returncode != 2 or "pip install 'svgf-cl[tracer]'" not in refused.stderr:
        sys.exit(f"svgf-cl render: expected it to name the extra that it needs, got {refused.stderr}")


def run(*command: str | Path, cwd: str | None = None, quiet: bool = False) -> None:
    """Run a command, which must succeed; if `quiet`, show its output only if it fails."""
    told = subprocess.PIPE if quiet else None
    ran = subprocess.run(command, cwd=cwd, stdout=told, stderr=subprocess.STDOUT if quiet else None, check=False)
    if ran.returncode:
        sys.stdout.write((ran.stdout or b"").decode())
        sys.exit(f"expected {' '.join(map(str, command[:4]))} ... to succeed, got exit code {ran.returncode}")


def main(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the archive and the wheel.")],
    python: Annotated[str, typer.Option(help="The Python in which the wheel is tried.")] = sys.executable,
) -> None:
    """Build and check the source archive and the wheel."""
    names = tracked()
    archive, wheel = build(names, output.absolute())
    check_source(archive, names)
    check_wheel(wheel, names)
    run(sys.executable, "-m", "twine", "check", "--strict", archive, wheel)
    check_use(wheel, python)
    print(f"{archive}\n{wheel}")


if __name__ == "__main__":
    typer.run(main)

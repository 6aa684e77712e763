"""The compilers for GPUs: how to find them, and how to install missing ones.

As a program it lists the missing ones; the exit code is then 1. `scripts/set_up gpu-compilers` installs them.
"""

from __future__ import annotations

import importlib.metadata
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from pathlib import Path

from svgf_cl.errors import SvgfError, install_extra

CLANGS = range(19, 30)  # 19 is the first version whose OpenCL is correct for all these targets
SPIRV_CLANGS = range(15, 30)  # each writes SPIR-V with the llvm-spirv of its own version

# The folders of NVIDIA's and AMD's libraries for OpenCL C.
LIBCLC_FOLDERS = ("/usr/lib/clc", "/usr/share/clc", "/usr/lib/llvm-*/share/clc", "/usr/local/share/clc")
ROCM_FOLDERS = (
    "/usr/lib/*-linux-gnu/amdgcn/bitcode",
    "/usr/lib/llvm-*/lib/clang/*/amdgcn/bitcode",
    "/opt/rocm*/amdgcn/bitcode",
)


@dataclass(frozen=True)
class Tools:
    """The paths of all tools and of the two libraries."""

    clang: Path
    libclc: Path
    ptxas: Path
    nvdisasm: Path
    rocm: Path
    spirv_clang: Path
    llvm_spirv: Path
    spirv_val: Path

    @property
    def versions(self) -> dict[str, str]:
        """The version of every tool that prints one, as one line each."""
        programs = (each for each in fields(self) if each.name not in ("libclc", "rocm"))
        return {each.name: version(getattr(self, each.name)) for each in programs}


@dataclass(frozen=True)
class Wanted:
    """How to find a tool, and what to install if it is missing."""

    find: Callable[[], Path | None]
    what: str
    package: str


def program(names: Iterable[str]) -> Path | None:
    """The first of these programs that is on the path."""
    return next((Path(found) for name in names if (found := shutil.which(name))), None)


def spirv_pair(name: str) -> Path | None:
    """Clang or llvm-spirv, of the first version of which both exist."""
    for number in SPIRV_CLANGS:
        pair = {each: program([f"{each}-{number}"]) for each in ("clang", "llvm-spirv")}
        if all(pair.values()):
            return pair[name]
    return None


def from_wheel(distribution: str, name: str) -> Path | None:
    """A program in a Python package, anywhere in the package's folder."""
    try:
        files = importlib.metadata.files(distribution) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    places = (Path(str(file.locate())) for file in files if file.stem == name and file.parent.name == "bin")
    return next((place for place in places if place.is_file()), None)


def under(patterns: Iterable[str], name: str) -> Path | None:
    """The first file with this name in folders that match the patterns."""
    for pattern in patterns:
        found = sorted(Path("/").glob(f"{pattern}/{name}".lstrip("/")))
        if found:
            return found[0]
    return None


def rocm_folder() -> Path | None:
    """The folder of AMD's library."""
    found = under(ROCM_FOLDERS, "ocml.bc")
    return found.parent if found else None


EXTRA = install_extra("gpu-static")
WANTED: dict[str, Wanted] = {
    "clang": Wanted(lambda: program(f"clang-{number}" for number in CLANGS), "clang 19 or later", "clang-19"),
    "libclc": Wanted(lambda: under(LIBCLC_FOLDERS, "nvptx64--nvidiacl.bc"), "libclc for NVIDIA", "libclc-15"),
    "ptxas": Wanted(lambda: from_wheel("nvidia-cuda-nvcc-cu12", "ptxas"), "ptxas", EXTRA),
    "nvdisasm": Wanted(lambda: from_wheel("nvidia-cuda-nvdisasm", "nvdisasm"), "nvdisasm", EXTRA),
    "rocm": Wanted(rocm_folder, "AMD's device libraries", "rocm-device-libs"),
    "spirv_clang": Wanted(lambda: spirv_pair("clang"), "a clang of llvm-spirv's version", "clang-15"),
    "llvm_spirv": Wanted(lambda: spirv_pair("llvm-spirv"), "llvm-spirv of a clang's version", "llvm-spirv-15"),
    "spirv_val": Wanted(lambda: program(["spirv-val"]), "spirv-val", "spirv-tools"),
}


def find() -> Tools:
    """Find all tools.

    Raises
    ------
    SvgfError
        If some are missing; the message names each, and what installs it.
    """
    found = {name: wanted.find() for name, wanted in WANTED.items()}
    absent = [WANTED[name] for name, path in found.items() if path is None]
    if absent:
        listed = "\n".join(f"  {each.what}: {installed_by(each.package)}" for each in absent)
        raise SvgfError(
            f"expected compilers for GPUs, did not find:\n{listed}\n"
            "'make gpu-static' installs them on Debian 12; elsewhere packages may have other versions in their names"
        )
    return Tools(**{name: path for name, path in found.items() if path is not None})


def installed_by(package: str) -> str:
    """The command that installs a package."""
    return package if package == EXTRA else f"apt-get install {package}"


def version(tool: Path) -> str:
    """The version that a tool prints."""
    said = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout
    found = re.search(r"(?:version |SPIRV-Tools v|, V)(\d[\d.]*\d)", said)
    return found[1] if found else "unknown"


def main() -> None:
    """Look for all tools."""
    try:
        find()
    except SvgfError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()

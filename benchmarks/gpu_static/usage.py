"""What a compiled kernel needs on a device, and how compilers are run."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.builds import Build
from svgf_cl.device import programs
from svgf_cl.errors import SvgfError


class RejectedError(SvgfError):
    """A compiler or a validator refused a kernel; the message is its output."""


@dataclass(frozen=True)
class Instructions:
    """The number of instructions of each kind in a kernel's code; loops count once.

    Parameters
    ----------
    total : int
        All instructions except padding.
    loads, stores : int
        Of global memory, by each work-item for itself. AMD's scalar loads, of which a whole wave needs one, do not
        count.
    integer : int
        Additions, multiplications and shifts of integers. Nearly all of them compute addresses, except one shift and
        one addition for each weight with a polynomial exponential.
    """

    total: int
    loads: int
    stores: int
    integer: int

    @classmethod
    def counted(cls, mnemonics: Iterable[str], loads: str, stores: str, integer: str) -> Instructions:
        """Count mnemonics by regular expressions for the beginnings of the mnemonics of each kind."""
        every = list(mnemonics)
        return cls(
            len(every), *(sum(bool(re.match(kind, each)) for each in every) for kind in (loads, stores, integer))
        )


@dataclass(frozen=True)
class Usage:
    """The needs of a kernel on one architecture.

    Parameters
    ----------
    registers : int
        32-bit registers of a work-item: NVIDIA's, or AMD's VGPRs.
    scalars : int or None
        AMD's registers of a whole wave (SGPRs).
    spills : int
        Bytes that were stored and loaded again (NVIDIA), or registers (AMD), because there were too few registers.
    scratch : int
        Bytes of a work-item's private memory, for arrays that are indexed at run time, and for spills.
    """

    registers: int
    scalars: int | None
    spills: int
    scratch: int


@dataclass(frozen=True)
class Compiled:
    """A kernel: its needs, and its code as the compiler wrote it (machine code or assembly)."""

    usage: Usage
    code: bytes


def written(build: Build, folder: Path) -> Path:
    """Write a build's source into its own folder, and return the file."""
    path = folder / f"{build.source}.cl"
    path.write_text(programs.source(build.source), encoding="utf-8")
    return path


def language(build: Build) -> tuple[str, ...]:
    """Clang's options for a build: those for drivers without -w, which hides warnings."""
    return ("-x", "cl", *(option for option in build.options if option != "-w"), "-Xclang", "-finclude-default-header")


def included(text: str, folder: Path) -> tuple[str, str]:
    """Options that make the compiler read `text` before the source; the text is written to this folder."""
    header = folder / "included.h"
    header.write_text(text)
    return "-include", str(header)


def passed(option: str, *values: str) -> tuple[str, ...]:
    """Pass an option to the compiler itself, once for each value."""
    return tuple(word for value in values for word in ("-Xclang", option, "-Xclang", value))


def said_by(command: Sequence[str | Path]) -> str:
    """Run a tool and return its output; `RejectedError` if it fails."""
    tool = subprocess.run(command, capture_output=True, text=True)
    if tool.returncode:
        raise RejectedError(f"{Path(command[0]).name}: {(tool.stderr + tool.stdout).strip()}")
    return tool.stdout + tool.stderr

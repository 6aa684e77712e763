"""What a compiled kernel needs of a device, and how compilers are run to find out."""

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
    """A compiler or a validator refused a kernel; the message is what it said."""


@dataclass(frozen=True)
class Instructions:
    """How often each kind of instruction stands in a kernel's code; loops are counted once.

    Parameters
    ----------
    total : int
        All but padding.
    loads, stores : int
        Of global memory, by each work-item for itself. AMD's scalar loads, one for a whole wave, are not among them.
    integer : int
        Additions, multiplications and shifts of whole numbers. Nearly all compute addresses; in kernels with a
        polynomial exponential one shift and one addition of each weight do not.
    """

    total: int
    loads: int
    stores: int
    integer: int

    @classmethod
    def counted(cls, mnemonics: Iterable[str], loads: str, stores: str, integer: str) -> Instructions:
        """Count mnemonics by regular expressions that match the beginning of those of a kind."""
        every = list(mnemonics)
        return cls(
            len(every), *(sum(bool(re.match(kind, each)) for each in every) for kind in (loads, stores, integer))
        )


@dataclass(frozen=True)
class Usage:
    """What a kernel takes on one architecture.

    Parameters
    ----------
    registers : int
        32-bit registers of a work-item: NVIDIA's, or AMD's VGPRs.
    scalars : int or None
        AMD's registers of a whole wave (SGPRs).
    spills : int
        What did not fit into registers: bytes stored and loaded again (NVIDIA), or registers (AMD).
    scratch : int
        Bytes of a work-item's own memory: arrays that are indexed at run time, and spills.
    """

    registers: int
    scalars: int | None
    spills: int
    scratch: int


@dataclass(frozen=True)
class Compiled:
    """A kernel: what it takes, and its code as the compiler wrote it (machine code, or the text of its assembly)."""

    usage: Usage
    code: bytes


def written(build: Build, folder: Path) -> Path:
    """Write a build's source into a folder of its own and return the file."""
    path = folder / f"{build.source}.cl"
    path.write_text(programs.source(build.source), encoding="utf-8")
    return path


def language(build: Build) -> tuple[str, ...]:
    """Clang's options for a build: what drivers get, but for -w, which hides warnings."""
    return ("-x", "cl", *(option for option in build.options if option != "-w"), "-Xclang", "-finclude-default-header")


def included(text: str, folder: Path) -> tuple[str, str]:
    """Have the compiler read a text before the source; it is kept in this folder."""
    header = folder / "included.h"
    header.write_text(text)
    return "-include", str(header)


def passed(option: str, *values: str) -> tuple[str, ...]:
    """Pass an option to the compiler proper, once with each value."""
    return tuple(word for value in values for word in ("-Xclang", option, "-Xclang", value))


def said_by(command: Sequence[str | Path]) -> str:
    """Run a tool and return what it printed; `RejectedError` where it fails."""
    tool = subprocess.run(command, capture_output=True, text=True)
    if tool.returncode:
        raise RejectedError(f"{Path(command[0]).name}: {(tool.stderr + tool.stdout).strip()}")
    return tool.stdout + tool.stderr

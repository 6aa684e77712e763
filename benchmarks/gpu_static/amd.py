"""Compiles kernels for AMD's GPUs: clang writes assembly, whose metadata has the registers that drivers allocate."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.builds import Build
from benchmarks.gpu_static.tools import Tools
from benchmarks.gpu_static.usage import (
    Compiled,
    Instructions,
    RejectedError,
    Usage,
    included,
    language,
    passed,
    said_by,
    written,
)

# RDNA 2 (waves of 32 work-items), RDNA 3 (32) and CDNA 2 (64), with the numbers of these architectures in AMD's
# library: 1000 major + 100 minor + stepping. The library has a file with this number for each architecture, but Debian
# 12's has none for gfx1100. So the number is defined here for all of them.
ARCHITECTURES = {"gfx1030": 10300, "gfx1100": 11000, "gfx90a": 9010}
WAVES_OF_64 = ("gfx90a",)

TARGET = ("-O3", "-target", "amdgcn-amd-amdhsa", "-mcode-object-version=5", "-nogpulib")
# AMD's library, and constants that give it the options of svgf_cl.device.programs.OPTIONS and OpenCL's defaults.
LIBRARY = ("opencl", "ocml", "ockl")
CHOICES = ("daz_opt_on", "finite_only_off", "unsafe_math_off", "correctly_rounded_sqrt_off", "abi_version_500")

BODY = r"^{name}:.*?$(.*?)^\.Lfunc_end"
INSTRUCTION = re.compile(r"^\t([a-z]\w+)", re.MULTILINE)
KERNELS = re.compile(r"^amdhsa\.kernels:\n(.*?)^\S", re.DOTALL | re.MULTILINE)
FIELD = re.compile(r"^(?:    |  - )\.(\w+): +(\S+)", re.MULTILINE)
PADDING = "s_code_end"  # fetched, but never executed
LOADS, STORES = r"(?:global|flat|buffer)_load_", r"(?:global|flat|buffer)_store_"
INTEGER = r"[sv]_(?:add|sub|mul|mad|lsh|ashr)\w*_[iub]\d+(?:_e\d+)?$"


def compiled(tools: Tools, architecture: str, build: Build, folder: Path) -> dict[str, Compiled]:
    """Compile a build and return its kernels by name, with their assembly.

    Raises
    ------
    RejectedError
        If a tool refuses it.
    """
    assembly = folder / "kernel.s"
    waves = f"wavefrontsize64_{'on' if architecture in WAVES_OF_64 else 'off'}"
    names = (*LIBRARY, *(f"oclc_{choice}" for choice in (*CHOICES, waves)))
    libraries = passed("-mlink-builtin-bitcode", *(str(tools.rocm / f"{name}.bc") for name in names))
    version = included(f"__constant int __oclc_ISA_version = {ARCHITECTURES[architecture]};\n", folder)
    target = (*TARGET, f"-mcpu={architecture}", *libraries, *version)
    said_by([tools.clang, *language(build), *target, "-S", "-o", assembly, written(build, folder)])
    return parse(assembly.read_text())


def parse(assembly: str) -> dict[str, Compiled]:
    """Read clang's metadata about the kernels in a file of assembly.

    Raises
    ------
    RejectedError
        If there is no such metadata.
    """
    metadata = KERNELS.search(assembly)
    entries = re.split(r"^(?=  - )", metadata[1] if metadata else "", flags=re.MULTILINE)
    found = [dict(FIELD.findall(entry)) for entry in entries if entry]
    if not found:
        raise RejectedError("clang: expected kernels in the metadata of its assembly, found none")
    return {entry["name"]: Compiled(usage(entry), code(entry["name"], assembly)) for entry in found}


def usage(entry: Mapping[str, str]) -> Usage:
    """The registers and memory of a kernel, from its entry in the metadata."""
    return Usage(
        registers=int(entry["vgpr_count"]),
        scalars=int(entry["sgpr_count"]),
        spills=int(entry["vgpr_spill_count"]) + int(entry["sgpr_spill_count"]),
        scratch=int(entry["private_segment_fixed_size"]),
    )


def code(name: str, assembly: str) -> bytes:
    """The assembly of a kernel."""
    body = re.search(BODY.format(name=name), assembly, re.DOTALL | re.MULTILINE)
    if body is None:
        raise RejectedError(f"clang: expected the code of {name} in its assembly, found none")
    return body[1].encode()


def instructions(codes: Sequence[bytes]) -> list[Instructions]:
    """Count the instructions of kernels."""
    return [counted(INSTRUCTION.findall(code.decode())) for code in codes]


def counted(mnemonics: Sequence[str]) -> Instructions:
    """Count the instructions of one kernel."""
    return Instructions.counted((each for each in mnemonics if each != PADDING), LOADS, STORES, INTEGER)

"""Compiles kernels for NVIDIA's GPUs: clang writes PTX, ptxas machine code, and nvdisasm its text."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from itertools import accumulate
from pathlib import Path

from elftools.elf.elffile import ELFFile

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

ARCHITECTURES = ("sm_75", "sm_90")  # Turing, Hopper

TARGET = ("-O3", "-target", "nvptx64-nvidia-nvcl", *passed("-target-feature", "+ptx78"))
# What -cl-denorms-are-zero and OpenCL's precision (quotients within 2.5 ulp, roots within 3) mean for the driver; clang
# needs these options to do the same for this target.
PRECISION = (
    *("-Xclang", "-fdenormal-fp-math-f32=preserve-sign"),
    *("-mllvm", "-nvptx-prec-divf32=1", "-mllvm", "-nvptx-prec-sqrtf32=0"),
)
# NVIDIA's OpenCL computes 2^x by one hardware instruction, within the 4 ulp that OpenCL allows. Debian's libclc
# computes it in 20 instructions instead, and every weight of a filter needs one.
FUNCTIONS = "float __attribute__((overloadable)) exp2(float x) { return __nvvm_ex2_approx_ftz_f(x); }\n"
# clang warns that it ignores -cl-denorms-are-zero, and that the library is for another vendor's triple.
QUIET = ("-Wno-unused-command-line-argument", "-Wno-linker-warnings")

ENTRY = re.compile(r"Compiling entry function '(\w+)'(.*?)(?=Compiling entry function|\Z)", re.DOTALL)
STACK = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
REGISTERS = re.compile(r"Used (\d+) registers")
# An address, an optional predicate, and the instruction.
INSTRUCTION = re.compile(r"^\s+/\*[0-9a-f]{4,}\*/\s+(?:@!?U?P\w+\s+)?([A-Z][A-Z0-9_.]*)", re.MULTILINE)
BYTES = 16  # bytes of an instruction, since Volta
PADDING = "NOP"
LOADS, STORES = r"LDG?\b", r"STG?\b"
INTEGER = r"U?(?:V?IADD3?|IMAD(?!\.MOV)|LEA|SHF|SHL|SHR)(?:\.|$)"


def compiled(tools: Tools, build: Build, folder: Path) -> dict[str, dict[str, Compiled]]:
    """Compile a build once, and assemble it for each architecture: kernels by architecture and name.

    Raises
    ------
    RejectedError
        If a tool refuses it.
    """
    ptx = folder / "kernel.ptx"
    library = passed("-mlink-builtin-bitcode", str(tools.libclc))
    functions = included(FUNCTIONS, folder)
    # PTX of the oldest architecture, because each later one takes it, too.
    target = (*TARGET, *PRECISION, *QUIET, *passed("-target-cpu", ARCHITECTURES[0]), *library, *functions)
    said_by([tools.clang, *language(build), *target, "-S", "-o", ptx, written(build, folder)])
    return {architecture: assembled(tools, architecture, ptx) for architecture in ARCHITECTURES}


def assembled(tools: Tools, architecture: str, ptx: Path) -> dict[str, Compiled]:
    """Assemble PTX, and return its kernels by name, with their machine code."""
    binary = ptx.with_suffix(f".{architecture}.cubin")
    report = said_by([tools.ptxas, "-v", f"-arch={architecture}", ptx, "-o", binary])
    return {name: Compiled(usage, section(binary, f".text.{name}")) for name, usage in parse(report).items()}


def section(binary: Path, name: str) -> bytes:
    """The content of a section of an ELF file."""
    with binary.open("rb") as file:
        found = ELFFile(file).get_section_by_name(name)
        if found is None:
            raise RejectedError(f"ptxas: expected a section {name}, found none")
        return bytes(found.data())


def parse(report: str) -> dict[str, Usage]:
    """Read the output of ``ptxas -v`` about the kernels in a file.

    Raises
    ------
    RejectedError
        If there is no such output.
    """
    found = {}
    for name, said in ENTRY.findall(report):
        registers, stacks = REGISTERS.search(said), STACK.findall(said)
        if registers is None or not stacks:
            raise RejectedError(f"ptxas: expected registers and stack of {name}, got {said.strip()!r}")
        stack, stores, loads = (sum(map(int, column)) for column in zip(*stacks, strict=True))
        found[name] = Usage(int(registers[1]), None, stores + loads, stack)
    if not found:
        raise RejectedError(f"ptxas: expected kernels in its report, found none: {report.strip()!r}")
    return found


def instructions(tools: Tools, architecture: str, codes: Sequence[bytes]) -> list[Instructions]:
    """Count the instructions of kernels, all in one run, because nvdisasm takes a third of a second to start.

    Raises
    ------
    RejectedError
        If nvdisasm fails, or if the number of listed instructions is wrong.
    """
    if not codes:
        return []
    with tempfile.TemporaryDirectory() as folder:
        binary = Path(folder) / "kernels.bin"
        binary.write_bytes(b"".join(codes))
        listing = said_by([tools.nvdisasm, "--binary", architecture.upper().replace("_", ""), binary])
    mnemonics = INSTRUCTION.findall(listing)
    expected = sum(map(len, codes))
    if len(mnemonics) * BYTES != expected:
        raise RejectedError(
            f"nvdisasm for {architecture}: expected {expected // BYTES} instructions, found {len(mnemonics)}; "
            "install the version that the extra gpu-static names"
        )
    ends = list(accumulate(len(code) // BYTES for code in codes))
    parts = (mnemonics[start:end] for start, end in zip([0, *ends], ends, strict=False))
    return [counted(part) for part in parts]


def counted(mnemonics: Sequence[str]) -> Instructions:
    """Count the instructions of one kernel."""
    return Instructions.counted((each for each in mnemonics if each != PADDING), LOADS, STORES, INTEGER)

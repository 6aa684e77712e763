"""Compiles kernels to SPIR-V 1.2 or earlier, for OpenCL 1.2, and has the modules validated."""

from __future__ import annotations

from pathlib import Path

from benchmarks.builds import Build
from benchmarks.gpu_static.tools import Tools
from benchmarks.gpu_static.usage import language, said_by, written

NAME = "SPIR-V"
# Optimised code holds what SPIR-V has no word for. Functions that C99 calls inline get import linkage unless they are
# static, and a module that imports them is not valid alone.
TARGET = ("-target", "spir64-unknown-unknown", "-O1", "-Xclang", "-disable-llvm-passes", "-Dinline=static")
QUIET = ("-Wno-unused-command-line-argument",)
VERSION, ENVIRONMENT = "1.2", "opencl1.2"


def validate(tools: Tools, build: Build, folder: Path) -> None:
    """Compile a build to a module and check it.

    Raises
    ------
    RejectedError
        A tool refused it.
    """
    bitcode, module = folder / "kernel.bc", folder / "kernel.spv"
    said_by(
        [
            tools.spirv_clang,
            *language(build),
            *TARGET,
            *QUIET,
            "-emit-llvm",
            "-c",
            "-o",
            bitcode,
            written(build, folder),
        ]
    )
    said_by([tools.llvm_spirv, f"--spirv-max-version={VERSION}", bitcode, "-o", module])
    said_by([tools.spirv_val, "--target-env", ENVIRONMENT, module])

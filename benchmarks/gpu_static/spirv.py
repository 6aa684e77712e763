"""Compiles kernels to SPIR-V 1.2 or earlier, for OpenCL 1.2, and validates the modules."""

from __future__ import annotations

from pathlib import Path

from benchmarks.builds import Build
from benchmarks.gpu_static.tools import Tools
from benchmarks.gpu_static.usage import language, said_by, written

NAME = "SPIR-V"
# Without optimisation, because optimised code has operations that SPIR-V lacks. Inline functions of C99 get import
# linkage unless they are static, and a module with imports is not valid alone.
TARGET = ("-target", "spir64-unknown-unknown", "-O1", "-Xclang", "-disable-llvm-passes", "-Dinline=static")
QUIET = ("-Wno-unused-command-line-argument",)
VERSION, ENVIRONMENT = "1.2", "opencl1.2"


def validate(tools: Tools, build: Build, folder: Path) -> None:
    """Compile a build to a module and check it.

    Raises
    ------
    RejectedError
        If a tool refuses it.
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

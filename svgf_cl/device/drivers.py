"""Drivers that are often installed without an ``.icd`` file that tells the OpenCL loader of them."""

from __future__ import annotations

import ctypes.util
import os
import platform
import sysconfig
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

# Where programs of 64 bits have their libraries, by Debian's and by Red Hat's rules.
SYSTEM_LIBRARIES = (Path(f"/usr/lib/{platform.machine()}-linux-gnu"), Path("/usr/lib64"))


@dataclass(frozen=True)
class Driver:
    """A driver, and how to find out whether it is installed.

    Parameters
    ----------
    name : str
        Of the ``.icd`` file that is written for it.
    platform : str
        The OpenCL platform's name.
    library : str
        The library's file name, by which ``.icd`` files name it.
    folders : callable
        Gives the folders that the library may lie in, the most likely first.
    kernel : tuple of str
        Files, of which one is there where the operating system's part of the driver is. The library is looked for only
        there; a driver without such a part is looked for everywhere.
    remedy : str
        How to get the library where only the operating system's part is there.
    """

    name: str
    platform: str
    library: str
    folders: Callable[[], Iterator[Path]]
    kernel: tuple[str, ...] = ()
    remedy: str = ""

    @property
    def kernel_part(self) -> str | None:
        """The file that shows that the operating system's part is there; None where it is not."""
        return next((path for path in self.kernel if os.path.exists(path)), None)

    def find(self) -> str | None:
        """Return the library's path, its name alone if only the dynamic linker knows where it is, or None if nobody.

        Returns
        -------
        str or None
        """
        if self.kernel and not self.kernel_part:
            return None
        # Not `path.exists()`, which raises where a folder is another user's, as under sudo.
        found = next((path for path in map(self._in, self.folders()) if os.path.exists(path)), None)
        if found or not self.kernel:
            return found
        return ctypes.util.find_library(self.library.removeprefix("lib").partition(".so")[0])

    def why_missing(self) -> str:
        """Return why the operating system's part is of no use; empty if it is not there, or the library is too."""
        part = self.kernel_part
        if part is None or self.find():
            return ""
        return f"{part} shows that the system has the driver, but {self.library} is missing: {self.remedy}"

    def _in(self, folder: Path) -> str:
        return str(folder / self.library)


def of_this_python() -> Iterator[Path]:
    """Where pip puts libraries: in this environment, and in the user's own site."""
    for scheme in (sysconfig.get_default_scheme(), sysconfig.get_preferred_scheme("user")):
        yield Path(sysconfig.get_path("data", scheme), "lib")


def of_nvidia() -> Iterator[Path]:
    """Where NVIDIA's libraries are: in a container, where its runtime has put them."""
    yield from (Path(folder).absolute() for folder in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep) if folder)
    yield from (*SYSTEM_LIBRARIES, Path("/usr/local/nvidia/lib64"), Path("/run/opengl-driver/lib"))


def of_rocm() -> Iterator[Path]:
    """Where AMD's are: in ROCm's folders, the newest first, or where a distribution has them."""
    for root in (Path("/opt/rocm"), *sorted(Path("/opt").glob("rocm-*"), reverse=True)):
        yield from (root / "lib", root / "opencl/lib")
    yield from SYSTEM_LIBRARIES


# A whole CPU device that needs no root: pip install intel-opencl-rt intel-cmplr-lib-rt. The .icd file that it brings
# holds a path of the machine that built the wheel. No library needs to be loaded beforehand: since 2025.0 the runtime
# finds its neighbours by its own RUNPATH.
INTEL = Driver("intel", "Intel(R) OpenCL", "libintelocl.so", of_this_python)

# Containers get the driver's libraries from the host, but no .icd file.
NVIDIA = Driver(
    "nvidia",
    "NVIDIA CUDA",
    "libnvidia-opencl.so.1",
    of_nvidia,
    kernel=("/proc/driver/nvidia/version", "/dev/nvidiactl", "/dev/nvidia0"),
    remedy="install the part of the driver that has OpenCL (Debian: nvidia-opencl-icd; Ubuntu: libnvidia-compute of "
    "the driver's version); start a container with NVIDIA_DRIVER_CAPABILITIES=compute,utility; or install PoCL with "
    "CUDA (conda-forge: pocl-cuda)",
)

AMD = Driver(
    "amd",
    "AMD Accelerated Parallel Processing",
    "libamdocl64.so",
    of_rocm,
    kernel=("/dev/kfd",),
    remedy="install ROCm's OpenCL (rocm-opencl-runtime; Debian: rocm-opencl-icd), or use Mesa's (mesa-opencl-icd, with "
    "RUSTICL_ENABLE=radeonsi)",
)

DRIVERS = (INTEL, NVIDIA, AMD)

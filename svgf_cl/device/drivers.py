"""The drivers that are often installed without an ``.icd`` file, so that the OpenCL loader does not know of them."""

from __future__ import annotations

import ctypes.util
import os
import platform
import sysconfig
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

# The folders of 64-bit libraries on Debian and on Red Hat.
SYSTEM_LIBRARIES = (Path(f"/usr/lib/{platform.machine()}-linux-gnu"), Path("/usr/lib64"))


@dataclass(frozen=True)
class Driver:
    """A driver, and how to find out whether it is installed.

    Parameters
    ----------
    name : str
        The name of the ``.icd`` file that is written for the driver.
    platform : str
        The OpenCL platform's name.
    library : str
        The library's file name, as ``.icd`` files write it.
    folders : callable
        Returns the folders that may contain the library, the most likely first.
    kernel : tuple of str
        Files that show that the operating system's part of the driver is installed; one of them is enough. If none
        exists, the library is not searched for. Empty for a driver that has no such part.
    remedy : str
        How to install the library if only the operating system's part is there.
    """

    name: str
    platform: str
    library: str
    folders: Callable[[], Iterator[Path]]
    kernel: tuple[str, ...] = ()
    remedy: str = ""

    @property
    def kernel_part(self) -> str | None:
        """The file that shows that the operating system's part is there; None if it is not."""
        return next((path for path in self.kernel if os.path.exists(path)), None)

    def find(self) -> str | None:
        """Return the library's path, or its bare name if only the dynamic linker finds it, or None if it is missing.

        Returns
        -------
        str or None
        """
        if self.kernel and not self.kernel_part:
            return None
        # Not `path.exists()`, which raises an error if a folder belongs to another user, as under sudo.
        found = next((path for path in map(self._in, self.folders()) if os.path.exists(path)), None)
        if found or not self.kernel:
            return found
        return ctypes.util.find_library(self.library.removeprefix("lib").partition(".so")[0])

    def why_missing(self) -> str:
        """Return why the operating system's part cannot be used; empty if it is not there, or the library is there too.

        Returns
        -------
        str
        """
        part = self.kernel_part
        if part is None or self.find():
            return ""
        return f"{part} shows that the system has the driver, but {self.library} is missing: {self.remedy}"

    def _in(self, folder: Path) -> str:
        return str(folder / self.library)


def of_this_python() -> Iterator[Path]:
    """Yield the folders where pip puts libraries: this environment, and the user's own site."""
    for scheme in (sysconfig.get_default_scheme(), sysconfig.get_preferred_scheme("user")):
        yield Path(sysconfig.get_path("data", scheme), "lib")


def of_nvidia() -> Iterator[Path]:
    """Yield the folders that may contain NVIDIA's libraries; in a container its runtime puts them there."""
    yield from (Path(folder).absolute() for folder in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep) if folder)
    yield from (*SYSTEM_LIBRARIES, Path("/usr/local/nvidia/lib64"), Path("/run/opengl-driver/lib"))


def of_rocm() -> Iterator[Path]:
    """Yield the folders that may contain AMD's libraries: ROCm's, the newest first, then the distribution's."""
    for root in (Path("/opt/rocm"), *sorted(Path("/opt").glob("rocm-*"), reverse=True)):
        yield from (root / "lib", root / "opencl/lib")
    yield from SYSTEM_LIBRARIES


# A CPU device that can be installed without root: pip install intel-opencl-rt intel-cmplr-lib-rt. The .icd file in the
# wheel holds a path of the machine that built the wheel. Since 2025.0 the runtime finds its other libraries by its own
# RUNPATH, so nothing needs to be loaded before it.
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

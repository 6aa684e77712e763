"""Runs Open Image Denoise (OIDN) on the CPU, with the library in the package pyoidn."""

from __future__ import annotations

import os
from importlib.metadata import version

import numpy as np
import numpy.typing as npt
import pyopencl as cl

from svgf_cl import Frame
from svgf_cl.errors import SvgfError, install_extra
from svgf_cl.frame import Shape

QUALITIES = ("high", "balanced", "fast")
INPUTS, OUTPUT = ("color", "albedo", "normal"), "output"  # OIDN's names; `Frame` has the same names of inputs


class OidnFilter:
    """OIDN's filter for path-traced HDR light with albedo and normal.

    The constructor runs it once, so that later runs take a steady time. It reads the images that `load` fills in place,
    without a copy.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    quality : str
        One of `QUALITIES`.
    threads : int
        >= 1; OIDN uses no more threads than there are cores.
    clean_aux : bool
        Tell OIDN that albedo and normal are free of noise. Only then does "high" use a larger network than "balanced".

    Attributes
    ----------
    nbytes : int
        Memory that OIDN uses in addition to the images, in bytes: how much the process grew.

    Raises
    ------
    SvgfError
        If a package is missing, or OIDN reports an error.
    """

    def __init__(self, shape: Shape, quality: str, threads: int, *, clean_aux: bool = False) -> None:
        require_oidn()
        import psutil
        import pyoidn

        process = psutil.Process()
        # Ones, not empty: memory counts only after it was first written to.
        self._images = {name: np.ones((*shape, 3), np.float32) for name in (*INPUTS, OUTPUT)}
        before = process.memory_info().rss
        self._device = pyoidn.Device(
            pyoidn.OIDN_DEVICE_TYPE_CPU
        )  # one for each filter; else filters would share memory
        self._device.set_int("numThreads", threads)
        self._device.commit()
        self._filter = pyoidn.Filter(self._device, pyoidn.OIDN_FILTER_TYPE_RT)
        for name, image in self._images.items():
            self._filter.set_image(name, image, pyoidn.OIDN_FORMAT_FLOAT3)
        self._filter.set_bool("hdr", True)
        self._filter.set_bool("cleanAux", clean_aux)
        self._filter.set_quality(getattr(pyoidn, f"OIDN_QUALITY_{quality.upper()}"))
        self._filter.commit()
        self.execute()
        self.check()
        self.nbytes: int = process.memory_info().rss - before

    def load(self, frame: Frame) -> None:
        """Copy the fields of `frame` that the filter reads; without albedo, surfaces are white."""
        for name in INPUTS:
            given = getattr(frame, name)
            self._images[name][:] = 1.0 if given is None else given

    def execute(self) -> None:
        """Filter the loaded frame, and wait until it is done."""
        self._filter.execute()

    def check(self) -> None:
        """Raise `SvgfError` if OIDN has reported an error since the last check."""
        if complaint := self._device.get_error():
            raise SvgfError(f"Open Image Denoise: {complaint}")

    def denoise(self, frame: Frame) -> npt.NDArray[np.float32]:
        """Filter one frame, and return a copy of the result, (H, W, 3)."""
        self.load(frame)
        self.execute()
        return self.result()

    def result(self) -> npt.NDArray[np.float32]:
        """Return a copy of the last result, (H, W, 3)."""
        self.check()
        result: npt.NDArray[np.float32] = self._images[OUTPUT].copy()
        return result

    @property
    def description(self) -> str:
        """Versions of the library and of the package around it, and how many threads it uses."""
        numbers = [str(self._device.get_int(f"version{part}")) for part in ("Major", "Minor", "Patch")]
        threads = self._device.get_int("numThreads")
        return f"{'.'.join(numbers)} (pyoidn {version('pyoidn')}), {threads} threads"


def threads_beside(device: cl.Device) -> int:
    """Return the number of threads of a CPU device; if `device` is no CPU, that of the whole machine."""
    is_cpu = bool(device.type & cl.device_type.CPU)
    return device.max_compute_units if is_cpu else os.cpu_count() or 1


def require_oidn() -> None:
    """Raise `SvgfError`, with the command that installs them, if pyoidn or psutil is missing."""
    try:
        import psutil  # noqa: F401
        import pyoidn  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"Open Image Denoise is missing ({error}): {install_extra('oidn')}") from error

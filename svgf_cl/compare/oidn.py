"""Open Image Denoise on the CPU, through the library that pyoidn brings."""

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
INPUTS, OUTPUT = ("color", "albedo", "normal"), "output"  # OIDN's names; those of `Frame`, too


class OidnFilter:
    """OIDN's filter for path-traced HDR light with albedo and normal, set up and run once: what follows is steady.

    It reads and writes in place, without a copy, images that `load` fills.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    quality : str
        One of `QUALITIES`.
    threads : int
        >= 1; OIDN takes no more than there are cores.
    clean_aux : bool
        Tell it that albedo and normal are free of noise. "high" is a larger network then; else it is "balanced".

    Attributes
    ----------
    nbytes : int
        What the process grew by: what OIDN holds beside the images.

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
        # Ones, not empty: memory counts from when it is first written to.
        self._images = {name: np.ones((*shape, 3), np.float32) for name in (*INPUTS, OUTPUT)}
        before = process.memory_info().rss
        self._device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)  # one a filter, or they would share their memory
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
        """Copy in what the filter reads of `frame`; without albedo, surfaces are white."""
        for name in INPUTS:
            given = getattr(frame, name)
            self._images[name][:] = 1.0 if given is None else given

    def execute(self) -> None:
        """Filter what was loaded; wait for the end."""
        self._filter.execute()

    def check(self) -> None:
        """Raise `SvgfError` where OIDN has reported an error since the last look."""
        if complaint := self._device.get_error():
            raise SvgfError(f"Open Image Denoise: {complaint}")

    def denoise(self, frame: Frame) -> npt.NDArray[np.float32]:
        """Filter one frame; return the result, (H, W, 3), in memory of its own."""
        self.load(frame)
        self.execute()
        return self.result()

    def result(self) -> npt.NDArray[np.float32]:
        """What was made last, (H, W, 3), in memory of its own."""
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
    """As many threads as a CPU device has; all where `device` is no CPU."""
    is_cpu = bool(device.type & cl.device_type.CPU)
    return device.max_compute_units if is_cpu else os.cpu_count() or 1


def require_oidn() -> None:
    """Raise `SvgfError`, with the command that installs them, where pyoidn or psutil is missing."""
    try:
        import psutil  # noqa: F401
        import pyoidn  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"Open Image Denoise is missing ({error}): {install_extra('oidn')}") from error

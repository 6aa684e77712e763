"""Open Image Denoise on the CPU, through the library that pyoidn brings."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
import numpy.typing as npt

from svgf_cl import Frame
from svgf_cl.errors import SvgfError
from svgf_cl.frame import Shape

QUALITIES = ("high", "balanced", "fast")


class Images:
    """Memory that filters read and write in place, without a copy: (H, W, 3) float32 each.

    Parameters
    ----------
    shape : (int, int)
        (height, width) in pixels.
    """

    def __init__(self, shape: Shape) -> None:
        # Written to at once, or the first filter to touch it would seem to take that memory.
        self.color, self.albedo, self.normal, self.output = (np.ones((*shape, 3), np.float32) for _ in range(4))

    def load(self, frame: Frame) -> None:
        """Copy in what a filter reads of `frame`, which must have color and albedo."""
        self.color[:], self.albedo[:], self.normal[:] = frame.color, frame.albedo, frame.normal


class Filter:
    """OIDN's filter for path-traced HDR light with albedo and normal, set up and run once: what follows is steady.

    Parameters
    ----------
    images : Images
        What it reads and writes.
    quality : str
        One of `QUALITIES`.
    threads : int
        >= 1; OIDN takes no more than there are cores.
    clean_aux : bool
        Tell it that albedo and normal are free of noise; "high" is a larger network then, and "balanced" without.

    Attributes
    ----------
    nbytes : int
        What the process grew by: what OIDN holds beside `images`.

    Raises
    ------
    SvgfError
        If a package is missing, or OIDN reports an error.
    """

    def __init__(self, images: Images, quality: str, threads: int, *, clean_aux: bool = False) -> None:
        require_oidn()
        import psutil
        import pyoidn

        process = psutil.Process()
        before = process.memory_info().rss
        self.images = images
        self._device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)  # one a filter, or they would share their memory
        self._device.set_int("numThreads", threads)
        self._device.commit()
        self._filter = pyoidn.Filter(self._device, pyoidn.OIDN_FILTER_TYPE_RT)
        for name, image in vars(images).items():
            self._filter.set_image(name, image, pyoidn.OIDN_FORMAT_FLOAT3)
        self._filter.set_bool("hdr", True)
        self._filter.set_bool("cleanAux", clean_aux)
        self._filter.set_quality(getattr(pyoidn, f"OIDN_QUALITY_{quality.upper()}"))
        self._filter.commit()
        self.execute()
        self.check()
        self.nbytes: int = process.memory_info().rss - before

    def execute(self) -> None:
        """Filter what is in `images`; wait for the end."""
        self._filter.execute()

    def check(self) -> None:
        """Raise `SvgfError` where OIDN has reported an error since the last look."""
        if complaint := self._device.get_error():
            raise SvgfError(f"Open Image Denoise: {complaint}")

    def denoise(self, frame: Frame) -> npt.NDArray[np.float32]:
        """Filter one frame; return the result, (H, W, 3), in memory of its own."""
        self.images.load(frame)
        self.execute()
        self.check()
        result: npt.NDArray[np.float32] = self.images.output.copy()
        return result

    @property
    def description(self) -> str:
        """Versions of the library and of the package around it, and how many threads it uses."""
        numbers = [str(self._device.get_int(f"version{part}")) for part in ("Major", "Minor", "Patch")]
        threads = self._device.get_int("numThreads")
        return f"{'.'.join(numbers)} (pyoidn {version('pyoidn')}), {threads} threads"


def require_oidn() -> None:
    """Raise `SvgfError`, with the command that installs them, where pyoidn or psutil is missing."""
    try:
        import psutil  # noqa: F401
        import pyoidn  # noqa: F401
    except ModuleNotFoundError as error:
        raise SvgfError(f"Open Image Denoise is missing ({error}): pip install '.[oidn]' in a clone") from error

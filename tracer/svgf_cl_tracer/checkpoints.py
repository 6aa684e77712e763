"""Estimates stored on disk while they are rendered; continuing one gives the same bits as an uninterrupted run.

The name of a file is the number of the frame and the samples per pixel, ``0007.000512.npz``. It holds the arrays of an
`Estimate`. They are not compressed, because noise is not compressible, and the zip archive has checksums.
"""

from __future__ import annotations

import warnings
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from svgf_cl.io.atomic import output_folder, written_whole
from svgf_cl.io.cache import keeping

from .estimate import Estimate, Step
from .vectors import Float32

# Errors of reading a damaged file. A RuntimeError is raised if it seems to be encrypted or to have another version of
# zip, and a MemoryError if it claims to be larger than it is.
DAMAGE = (
    EOFError,
    IndexError,
    KeyError,
    MemoryError,
    OSError,
    RuntimeError,
    ValueError,
    zipfile.BadZipFile,
    zlib.error,
)


@dataclass(frozen=True)
class Checkpoints:
    """The stored estimates of one frame.

    Parameters
    ----------
    folder : Path
        The folder of the files of this and other frames; it is created with the first file.
    number : int
        The number of the frame.
    """

    folder: Path
    number: int

    def latest(self, start: Estimate, usable: Callable[[Estimate], bool]) -> Estimate:
        """The usable estimate with the most samples; `start`, which has no samples, if there is none.

        A damaged file is deleted with a warning.
        """
        for path in sorted(self.folder.glob(f"{self.number:04d}.*.npz"), reverse=True):
            estimate = _read(path, start)
            if estimate and usable(estimate):
                return estimate
        return start

    def replace(self, old: Estimate, new: Estimate) -> None:
        """Write `new` completely or not at all, then delete `old`, from which it was made.

        If writing fails, `old` stays.
        """
        history = np.array(new.history, np.float64).reshape(-1, 2)
        with keeping():
            output_folder(self.folder)
            with written_whole(self._path(new)) as aside, aside.open("wb") as file:
                np.savez(file, light=new.light, squares=new.squares, history=history)
            self._path(old).unlink(missing_ok=True)

    def _path(self, estimate: Estimate) -> Path:
        return self.folder / f"{self.number:04d}.{estimate.spp:06d}.npz"


def _read(path: Path, start: Estimate) -> Estimate | None:
    """The estimate in a file, with the shapes of `start`; None if it cannot be used or has just been replaced."""
    try:
        with np.load(path) as file:
            light, squares = _array(file, "light", start.light), _array(file, "squares", start.squares)
            history = tuple(Step(int(spp), float(variance)) for spp, variance in file["history"])
        return Estimate(history[-1].spp, light, squares, history)
    except FileNotFoundError:
        return None
    except DAMAGE as error:
        warnings.warn(f"{path}: damaged ({error}); deleted, its samples are rendered again", stacklevel=4)
        path.unlink(missing_ok=True)
        return None


def _array(file: Mapping[str, Float32], name: str, like: Float32) -> Float32:
    """The array `name`; `ValueError` unless it has the shape of `like`."""
    array = file[name]
    if (array.shape, array.dtype) != (like.shape, like.dtype):
        raise ValueError(f"{name}: expected {like.dtype} of shape {like.shape}, got {array.dtype} of {array.shape}")
    return array

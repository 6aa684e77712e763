"""Estimates kept on disk while they grow: whoever goes on with one gets, bit by bit, what a single run would have got.

A file is named for the frame and its samples per pixel, ``0007.000512.npz``, and holds the arrays of an `Estimate`, not
compressed (noise does not shrink), under the checksums of a zip archive.
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

# What reading a damaged file raises: a RuntimeError where it claims to be encrypted or of another version of zip, a
# MemoryError where it claims to be larger than it is.
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
    """The kept estimates of one frame.

    Parameters
    ----------
    folder : Path
        Where they lie, beside those of other frames; made when the first is written.
    number : int
        The frame.
    """

    folder: Path
    number: int

    def latest(self, start: Estimate, usable: Callable[[Estimate], bool]) -> Estimate:
        """The one of most samples among the usable ones; `start`, which has none, if there is no other.

        A file that is damaged is deleted, with a warning.
        """
        for path in sorted(self.folder.glob(f"{self.number:04d}.*.npz"), reverse=True):
            estimate = _read(path, start)
            if estimate and usable(estimate):
                return estimate
        return start

    def replace(self, old: Estimate, new: Estimate) -> None:
        """Write `new`, whole or not at all, and delete `old`, which it was made from; where that fails, `old` stays."""
        history = np.array(new.history, np.float64).reshape(-1, 2)
        with keeping():
            output_folder(self.folder)
            with written_whole(self._path(new)) as aside, aside.open("wb") as file:
                np.savez(file, light=new.light, squares=new.squares, history=history)
            self._path(old).unlink(missing_ok=True)

    def _path(self, estimate: Estimate) -> Path:
        return self.folder / f"{self.number:04d}.{estimate.spp:06d}.npz"


def _read(path: Path, start: Estimate) -> Estimate | None:
    """The estimate in a file, shaped as `start`; None where it cannot be used or has just been replaced."""
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
    """The array `name`; `ValueError` unless it is shaped as `like`."""
    array = file[name]
    if (array.shape, array.dtype) != (like.shape, like.dtype):
        raise ValueError(f"{name}: expected {like.dtype} of shape {like.shape}, got {array.dtype} of {array.shape}")
    return array

"""Runs frames through the device."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from svgf_cl import Denoiser, Frame, Settings, Tuning
from svgf_cl.device import tuning
from svgf_cl.filters.filter import Filter

# The tuning of tests of what is around the kernels: PoCL compiles its kernels in half the time of the default's.
NARROW = Tuning(vector_width=4, work_group=(16, 1))


def feed(*frames: Frame, kind: type[Filter] = Settings, **chosen: Any) -> tuple[np.ndarray, Denoiser]:
    """Denoise a sequence with these settings: the last picture, and the denoiser with all stages of that frame."""
    den = Denoiser(frames[0].shape, settings=kind(**chosen), keep_stages=True)
    return [den.denoise(frame) for frame in frames][-1], den


@pytest.fixture(scope="module", autouse=True)
def narrow_vectors() -> Iterator[None]:
    """`NARROW` vectors.

    tests/kernels and tests/hard test the kernels with the width that a device is given by default.
    """
    with vector_width(NARROW.vector_width):
        yield


@contextmanager
def vector_width(width: int | None, exponential: str = "polynomial") -> Iterator[None]:
    """Denoisers made inside treat so many pixels as one vector; None leaves it to the device."""
    with pytest.MonkeyPatch.context() as patch:
        if width:
            chosen = Tuning(vector_width=width, work_group=(16, 1), exponential=exponential)
            patch.setattr(tuning, "default_tuning", lambda device: chosen)
        yield

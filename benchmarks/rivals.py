"""What is compared: filters by their settings, and what they are held against, all with one method, `denoise`."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from svgf_cl import Denoiser, Frame
from svgf_cl.cli.options import parse_settings
from svgf_cl.compare.oidn import OidnFilter, threads_beside
from svgf_cl.errors import SvgfError
from svgf_cl.filters import FILTERS, Eaw
from svgf_cl.filters.filter import Filter
from svgf_cl.frame import Shape
from svgf_cl.io.display import Linear
from svgf_cl.oracle.temporal import demodulate, modulate

# As written behind --filter: the paper's SVGF, then every filter with its default settings.
USUAL = ("svgf,taps=5x5", *FILTERS)
NOISY, ACCUMULATED, OIDN = "noisy", "accumulated", "OIDN high"


class Maker(Protocol):
    """Makes pictures of consecutive frames."""

    def denoise(self, frame: Frame) -> Any:
        """The picture of the next frame, (H, W, 3)."""


class Noisy:
    """Does nothing."""

    def denoise(self, frame: Frame) -> Linear:
        """The frame's colour."""
        return np.asarray(frame.color)


class Accumulated:
    """Accumulates light over time, and does nothing else: EAW before its levels, whose history no level touches."""

    def __init__(self, shape: Shape) -> None:
        self._eaw = Denoiser(shape, settings=Eaw(iterations=1))

    def denoise(self, frame: Frame) -> Linear:
        """The mean of the past, with albedo and emission."""
        self._eaw.denoise(frame)
        _, guides = demodulate(frame)
        return modulate(self._eaw.stage("accumulated").astype(np.float64), guides)


@dataclass
class Rival:
    """Something that makes pictures, and how long it took for each.

    Parameters
    ----------
    maker : Maker
    call, device : list of float, ms
        The whole call with numpy arrays in and out, and the sum of its passes from OpenCL events, where it has any.
    """

    maker: Maker
    call: list[float] = field(default_factory=list)
    device: list[float] = field(default_factory=list)

    def denoise(self, frame: Frame) -> Linear:
        """The picture of the next frame."""
        begin = time.perf_counter()
        picture: Linear = self.maker.denoise(frame)
        self.call.append(1e3 * (time.perf_counter() - begin))
        if isinstance(self.maker, Denoiser):
            self.device.append(sum(self.maker.profile().values()))
        return picture


def rivals(filters: Mapping[str, Filter], shape: Shape, *, oidn: bool) -> dict[str, Rival]:
    """All that takes part, by the names of the rows."""
    denoisers = {name: Denoiser(shape, settings=settings) for name, settings in filters.items()}
    makers: dict[str, Maker] = {NOISY: Noisy(), ACCUMULATED: Accumulated(shape), **denoisers}
    if oidn:
        device = next(iter(denoisers.values())).queue.device
        makers[OIDN] = OidnFilter(shape, "high", threads_beside(device))
    return {name: Rival(maker) for name, maker in makers.items()}


def parse_filters(texts: Sequence[str]) -> dict[str, Filter]:
    """Read ``svgf,taps=5x5`` and the like; `SvgfError` for a wrong name or value."""
    if len(set(texts)) < len(texts):
        raise SvgfError(f"--filter: expected each filter once, got {' '.join(texts)}")
    split = {text: text.split(",") for text in texts}
    return {text: parse_settings(name, settings) for text, (name, *settings) in split.items()}


def antialiased(texts: Sequence[str]) -> list[str]:
    """The filters of `texts`, then, with it, those that can have temporal antialiasing and are without."""
    without = (text for text, each in parse_filters(texts).items() if getattr(each, "taa", None) is False)
    return [*texts, *(f"{text},taa=on" for text in without)]

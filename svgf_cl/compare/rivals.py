"""The rivals of a comparison: this project's filters, Open Image Denoise and the noisy input, all with `denoise`."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from svgf_cl.compare.oidn import OidnFilter, require_oidn, threads_beside
from svgf_cl.denoiser import Denoiser
from svgf_cl.device.devices import default_device
from svgf_cl.errors import SvgfError
from svgf_cl.filters import FILTERS, Accumulation
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.temporal import TemporalFilter
from svgf_cl.frame import Frame, Shape
from svgf_cl.io.display import Linear

OIDN, OIDN_ACCUMULATED = "oidn", "oidn+accumulation"
OTHERS = (OIDN, OIDN_ACCUMULATED)  # rivals that are not filters of this project


# Makes a filter from its name, its settings as texts, and the option that contained them (for errors).
Parser = Callable[[str, Sequence[str], str], Filter]


class Maker(Protocol):
    """Makes pictures of consecutive frames; `milliseconds` is its filter's time for the last one, without transfers."""

    milliseconds: float | None

    def denoise(self, frame: Frame) -> Linear:
        """Return the picture of the next frame, (H, W, 3)."""


class Noisy:
    """The noisy frames, unchanged."""

    milliseconds: float | None = None

    def denoise(self, frame: Frame) -> Linear:
        """Return the frame's colour."""
        return np.asarray(frame.color)


class Filtered:
    """A filter of this project; its time is the sum of its passes on the device."""

    milliseconds: float | None = None

    def __init__(self, shape: Shape, settings: Filter) -> None:
        self._denoiser = Denoiser(shape, settings=settings)

    def denoise(self, frame: Frame) -> Linear:
        """Run the filter."""
        picture: Linear = self._denoiser.denoise(frame)
        self.milliseconds = sum(self._denoiser.profile().values())
        return picture


class FrameByFrame:
    """Open Image Denoise, quality "high", each frame by itself; its time is that of the filter's call."""

    milliseconds: float | None = None

    def __init__(self, shape: Shape) -> None:
        self._filter = OidnFilter(shape, "high", threads_beside(default_device()))

    def denoise(self, frame: Frame) -> Linear:
        """Run Open Image Denoise; infinite pixels are set to black, as they would spoil the whole picture."""
        color = np.asarray(frame.color)
        self._filter.load(replace(frame, color=np.where(np.isfinite(color), color, 0.0)))
        begin = time.perf_counter()
        self._filter.execute()
        self.milliseconds = 1e3 * (time.perf_counter() - begin)
        return self._filter.result()


class FrameByFrameAccumulated:
    """Open Image Denoise, quality "high", and then temporal accumulation of its pictures, like noisy light."""

    milliseconds: float | None = None

    def __init__(self, shape: Shape, settings: Accumulation) -> None:
        self._first, self._then = FrameByFrame(shape), Filtered(shape, settings)

    def denoise(self, frame: Frame) -> Linear:
        """Run both."""
        color = np.asarray(self._first.denoise(frame), np.float32)
        picture = self._then.denoise(replace(frame, color=color, direct=None, indirect=None))
        self.milliseconds = sum(each.milliseconds or 0.0 for each in (self._first, self._then))
        return picture


@dataclass(frozen=True)
class Rival:
    """A rival, as the user's text describes it.

    Parameters
    ----------
    name : str
    settings : Filter, optional
        The filter's settings; None for `OTHERS`.
    says_taa : bool
        Whether the text turns temporal antialiasing on or off.
    """

    name: str
    settings: Filter | None
    says_taa: bool = False

    def maker(self, shape: Shape, *, jitter: bool) -> Maker:
        """Make the rival for frames of a size; with `jitter` filters antialias over time, unless the text sets it."""
        if self.settings is not None:
            return Filtered(shape, antialiased(self.settings) if jitter and not self.says_taa else self.settings)
        if self.name == OIDN:
            return FrameByFrame(shape)
        return FrameByFrameAccumulated(shape, Accumulation(taa=jitter))


def antialiased(settings: Filter) -> Filter:
    """Return the filter with temporal antialiasing, if it has such a setting."""
    return replace(settings, taa=True) if isinstance(settings, TemporalFilter) else settings


def parse_rivals(text: str, parse: Parser) -> list[Rival]:
    """Read a text such as ``svgf,taps=5x5,eaw,oidn``: names, each followed by its settings.

    Parameters
    ----------
    text : str
    parse : Parser

    Raises
    ------
    SvgfError
        For an unknown name or setting, a rival that occurs twice, or Open Image Denoise if it is not installed.
    """
    split: list[list[str]] = []
    for part in text.split(","):
        if "=" in part and split:
            split[-1].append(part)
        else:
            split.append([part])
    names = [",".join(parts) for parts in split]
    if len(set(names)) < len(names):
        raise SvgfError(f"--filters: expected each filter once, got {text}")
    return [rival(name, parts, parse) for name, parts in zip(names, split, strict=True)]


def rival(name: str, parts: Sequence[str], parse: Parser) -> Rival:
    """Return one rival from its name and settings."""
    kind, *settings = parts
    if kind in OTHERS:
        if settings:
            raise SvgfError(f"--filters: expected no settings of {kind}, got {','.join(settings)}")
        require_oidn()
        return Rival(name, None)
    if kind not in FILTERS:
        raise SvgfError(f"--filters: expected names among {', '.join((*FILTERS, *OTHERS))}, got {kind!r}")
    says_taa = any(text.startswith("taa=") for text in settings)
    return Rival(name, parse(kind, settings, "--filters"), says_taa)


def usual_rivals() -> str:
    """Return the default rivals: all filters, and Open Image Denoise if it is installed."""
    try:
        require_oidn()
    except SvgfError:
        return ",".join(FILTERS)
    return ",".join((*FILTERS, *OTHERS))


def makers(rivals: Sequence[Rival], shape: Shape, *, jitter: bool) -> Mapping[str, Maker]:
    """Make all rivals for frames of a size, by name."""
    return {each.name: each.maker(shape, jitter=jitter) for each in rivals}

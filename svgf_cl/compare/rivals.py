"""What is compared: filters by their settings, and what they are held against, all with one method, `denoise`."""

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
OTHERS = (OIDN, OIDN_ACCUMULATED)  # beside the filters


Parser = Callable[[str, Sequence[str], str], Filter]  # of a name, settings as texts, and the option they came by


class Maker(Protocol):
    """Makes pictures of consecutive frames; `milliseconds` is what its filter took for the last, without transfers."""

    milliseconds: float | None

    def denoise(self, frame: Frame) -> Linear:
        """The picture of the next frame, (H, W, 3)."""


class Noisy:
    """The frames as they come in."""

    milliseconds: float | None = None

    def denoise(self, frame: Frame) -> Linear:
        """The frame's colour."""
        return np.asarray(frame.color)


class Filtered:
    """A filter of this project; its time is that of its passes on the device."""

    milliseconds: float | None = None

    def __init__(self, shape: Shape, settings: Filter) -> None:
        self._denoiser = Denoiser(shape, settings=settings)

    def denoise(self, frame: Frame) -> Linear:
        """Run the filter."""
        picture: Linear = self._denoiser.denoise(frame)
        self.milliseconds = sum(self._denoiser.profile().values())
        return picture


class FrameByFrame:
    """Open Image Denoise, quality "high", each frame by itself; its time is that of the call that filters."""

    milliseconds: float | None = None

    def __init__(self, shape: Shape) -> None:
        self._filter = OidnFilter(shape, "high", threads_beside(default_device()))

    def denoise(self, frame: Frame) -> Linear:
        """Run Open Image Denoise; an infinite pixel, which would spoil the whole picture, comes in black."""
        color = np.asarray(frame.color)
        self._filter.load(replace(frame, color=np.where(np.isfinite(color), color, 0.0)))
        begin = time.perf_counter()
        self._filter.execute()
        self.milliseconds = 1e3 * (time.perf_counter() - begin)
        return self._filter.result()


class FrameByFrameAccumulated:
    """Open Image Denoise, quality "high", whose pictures are accumulated over time like noisy light."""

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
    """Something that takes part, by the text that asks for it.

    Parameters
    ----------
    name : str
    settings : Filter, optional
        Of a filter; None for `OTHERS`.
    says_taa : bool
        Whether the text says if there is to be temporal antialiasing.
    """

    name: str
    settings: Filter | None
    says_taa: bool = False

    def maker(self, shape: Shape, *, jitter: bool) -> Maker:
        """Make it for frames of a size; with `jitter` filters antialias over time, unless the text says otherwise."""
        if self.settings is not None:
            return Filtered(shape, antialiased(self.settings) if jitter and not self.says_taa else self.settings)
        if self.name == OIDN:
            return FrameByFrame(shape)
        return FrameByFrameAccumulated(shape, Accumulation(taa=jitter))


def antialiased(settings: Filter) -> Filter:
    """The same filter with temporal antialiasing, if it has any."""
    return replace(settings, taa=True) if isinstance(settings, TemporalFilter) else settings


def parse_rivals(text: str, parse: Parser) -> list[Rival]:
    """Read ``svgf,taps=5x5,eaw,oidn``: names, each followed by the settings that it is to have.

    Parameters
    ----------
    text : str
    parse : Parser

    Raises
    ------
    SvgfError
        For an unknown name or setting, a rival that is there twice, or Open Image Denoise where it is not installed.
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
    """One rival from its name and settings."""
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
    """Who takes part where nobody says so: all filters, and Open Image Denoise where it is installed."""
    try:
        require_oidn()
    except SvgfError:
        return ",".join(FILTERS)
    return ",".join((*FILTERS, *OTHERS))


def makers(rivals: Sequence[Rival], shape: Shape, *, jitter: bool) -> Mapping[str, Maker]:
    """All rivals for frames of a size, by name."""
    return {each.name: each.maker(shape, jitter=jitter) for each in rivals}

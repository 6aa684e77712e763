"""Limits of a comparison: it fails if a value is below or above them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from svgf_cl.compare.measures import MEASURES, Measure
from svgf_cl.compare.page import Scene
from svgf_cl.errors import SvgfError
from svgf_cl.gate import Check

KNOWN = {each.key: each for each in MEASURES}
OF_EACH_FRAME = ("psnr", "ssim", "flip", "relmse")  # not the temporal error, which needs two frames


@dataclass(frozen=True)
class Limits:
    """Least and greatest values, by the key of a measure."""

    least: Mapping[str, float]
    most: Mapping[str, float]

    @classmethod
    def parse(cls, below: str, above: str) -> Limits:
        """Read the texts of ``--fail-below`` and ``--fail-above``, as ``psnr=30,ssim=0.9``.

        Raises
        ------
        SvgfError
            If a text has another form, or names an unknown measure.
        """
        return cls(parsed("--fail-below", below), parsed("--fail-above", above))

    def __bool__(self) -> bool:
        return bool(self.least or self.most)

    def checks(self, scene: Scene, rival: str, *, each_frame: bool = False) -> Iterator[Check]:
        """Yield one check for each limit, of a rival's values in a scene; a value that was not measured fails.

        With `each_frame`, a measure of `OF_EACH_FRAME` has one check for each frame instead.
        """
        (entry,) = [each for each in scene.entries if each.rival == rival]
        for side, limits in (("below", self.least), ("above", self.most)):
            for key, limit in limits.items():
                found = {f"{scene.name}.{rival}": entry.values.get(key)}
                if each_frame and key in OF_EACH_FRAME:
                    values = zip(scene.frames, entry.curves[key], strict=True)
                    found = {f"{scene.name} {number}": value for number, value in values}
                for group, value in found.items():
                    yield Check(key, group, complaint(KNOWN[key], value, side, limit))


def is_beyond(value: float, side: str, limit: float) -> bool:
    """Whether a value is on the wrong side of a limit."""
    return value < limit if side == "below" else value > limit


def complaint(measure: Measure, value: float | None, side: str, limit: float) -> str:
    """Return what is wrong with a value; empty if nothing is."""
    if value is None or math.isnan(value):
        return f"{measure.title} was not measured: pixels are NaN, or the frames show nothing that it measures"
    if not is_beyond(value, side, limit):
        return ""
    unit = f" {measure.unit}" if measure.unit else ""
    bound = f"{100 * limit:g}%" if measure.spec.endswith("%") else f"{limit:g}"
    return f"{measure.title} {measure.spell(value)}{unit} is {side} {bound}{unit}"


def parsed(option: str, text: str) -> dict[str, float]:
    """Read ``psnr=30,ssim=0.9``."""
    found: dict[str, float] = {}
    for part in filter(None, text.split(",")):
        key, _, number = part.partition("=")
        if key not in KNOWN:
            raise SvgfError(f"{option}: expected MEASURE=NUMBER with a measure among {', '.join(KNOWN)}, got {part!r}")
        if key in found:
            raise SvgfError(f"{option}: expected each measure once, got {key} twice")
        try:
            found[key] = float(number)
        except ValueError as error:
            raise SvgfError(f"{option} {key}: expected a number, got {number!r}") from error
        if math.isnan(found[key]):
            raise SvgfError(f"{option} {key}: expected a number, got nan")
    return found

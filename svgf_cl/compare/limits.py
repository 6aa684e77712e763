"""Limits that a comparison is held to: below or above them it fails."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from svgf_cl.compare.measures import MEASURES
from svgf_cl.compare.page import Scene
from svgf_cl.errors import SvgfError
from svgf_cl.gate import Check

TITLES = {each.key: each for each in MEASURES}


@dataclass(frozen=True)
class Limits:
    """Least and greatest values, by the key of a measure."""

    least: Mapping[str, float]
    most: Mapping[str, float]

    @classmethod
    def parse(cls, below: str, above: str) -> Limits:
        """Read ``psnr=30,ssim=0.9`` of ``--fail-below`` and ``--fail-above``; `SvgfError` for what is none."""
        return cls(parsed("--fail-below", below), parsed("--fail-above", above))

    def __bool__(self) -> bool:
        return bool(self.least or self.most)

    def checks(self, scene: Scene, rival: str, *, each_frame: bool = False) -> Iterator[Check]:
        """One check for each limit, of what a rival made of a scene; what was not measured fails.

        With `each_frame`, one for each frame too, of the measures that every frame has.
        """
        (entry,) = [each for each in scene.entries if each.rival == rival]
        for side, limits in (("below", self.least), ("above", self.most)):
            for key, limit in limits.items():
                curve = entry.curves.get(key, ()) if each_frame else ()
                found = {f"{scene.name}.{rival}": entry.values.get(key)} if not curve else {}
                found |= {f"{scene.name} {number}": value for number, value in zip(scene.frames, curve, strict=False)}
                for group, value in found.items():
                    yield Check(key, group, complaint(key, value, side, limit))


def is_beyond(value: float, side: str, limit: float) -> bool:
    """Whether a value misses a limit; NaN misses all."""
    return not (value >= limit if side == "below" else value <= limit)


def complaint(key: str, value: float | None, side: str, limit: float) -> str:
    """What is wrong with a value; empty where nothing is."""
    measure = TITLES[key]
    if value is None or math.isnan(value):
        return f"{measure.title} was not measured: the frames show nothing it is about"
    return f"{measure.title} {format(value, measure.spec)} is {side} {limit:g}" if is_beyond(value, side, limit) else ""


def parsed(option: str, text: str) -> dict[str, float]:
    """Read ``psnr=30,ssim=0.9``."""
    found = {}
    for part in filter(None, text.split(",")):
        key, _, number = part.partition("=")
        if key not in TITLES:
            raise SvgfError(
                f"{option}: expected MEASURE=NUMBER with a measure out of {', '.join(TITLES)}, got {part!r}"
            )
        try:
            found[key] = float(number)
        except ValueError as error:
            raise SvgfError(f"{option} {key}: expected a number, got {number!r}") from error
        if math.isnan(found[key]):
            raise SvgfError(f"{option} {key}: expected a number, got nan")
    return found

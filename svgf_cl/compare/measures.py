"""The measures of `Findings`: their titles, units and formats, their order, and which value is best."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan

from svgf_cl.compare.judge import Findings


@dataclass(frozen=True)
class Measure:
    """A measure of pictures: a column of the tables, and a set of curves.

    Parameters
    ----------
    key : str
        Its key in `value` and `Judge.curves`.
    title : str
    unit : str
        May be empty.
    spec : str
        Python's format of a value, such as ``.2f``; a format that ends in % writes a percentage.
    sign : int
        1 if more is better, -1 if less is better, else 0.
    ideal : float or None
        The best value, if there is one. The sign does not matter then.
    meaning : str
        One sentence.
    """

    key: str
    title: str
    unit: str
    spec: str
    sign: int
    ideal: float | None
    meaning: str

    @property
    def aim(self) -> str:
        """The good values, in words; empty if no value is better than another."""
        if self.ideal is not None:
            return f"nearest to {self.ideal:g} is best"
        return {1: "more is better", -1: "less is better"}.get(self.sign, "")

    @property
    def arrow(self) -> str:
        """The same as a symbol, for the head of a column."""
        if self.ideal is not None:
            return f"→ {self.ideal:g}"
        return {1: "↑", -1: "↓"}.get(self.sign, "")

    @property
    def name(self) -> str:
        """Title and unit."""
        return f"{self.title}, {self.unit}" if self.unit else self.title

    def merit(self, value: float) -> float:
        """Return how good a value is; more is better."""
        return self.sign * value if self.ideal is None else -abs(value - self.ideal)

    def spell(self, value: float) -> str:
        """Return a value as text."""
        return format(value, self.spec).replace("inf", "∞")


MEASURES = (
    Measure("psnr", "PSNR", "dB", ".2f", 1, None, "error as shown"),
    Measure("ssim", "SSIM", "", ".3f", 1, None, "structure as shown"),
    Measure("flip", "FLIP", "", ".4f", -1, None, "difference seen when flipping between picture and truth"),
    Measure("relmse", "relMSE", "", ".4f", -1, None, "error of light relative to the truth; bright dots count most"),
    Measure("relmse_trimmed", "relMSE 99 %", "", ".4f", -1, None, "the same without the worst hundredth of the pixels"),
    Measure("bias", "bias", "", "+.1%", 0, 0.0, "too much or too little light, in all frames together"),
    Measure("temporal", "temporal", "", ".5f", -1, None, "change of the error from frame to frame"),
    Measure("flicker", "flicker", "", "+.5f", 0, 0.0, "change over time beyond the truth's, on resting surfaces"),
    Measure("warped", "warped", "", "+.5f", 0, 0.0, "change beyond the truth's that exact motion does not explain"),
    Measure("edges", "edges", "", ".0%", 0, 1.0, "how much of the strongest edges' sharpness is kept"),
    Measure("shadows", "shadows", "", ".0%", 0, 1.0, "how much of the light's contrast on a surface is kept"),
    Measure("moving_shadows", "moving shadows", "", ".0%", 0, 1.0, "the same where the light has just changed"),
    Measure("detail", "detail", "", ".0%", 0, 1.0, "how much of moving textures' finest contrast is kept"),
    Measure("ghost", "ghost", "", ".0%", 0, 0.0, "how much of the old picture remains where a surface came into view"),
    Measure("unsettled", "unsettled", "", ".1%", -1, None, "thin geometry that is clearly wrong"),
    Measure(
        "lag", "lag", "frames", ".0f", -1, None, "frames until 90 % of a lamp's change is followed; the longest of all"
    ),
)


def value(findings: Findings, key: str) -> float:
    """Return the value of a measure.

    For lag it is the longest: inf if a lamp is never followed, NaN if no lamp was switched.
    """
    if key == "lag":
        return max((inf if frames is None else float(frames) for frames in findings.lags), default=nan)
    return float(getattr(findings, key))

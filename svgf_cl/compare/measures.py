"""The measures of `Findings`, declared once: what tables show of them, in which order, and what is best."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan

from svgf_cl.compare.judge import Findings


@dataclass(frozen=True)
class Measure:
    """What is measured of a picture: a column of the tables, and a set of curves.

    Parameters
    ----------
    key : str
        Of `value`, and of `Judge.curves`.
    title : str
    unit : str
        May be empty.
    spec : str
        How Python formats a value, such as ``.2f``; one that ends in % writes hundredths.
    sign : int
        1 where more is better, -1 where less is, 0 where neither is.
    ideal : float or None
        The value to be near to, where there is one. The sign does not matter then.
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
        """What makes a value good, in words; empty where nothing does."""
        if self.ideal is not None:
            return f"nearest to {self.ideal:g} is best"
        return {1: "more is better", -1: "less is better"}.get(self.sign, "")

    @property
    def arrow(self) -> str:
        """The same as one sign, for the head of a column."""
        if self.ideal is not None:
            return f"→ {self.ideal:g}"
        return {1: "↑", -1: "↓"}.get(self.sign, "")

    @property
    def name(self) -> str:
        """Title and unit."""
        return f"{self.title}, {self.unit}" if self.unit else self.title

    def merit(self, value: float) -> float:
        """How good a value is; more is better."""
        return self.sign * value if self.ideal is None else -abs(value - self.ideal)

    def spell(self, value: float) -> str:
        """Write a value down."""
        return format(value, self.spec).replace("inf", "∞")


MEASURES = (
    Measure("psnr", "PSNR", "dB", ".2f", 1, None, "error as shown"),
    Measure("ssim", "SSIM", "", ".3f", 1, None, "structure as shown"),
    Measure("flip", "FLIP", "", ".4f", -1, None, "difference seen when flipping between picture and truth"),
    Measure("relmse", "relMSE", "", ".4f", -1, None, "error of light relative to the truth; bright dots count most"),
    Measure("relmse_trimmed", "relMSE 99 %", "", ".4f", -1, None, "the same without the worst hundredth of the pixels"),
    Measure("bias", "bias", "", "+.1%", 0, 0.0, "light too much, or too little, in all frames together"),
    Measure("temporal", "temporal", "", ".5f", -1, None, "change of the error from frame to frame"),
    Measure("flicker", "flicker", "", "+.5f", 0, 0.0, "change over time beyond the truth's, on surfaces that rest"),
    Measure("warped", "warped", "", "+.5f", 0, 0.0, "change beyond the truth's that exact motion does not explain"),
    Measure("edges", "edges", "", ".0%", 0, 1.0, "sharpness of the strongest edges that is kept"),
    Measure("shadows", "shadows", "", ".0%", 0, 1.0, "contrast of light on one surface that is kept"),
    Measure("moving_shadows", "moving shadows", "", ".0%", 0, 1.0, "the same where the light has just changed"),
    Measure("detail", "detail", "", ".0%", 0, 1.0, "finest contrast of moving textures that is kept"),
    Measure("ghost", "ghost", "", ".0%", 0, 0.0, "what was seen before and is left where something came into view"),
    Measure("unsettled", "unsettled", "", ".1%", -1, None, "thin geometry that is plainly wrong"),
    Measure("lag", "lag", "frames", ".0f", -1, None, "frames until 90 % of a lamp's switching are followed, at most"),
)


def value(findings: Findings, key: str) -> float:
    """The figure of a measure. Of several lags it is the longest: inf where a lamp is never followed, NaN without."""
    if key == "lag":
        return max((inf if frames is None else float(frames) for frames in findings.lags), default=nan)
    return float(getattr(findings, key))

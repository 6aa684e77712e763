"""The measures of `Findings`, declared once: what tables show of them, in which order, and what is best."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan

from svgf_cl.compare.judge import Findings


@dataclass(frozen=True)
class Measure:
    """A measure as tables and plots need it.

    Parameters
    ----------
    key : str
        Of `value`, and of `Judge.curves`.
    title : str
    unit : str
        Of the value: "dB", "frames", or nothing where it is a ratio or in units of the screen's range.
    spec : str
        How Python formats the value; one that ends in % writes hundredths.
    sign : int
        1 where more is better, -1 where less is, 0 where what is nearest to `ideal` is best.
    ideal : float
        The best there is.
    meaning : str
        One line.
    """

    key: str
    title: str
    unit: str
    spec: str
    sign: int
    ideal: float
    meaning: str


MEASURES = (
    Measure("psnr", "PSNR", "dB", ".2f", 1, inf, "error as shown"),
    Measure("ssim", "SSIM", "", ".3f", 1, 1.0, "structure as shown"),
    Measure("flip", "FLIP", "", ".4f", -1, 0.0, "difference seen when flipping between picture and truth"),
    Measure("relmse", "relMSE", "", ".4f", -1, 0.0, "error of light relative to the truth; bright dots count most"),
    Measure("relmse_trimmed", "relMSE 99 %", "", ".4f", -1, 0.0, "the same without the worst hundredth of the pixels"),
    Measure("bias", "bias", "", "+.1%", 0, 0.0, "light too much, or too little, in all frames together"),
    Measure("temporal", "temporal", "", ".5f", -1, 0.0, "change of the error from frame to frame"),
    Measure("flicker", "flicker", "", "+.5f", 0, 0.0, "change over time beyond the truth's, on surfaces that rest"),
    Measure("warped", "warped", "", "+.5f", 0, 0.0, "change beyond the truth's that exact motion does not explain"),
    Measure("edges", "edges", "", ".0%", 0, 1.0, "sharpness of the strongest edges that is kept"),
    Measure("shadows", "shadows", "", ".0%", 0, 1.0, "contrast of light on one surface that is kept"),
    Measure("moving_shadows", "moving shadows", "", ".0%", 0, 1.0, "the same where the light has just changed"),
    Measure("detail", "detail", "", ".0%", 0, 1.0, "finest contrast of moving textures that is kept"),
    Measure("ghost", "ghost", "", ".0%", 0, 0.0, "what was seen before and is left where something came into view"),
    Measure("unsettled", "unsettled", "", ".1%", -1, 0.0, "thin geometry that is plainly wrong"),
    Measure("lag", "lag", "frames", ".0f", -1, 0.0, "frames until 90 % of a lamp's switching are followed, at most"),
)


def value(findings: Findings, key: str) -> float:
    """The figure of a measure. Of several lags it is the longest: inf where a lamp is never followed, NaN without."""
    if key == "lag":
        return max((inf if frames is None else float(frames) for frames in findings.lags), default=nan)
    return float(getattr(findings, key))

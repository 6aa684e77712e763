"""What a check says: what is wrong, what could not be told, what is right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

# What svgf_cl takes each field for: docs/conventions.md in a line.
EXPECTED = {
    "color": "linear HDR radiance, noisy, without exposure or view transform",
    "normal": "world-space unit vectors, 0 where the ray hit nothing",
    "depth": "distance along the camera's axis, linear, above 0, +inf where the ray hit nothing",
    "motion": "previous minus current position in pixels, x right, y down, no jitter; third component: that of depth",
    "albedo": "linear reflectance, 0 to 1",
    "id": "whole numbers; the same object has the same one in every frame",
    "emission": "linear radiance of visible lamps and sky, also contained in color",
    "direct": "linear radiance, color = direct + indirect + emission",
    "indirect": "linear radiance, color = direct + indirect + emission",
    "diffuse": "linear radiance, color = diffuse + specular + emission",
    "specular": "linear radiance, color = diffuse + specular + emission",
    "roughness": "perceptual roughness, 0 (mirror) to 1",
    "hit_distance": "lengths of rays in scene units, 0 where no ray was sent, +inf where it left the scene",
}


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with the frames.

    Parameters
    ----------
    field : str
        Name of the field of `Frame`.
    what : str
        What is wrong with it, always in the same words.
    measured : str
        The figures that say so.
    cure : str
        What to do.
    severity : {"error", "warning"}
        An error spoils the picture. A warning costs quality, or is none if it is meant so.
    """

    field: str
    what: str
    measured: str
    cure: str
    severity: Literal["error", "warning"] = "error"

    @property
    def expected(self) -> str:
        """What svgf_cl takes the field for."""
        return EXPECTED[self.field]

    def __str__(self) -> str:
        return f"{self.field}: {self.what} ({self.measured}); expected {self.expected}; {self.cure}"


@dataclass(frozen=True)
class Unknown:
    """Something that these frames cannot tell.

    Parameters
    ----------
    topic : str
        What would have been checked.
    why : str
        What the frames lack.
    """

    topic: str
    why: str

    def __str__(self) -> str:
        return f"{self.topic}: not checked: {self.why}"


@dataclass(frozen=True)
class Report:
    """All that was found out about some frames.

    Parameters
    ----------
    findings : tuple of Finding
        What is wrong; the first is the one to mend first.
    unknown : tuple of Unknown
        What could not be told. It is not passed.
    passed : tuple of str
        What was looked at and is right.
    looked_at : dict of str to tuple of str
        Of what looks at one field after the other, which fields were there for it.
    """

    findings: tuple[Finding, ...]
    unknown: tuple[Unknown, ...]
    passed: tuple[str, ...]
    looked_at: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def percent(part: float, whole: float) -> str:
    """Write a share of pixels as people do: ``"3.21 % of the pixels"``."""
    return f"{100 * part / max(whole, 1):.3g} % of the pixels"

"""The results of checks: mistakes, checks that were not possible, and checks that passed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

# The meaning of each field in one line; docs/conventions.md has more.
EXPECTED = {
    "color": "linear HDR radiance, noisy, without exposure or view transform",
    "normal": "world-space unit vectors, 0 where the ray hit nothing",
    "depth": "distance along the camera's axis, linear, above 0, +inf where the ray hit nothing",
    "motion": "previous minus current position in pixels, x right, y down, no jitter; third component: that for depth",
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
    """One mistake in the frames.

    Parameters
    ----------
    field : str
        Name of the field of `Frame`.
    what : str
        The mistake, always in the same words.
    measured : str
        The numbers that show it.
    cure : str
        What to do.
    severity : {"error", "warning"}
        An error spoils the picture. A warning means lower quality, unless the input is meant to be like this.
    """

    field: str
    what: str
    measured: str
    cure: str
    severity: Literal["error", "warning"] = "error"

    @property
    def expected(self) -> str:
        """The meaning of the field."""
        return EXPECTED[self.field]

    def __str__(self) -> str:
        return f"{self.field}: {self.what} ({self.measured}); expected {self.expected}; {self.cure}"


@dataclass(frozen=True)
class Unknown:
    """A check that these frames do not allow.

    Parameters
    ----------
    topic : str
        The check.
    why : str
        What the frames lack.
    """

    topic: str
    why: str

    def __str__(self) -> str:
        return f"{self.topic}: not checked: {self.why}"


@dataclass(frozen=True)
class Report:
    """The results of all checks on some frames.

    Parameters
    ----------
    findings : tuple of Finding
        The mistakes; correct the first one first.
    unknown : tuple of Unknown
        Checks that were not possible. They have not passed.
    passed : tuple of str
        Checks that passed.
    looked_at : dict of str to tuple of str
        For checks of several fields: the fields that the frames have.
    """

    findings: tuple[Finding, ...]
    unknown: tuple[Unknown, ...]
    passed: tuple[str, ...]
    looked_at: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def percent(part: float, whole: float) -> str:
    """Return a share of pixels as text: ``"3.21 % of the pixels"``."""
    return f"{100 * part / max(whole, 1):.3g} % of the pixels"

"""Converts colours of other primaries to Rec. 709."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .errors import SceneError
from .vectors import Float32, Float64

# The x and y of red, green, blue and white (D65).
REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
SAME = 1e-3  # chromaticities that differ by less than this are equal, apart from rounding

# From XYZ to cone responses, which a change of white scales. Source: Lam, Metamerism and colour constancy, University
# of Bradford 1985.
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def to_rec709(picture: Float32, chromaticities: Sequence[float] | None) -> Float32:
    """Convert a (h, w, 3) linear picture with these primaries and white to Rec. 709; white stays white.

    Parameters
    ----------
    picture : (h, w, 3) float32
    chromaticities : 8 floats, optional
        The x and y of red, green, blue and white; by default those of Rec. 709.

    Raises
    ------
    SceneError
        If no colours can have these chromaticities.
    """
    if chromaticities is None or np.allclose(chromaticities, REC709, rtol=0.0, atol=SAME):
        return picture
    points = np.reshape(np.asarray(chromaticities, np.float64), (4, 2))
    try:
        white, target = (BRADFORD @ _xyz(np.asarray(p)) for p in (points[3], REC709[6:]))
        adapt = np.linalg.inv(BRADFORD) @ np.diag(target / white) @ BRADFORD
        matrix = np.linalg.inv(_to_xyz(np.reshape(REC709, (4, 2)))) @ adapt @ _to_xyz(points)
    except np.linalg.LinAlgError:
        matrix = np.full((3, 3), np.nan)
    if not np.isfinite(matrix).all():
        raise SceneError(f"sky: expected chromaticities of three primaries and a white, got {tuple(chromaticities)}")
    converted: Float32 = (picture @ matrix.T).astype(np.float32)
    return converted


def _to_xyz(points: Float64) -> Float64:
    """The matrix to XYZ of (4, 2) chromaticities of red, green, blue and white."""
    primaries = np.stack([_xyz(point) for point in points[:3]], axis=1)
    scale = np.linalg.solve(primaries, _xyz(points[3]))
    to_xyz: Float64 = primaries * scale
    return to_xyz


def _xyz(point: Float64) -> Float64:
    """XYZ of a chromaticity (x, y) with luminance 1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        xyz: Float64 = np.array([point[0], point[1], 1.0 - point[0] - point[1]]) / point[1]
    return xyz

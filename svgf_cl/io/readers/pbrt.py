"""Reads pbrt-v4's film "gbuffer": R G B, Albedo, P, N and Ns; the header has the camera's matrices.

Positions and normals are in camera space unless the film has ``"string coordinatesystem" "world"``. The reader projects
the positions to find out: in the right space they lie on their own pixels.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from svgf_cl.camera import Camera, view_axes
from svgf_cl.io.image import Image
from svgf_cl.io.readers.conversions import Array
from svgf_cl.io.readers.reader import Exactly, Pass, Reader, Values

SWITCH = 'render with Film "gbuffer"'
AXES = ("renderman", "mitsuba")  # x to the right, as in the format, or to the left, in mirrored cameras

Turn = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]


def recognises(image: Image) -> bool:
    """Whether the image has the slopes of depth that no other renderer writes."""
    return image.planes.keys() >= {"dzdx", "dzdy"}


def in_world(values: Values, camera: Camera | None) -> Values:
    """Transform positions and normals from camera space to world space, unless they are in world space already."""
    if camera is None or "position" not in values:
        return values
    position = np.asarray(values["position"], np.float64)
    hit = np.any(position != 0.0, axis=-1)
    unmoved = np.eye(3), np.zeros(3)
    turn, offset = min(
        (unmoved, *(to_world(camera, axes) for axes in AXES)), key=lambda t: error(position, hit, camera, t)
    )
    moved: Values = {"position": np.where(hit[..., None], position @ turn.T + offset, np.nan)}
    if "normal" in values:
        moved["normal"] = np.asarray(values["normal"] @ turn.T, np.float32)
    return {**values, **moved}


def to_world(camera: Camera, axes: str) -> Turn:
    """Return the rotation and offset from the camera's space, whose axes have this name, to world space."""
    inverse = np.linalg.inv(camera.world_to_view) @ view_axes("pbrt", axes)
    return inverse[:3, :3], inverse[:3, 3]


def error(position: Array, hit: Array, camera: Camera, turn: Turn) -> float:
    """Return the median distance of transformed positions from their own pixels, in pixels."""
    rows, columns = np.nonzero(hit)
    pixels, _ = camera.project(position[rows, columns] @ turn[0].T + turn[1])
    distance = np.hypot(*(pixels - np.stack([columns, rows], axis=-1)).T)
    return float(np.median(np.nan_to_num(distance, nan=np.inf))) if rows.size else 0.0


PBRT = Reader(
    name="pbrt",
    title='pbrt-v4, Film "gbuffer"',
    recognises=recognises,
    passes={
        "color": (Pass(("",), 3),),
        "albedo": (Pass(("Albedo",), 3),),
        # Versions before 2022 wrote Px instead of P.X.
        "normal": (Pass(("Ns", "N"), 3), Exactly(("Nsx", "Nsy", "Nsz"))),
        "position": (Pass(("P",), 3), Exactly(("Px", "Py", "Pz"))),
    },
    switches=dict.fromkeys(("albedo", "normal", "depth", "motion"), SWITCH),
    complete=in_world,
)

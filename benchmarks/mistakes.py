"""Good sequences, and twenty mistakes that users make in their frames, to measure `svgf-cl check` with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from svgf_cl.check import Report, alignment, camera, depth, motion, shading, surfaces, values
from svgf_cl.check.check import Check
from svgf_cl.frame import Frame, Shape
from svgf_cl.io import synthetic as room
from svgf_cl.io.display import display
from svgf_cl_tracer import BUILTIN, Camera, CameraPath, Shot, render_frame
from svgf_cl_tracer.camera import vector
from svgf_cl_tracer.cli.scenes import open_scene
from svgf_cl_tracer.sampling import pixel_jitter

ROOM = "room"
NEAR, FAR = 0.05, 200.0  # clipping planes of a graphics API's camera, in scene units
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Taken:
    """A frame, and the renderer's additional knowledge of the camera.

    Parameters
    ----------
    frame : Frame
    axes : (3, 3)
        Rows right, up and forward of the camera.
    focal : float
        Focal length in pixels.
    jitter : (2,)
        Sub-pixel offset x, y of the rays.
    """

    frame: Frame
    axes: Array
    focal: float
    jitter: Array


def good_sequence(scene: str, shape: Shape, count: int) -> list[Taken]:
    """Frames without mistakes from the middle of a shot, of the room, of a built-in scene or of a scene file."""
    if scene == ROOM:
        frames = list(room.room_frames(shape, count))
        return [
            Taken(frame, np.diag([1.0, 1.0, -1.0]), room.FOCAL_LENGTH * shape[0], np.array(pixel_jitter(number)))
            for number, frame in enumerate(frames)
        ]
    length = BUILTIN[scene].frames if scene in BUILTIN else 24
    shot = Shot(open_scene(scene, None), shape, length)
    if scene not in BUILTIN:
        shot = replace(shot, camera_path=orbit(shot.camera(0)))
    return [taken(shot, number) for number in range(length // 2 - count // 2, length // 2 - count // 2 + count)]


def orbit(camera: Camera) -> CameraPath:
    """A camera that moves around the point it looks at, and nearer to it."""
    towards = np.subtract(camera.look_at, camera.position)
    right, up, _ = camera.basis() * np.linalg.norm(towards)
    start, end = (camera.position + side * (0.3 * right + 0.1 * up + 0.2 * towards) for side in (-0.5, 0.5))
    return CameraPath.through([replace(camera, position=vector(start)), replace(camera, position=vector(end))])


def taken(shot: Shot, number: int) -> Taken:
    """A frame of a shot with only those fields that every renderer has, without parts that must add up to the whole."""
    everything = render_frame(shot, number)
    fields = ("color", "normal", "depth", "motion", "albedo", "id", "emission")
    camera = shot.camera(number)
    frame = Frame(**{name: getattr(everything, name) for name in fields})
    return Taken(frame, camera.basis(), camera.lens(shot.shape).scale, np.array(pixel_jitter(number)))


@dataclass(frozen=True)
class Mistake:
    """A mistake, and the finding that a check should report.

    Parameters
    ----------
    check : Check
        The check that should find it.
    field, what : str
        Field and text of the finding; `what` is the beginning of the text.
    make : callable
        Makes the wrong values of fields of a frame, from the previous frame and the frame.
    """

    check: Check
    field: str
    what: str
    make: Callable[[Taken, Taken], dict[str, Any]]

    def made_in(self, good: Sequence[Taken]) -> list[Frame]:
        """The sequence with the mistake; its first frame is only the previous one of the second."""
        return [self._made(before, now) for before, now in pairwise(good)]

    def named_in(self, report: Report) -> bool:
        """Whether a report has exactly this finding."""
        return any(found.field == self.field and found.what.startswith(self.what) for found in report.findings)

    def _made(self, before: Taken, now: Taken) -> Frame:
        fields = self.make(before, now)
        types = {name: np.uint32 if name == "id" else np.float32 for name in fields}
        return replace(now.frame, **{name: np.ascontiguousarray(fields[name], types[name]) for name in fields})


def in_units(before: Taken, now: Taken) -> dict[str, Any]:
    """Motion as a share of the image's size."""
    height, width = now.frame.shape
    return {"motion": now.frame.motion / (width, height, 1)}


def in_ndc(before: Taken, now: Taken) -> dict[str, Any]:
    """Motion in normalised device coordinates of a graphics API, where y points up."""
    height, width = now.frame.shape
    return {"motion": now.frame.motion / (width / 2, -height / 2, 1)}


def jittered(before: Taken, now: Taken) -> dict[str, Any]:
    """Motion between cameras, including their jitter."""
    return {"motion": now.frame.motion - [*(before.jitter - now.jitter), 0]}


def in_view_space(before: Taken, now: Taken) -> dict[str, Any]:
    """Normals in the space of a camera that looks along -z."""
    return {"normal": now.frame.normal @ (now.axes * [[1], [1], [-1]]).T}


def buffer(before: Taken, now: Taken) -> dict[str, Any]:
    """Depth as in the depth buffer of a graphics API, 0 near and 1 far."""
    return {"depth": FAR / (FAR - NEAR) * (1 - NEAR / now.frame.depth.astype(np.float64))}


def inverted(before: Taken, now: Taken) -> dict[str, Any]:
    """Depth as in an inverted depth buffer, 1 at the near plane and 0 at the far one."""
    return {"depth": np.maximum(FAR - now.frame.depth, 0) / (FAR - NEAR)}


def along_the_ray(before: Taken, now: Taken) -> dict[str, Any]:
    """Depth along the ray."""
    height, width = now.frame.shape
    y, x = np.mgrid[:height, :width] - np.array([height - 1, width - 1])[:, None, None] / 2
    return {"depth": now.frame.depth * np.sqrt(1 + (x**2 + y**2) / now.focal**2)}


def srgb_encoded(albedo: Array) -> Array:
    """Encode with sRGB, as in a texture file."""
    return display(np.minimum(albedo, 1))


def shining_albedo(before: Taken, now: Taken) -> dict[str, Any]:
    """Albedo that contains emitted light; in a scene without any, that of a lamp in the corner."""
    emission = np.zeros_like(now.frame.albedo) if now.frame.emission is None else now.frame.emission.copy()
    emission[:8, :8] += 5.0
    return {"albedo": now.frame.albedo + emission}


def renumbered(before: Taken, now: Taken) -> dict[str, Any]:
    """Ids in the order in which the objects appear in this frame."""
    ids = now.frame.id
    order = np.random.default_rng(int(1e6 * abs(now.jitter[0]))).permutation(np.unique(ids))
    return {"id": order[np.searchsorted(np.unique(ids), ids)].astype(np.uint32)}


def not_a_number(color: Array) -> Array:
    """Colour with a NaN in every thousandth pixel."""
    broken: Array = color.copy()
    broken.reshape(-1, 3)[::997] = np.nan
    return broken


def of(field: str, change: Callable[[Any], Any]) -> Callable[[Taken, Taken], dict[str, Any]]:
    """A mistake that changes one field of a frame."""
    return lambda before, now: {field: change(getattr(now.frame, field))}


MISTAKES = {
    "motion: current minus previous": Mistake(
        motion.DIRECTION, "motion", "points the other way", of("motion", lambda given: given * (-1, -1, 1))
    ),
    "motion: y up": Mistake(motion.DIRECTION, "motion", "y points up", of("motion", lambda given: given * (1, -1, 1))),
    "motion: x and y exchanged": Mistake(
        motion.DIRECTION, "motion", "x and y are exchanged", of("motion", lambda given: given[..., [1, 0, 2]])
    ),
    "motion: UV units": Mistake(motion.DIRECTION, "motion", "in UV units", in_units),
    "motion: NDC, y up": Mistake(motion.DIRECTION, "motion", "in NDC", in_ndc),
    "motion: all 0": Mistake(motion.DIRECTION, "motion", "0, but something moves", of("motion", np.zeros_like)),
    "motion: jitter left in": Mistake(camera.JITTER, "motion", "contains jitter", jittered),
    "normal: 0..1": Mistake(values.LENGTH, "normal", "encoded in 0..1", of("normal", lambda given: 0.5 * given + 0.5)),
    "normal: view space": Mistake(surfaces.WORLD, "normal", "in view space", in_view_space),
    "normal: constant": Mistake(
        values.FILLED, "normal", "one value everywhere", of("normal", lambda given: 0 * given + (0, 0, 1))
    ),
    "normal: upside down": Mistake(alignment.UPRIGHT, "normal", "upside down", of("normal", np.flipud)),
    "depth: z-buffer": Mistake(depth.ENCODING, "depth", "not linear", buffer),
    "depth: inverted": Mistake(depth.ENCODING, "depth", "inverted", inverted),
    "depth: along the ray": Mistake(depth.ENCODING, "depth", "measured along the ray", along_the_ray),
    "albedo: sRGB": Mistake(shading.CURVE, "albedo", "encoded in sRGB", of("albedo", srgb_encoded)),
    "albedo: with emission": Mistake(values.ALBEDO, "albedo", "above 1", shining_albedo),
    "color: gamma": Mistake(
        shading.CURVE, "color", "encoded for a display", of("color", lambda given: np.power(given, 1 / 2.2))
    ),
    "color: a frame late": Mistake(
        shading.CURVE, "color", "of the previous frame", lambda before, now: {"color": before.frame.color}
    ),
    "color: NaN": Mistake(values.FINITE, "color", "NaN", of("color", not_a_number)),
    "id: renumbered": Mistake(surfaces.NAMES, "id", "the same object changes its id", renumbered),
}

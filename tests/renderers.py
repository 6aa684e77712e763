"""Frames of one known scene as renderers write them: in their names, axes, units and spaces.

The scene is the tiled room of `svgf_cl.io.synthetic`, turned and moved so that no axis of the world is one of the
camera, with a patch of sky, where nothing is hit, and a lamp.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from svgf_cl import Camera, Frame
from svgf_cl.frame import Shape
from svgf_cl.io.cameras import NAME
from svgf_cl.io.exr_header import Attribute
from svgf_cl.io.readers.own import CHANNEL_NAMES
from svgf_cl.io.synthetic import FOCAL_LENGTH, View, eye, room_frame
from tests.camera_headers import HABITS, header
from tests.exr_files import exr_bytes

Planes = dict[str, np.ndarray]
Header = dict[str, Attribute]

SHAPE = (20, 32)
NUMBERS = (1, 2, 3)  # of the frames
SKY, LAMP = np.s_[2:6, 5:12], np.s_[12:14, 20:26]
WORLD = np.array([(0.36, 0.48, -0.8, 3.0), (-0.8, 0.6, 0.0, -2.0), (0.48, 0.64, 0.6, 5.0), (0.0, 0.0, 0.0, 1.0)])
FOV = math.degrees(2 * math.atan(0.5 / FOCAL_LENGTH))
NO_HEADER: Header = {}
UP = np.array((1, -1), np.float32)  # turns pixels whose y goes down into pixels whose y goes up
FAR = np.float32(1e10)  # what Blender and others call the depth of nothing


@dataclass(frozen=True, eq=False)
class Moment:
    """A frame of the scene, and what renderers may write of it beside.

    Parameters
    ----------
    number : int
    frame : Frame
        With every field of the surface, and its light in parts.
    position : (H, W, 3) float64
        World-space positions; 0 where nothing was hit.
    camera : Camera
    to_next : (H, W, 2) float32
        Where a pixel is in the next frame, minus where it is.
    """

    number: int
    frame: Frame
    position: np.ndarray
    camera: Camera
    to_next: np.ndarray

    @property
    def hit(self) -> np.ndarray:
        """Whether a pixel (H, W) shows a surface."""
        return np.isfinite(self.frame.depth)


def moments(numbers: Iterable[int] = NUMBERS, shape: Shape = SHAPE) -> list[Moment]:
    """The scene at these frames, each after the one of the number before."""
    return [moment(number, shape) for number in numbers]


def moment(number: int, shape: Shape = SHAPE) -> Moment:
    """The scene at a frame."""
    room = room_frame(shape, number, number - 1, signals=2)
    emission = np.zeros((*shape, 3), np.float32)
    emission[SKY], emission[LAMP] = (0.5, 0.75, 2.0), 64.0
    lit = ~emission.any(axis=-1, keepdims=True)
    direct, indirect = room.direct * lit, room.indirect * lit
    fields = {
        "color": direct + indirect + emission,
        "direct": direct,
        "indirect": indirect,
        "emission": emission,
        "albedo": in_sky(room.albedo, 1.0),
        "normal": in_sky(room.normal @ WORLD[:3, :3].T, 0.0),
        "depth": in_sky(room.depth, np.inf),
        "motion": in_sky(room.motion, 0.0),
    }
    frame = Frame(**{name: np.asarray(value, np.float32) for name, value in fields.items()}, id=in_sky(room.id, 0))
    points = View.of(shape, eye(number)).points @ WORLD[:3, :3].T + WORLD[:3, 3]
    following = room_frame(shape, number, number + 1).motion[..., :2]
    return Moment(number, frame, in_sky(points, 0.0), camera(number, shape), in_sky(following, 0.0))


def in_sky(value: np.ndarray, nothing: float) -> np.ndarray:
    """A field that holds `nothing` where nothing was hit."""
    result = np.array(value)
    result[SKY] = nothing
    return result


def to_world(number: int) -> np.ndarray:
    """The (4, 4) matrix of a frame's camera, in OpenGL's axes."""
    place = np.eye(4)
    place[:3, 3] = eye(number)
    return WORLD @ place


def camera(number: int, shape: Shape = SHAPE) -> Camera:
    """The camera of a frame."""
    return Camera.from_fov(to_world(number), FOV, shape, "y", "opengl")


def layer(name: str, value: np.ndarray, components: str = "RGB") -> Planes:
    """The channels of a pass, one letter each."""
    value = np.asarray(value).reshape(*value.shape[:2], -1)
    return {f"{name}.{c}": np.ascontiguousarray(value[..., i]) for i, c in enumerate(components)}


def rgb(picture: np.ndarray) -> Planes:
    """The channels of a picture that has no layer, with alpha."""
    alpha = np.ones(picture.shape[:2], np.float32)
    return {**{c: np.ascontiguousarray(picture[..., i]) for i, c in enumerate("RGB")}, "A": alpha}


def quotient(light: np.ndarray, factor: np.ndarray) -> np.ndarray:
    """Light before it was multiplied by a factor."""
    return np.asarray(light / factor, np.float32)


# One function a renderer


def own(at: Moment, fields: Iterable[str] | None = None) -> Planes:
    """Our own channels, of all fields or of these alone."""
    planes: Planes = {}
    for name, value in at.frame.present().items():
        if fields is None or name in fields:
            components = np.moveaxis(value.reshape(*SHAPE, -1), -1, 0)
            planes |= zip(CHANNEL_NAMES[name], map(np.ascontiguousarray, components), strict=False)
    return planes


def blender(at: Moment, view_layer: str = "ViewLayer") -> Planes:
    """Cycles' passes: diffuse light, the sky and lamps."""
    frame, sky = at.frame, np.where(at.hit, 0, 1)[..., None].astype(np.float32)
    planes = {
        **layer("Combined", np.concatenate([frame.color, np.ones((*SHAPE, 1), np.float32)], -1), "RGBA"),
        **layer("Depth", np.where(at.hit, frame.depth, FAR), "Z"),
        **layer("Normal", frame.normal, "XYZ"),
        **layer("Vector", np.concatenate([frame.motion[..., :2] * UP, -at.to_next * UP], -1), "XYZW"),
        **layer("IndexOB", frame.id.astype(np.float32), "X"),
        **layer("Denoising Albedo", frame.albedo),
        **layer("Denoising Normal", np.zeros((*SHAPE, 3), np.float32), "XYZ"),
        **layer("DiffDir", quotient(frame.direct, frame.albedo)),
        **layer("DiffInd", quotient(frame.indirect, frame.albedo)),
        **layer("DiffCol", frame.albedo),
        **layer("Emit", frame.emission * (1 - sky)),
        **layer("Env", frame.emission * sky),
    }
    return {f"{view_layer}.{name}": plane for name, plane in planes.items()}


BLENDER_HEADER: Header = {"BlenderMultiChannel": ("string", b"Blender V2.55.1 and newer")}


def mitsuba(at: Moment) -> Planes:
    """An integrator `aov` with albedo:albedo, nn:sh_normal, dd:depth, pp:position and idx:shape_index."""
    distance = np.linalg.norm(at.position - to_world(at.number)[:3, 3], axis=-1)
    return {
        **rgb(at.frame.color),
        **layer("img", at.frame.color),
        **layer("albedo", np.where(at.hit[..., None], at.frame.albedo, 0)),
        **layer("nn", at.frame.normal, "XYZ"),
        **layer("dd", in_sky(distance, 0.0).astype(np.float32), "T"),
        **layer("pp", at.position.astype(np.float32), "XYZ"),
        **layer("idx", at.frame.id.astype(np.float32), "I"),
    }


MITSUBA_HEADER: Header = {"generatedBy": ("string", b"Mitsuba version 3.9.1")}


def pbrt(at: Moment, space: str = "camera", *, old: bool = False) -> Planes:
    """The film "gbuffer" in camera space or in that of the world; `old` as it was called before 2022."""
    position, normal = at.position, at.frame.normal.astype(np.float64)
    if space == "camera":
        axes = np.diag((1.0, -1.0, 1.0))  # x to the right, y up, z forward
        position = in_sky(at.camera.to_view(position) @ axes, 0.0)
        normal = normal @ at.camera.world_to_view[:3, :3].T @ axes
    planes = {
        **rgb(at.frame.color),
        **layer("Albedo", at.frame.albedo),
        **layer("P", position.astype(np.float32), "XYZ"),
        **layer("N", -normal.astype(np.float32), "XYZ"),
        **layer("Ns", normal.astype(np.float32), "XYZ"),
        "dzdx": np.zeros(SHAPE, np.float32),
        "dzdy": np.zeros(SHAPE, np.float32),
    }
    return {old_name(name) if old else name: plane for name, plane in planes.items()}


def old_name(channel: str) -> str:
    """What pbrt called P.X before 2022: Px."""
    layer, _, component = channel.rpartition(".")
    return layer + component.lower() if layer in ("P", "N", "Ns") else channel


def arnold(at: Moment, *, position: bool = True, motion: bool = False) -> Planes:
    """AOVs of Arnold, with P, with motionvector, or with both."""
    planes = {
        **rgb(at.frame.color),
        **layer("albedo", at.frame.albedo),
        **layer("N", at.frame.normal, "XYZ"),
        "Z": np.where(at.hit, at.frame.depth, np.float32(0)),
        **layer("diffuse_direct", at.frame.direct),
        **layer("diffuse_indirect", at.frame.indirect),
        **layer("emission", np.where(at.hit[..., None], at.frame.emission, 0)),
        **layer("background", np.where(at.hit[..., None], 0, at.frame.emission)),
        **layer("crypto_object00", cryptomatte(at.frame.id), "RGBA"),
    }
    planes |= layer("P", at.position.astype(np.float32), "XYZ") if position else {}
    return planes | (layer("motionvector", -at.frame.motion[..., :2] * UP, "XY") if motion else {})


ARNOLD_HEADER: Header = {
    "arnold/version": ("string", b"7.3.1.0"),
    "cryptomatte/b7e4a92/name": ("string", b"crypto_object"),
    "cryptomatte/b7e4a92/manifest": ("string", b'{"floor":"00000001","w\xc3\xa4nde":"00000002"}'),
}


def vray(at: Moment, spelling: str = "maya") -> Planes:
    """Render elements of V-Ray in the names of Maya or of 3ds Max."""
    frame = at.frame
    towards_viewer = frame.normal @ WORLD[:3, :3].astype(np.float32)  # x to the right, y up
    elements = [
        ("diffuse", "VRayDiffuseFilter", frame.albedo),
        ("normals", "VRayNormals", towards_viewer),
        ("lighting", "VRayLighting", frame.direct),
        ("gi", "VRayGlobalIllumination", frame.indirect),
        ("self_illumination", "VRaySelfIllumination", frame.emission),
        ("velocity", "VRayVelocity", np.concatenate([-frame.motion[..., :2] * UP, np.zeros((*SHAPE, 1))], -1)),
    ]
    planes = rgb(frame.color)
    for maya, studio, value in elements:
        name, words = (maya, ("red", "green", "blue")) if spelling == "maya" else (studio, "RGB")
        planes |= {f"{name}.{c}": np.ascontiguousarray(value[..., i], np.float32) for i, c in enumerate(words)}
    depth = np.where(at.hit, frame.depth, FAR)
    planes |= {"z_depth.red": depth} if spelling == "maya" else {"VRayZDepth.Z": depth}
    return {**planes, "render_id.I" if spelling == "maya" else "VRayRenderID": frame.id}


VRAY_HEADER: Header = {"vrayInfo/version": ("string", b"V-Ray 6")}


def cryptomatte(ids: np.ndarray) -> np.ndarray:
    """The first layer (H, W, 4) of a Cryptomatte: ids as the bits of floats, and how much of the pixel they cover."""
    cover = (ids > 0).astype(np.float32)
    nothing = np.zeros_like(cover)
    return np.stack([np.asarray(ids, np.uint32).view(np.float32), cover, nothing, nothing], axis=-1)


def matrices(at: Moment, habit: str, *, transposed: bool = False) -> Header:
    """The attributes of a header that has the frame's camera, as the renderer with this habit writes them."""
    both = header(at.camera, at.frame.shape, **HABITS[habit])
    names = ("worldToCamera", "worldToNDC")
    return {
        name: ("m44f", (matrix.T if transposed else matrix).astype("<f4").tobytes())
        for name, matrix in zip(names, both, strict=True)
    }


def cameras_file(folder: Path, numbers: Iterable[int], shape: Shape = SHAPE) -> Path:
    """The cameras of these frames as cameras.json in a folder."""
    cameras = [{"frame": n, "to_world": to_world(n).tolist(), "fov": FOV, "fov_axis": "y"} for n in numbers]
    content = {"width": shape[1], "height": shape[0], "axes": "opengl", "cameras": cameras}
    path = folder / NAME
    path.write_text(json.dumps(content))
    return path


def written(
    folder: Path, planes: Mapping[int, Planes], header: Header | Mapping[int, Header] = NO_HEADER, stem: str = "shot_"
) -> Path:
    """A folder of files with these channels by the number of the frame, and with one header or one for each."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, channels in planes.items():
        own: Header = header.get(number, header)  # type: ignore[call-overload,assignment]
        (folder / f"{stem}{number:04d}.exr").write_bytes(exr_bytes(channels, own))
    return folder


def same_frames(found: Iterable[Frame], expected: Iterable[Frame], tolerance: Mapping[str, float] = {}) -> None:
    """Check that frames have the same fields, equal or within an absolute tolerance, and nothing where nothing is."""
    for one, other in zip(found, expected, strict=True):
        assert one.present().keys() == other.present().keys()
        for name, value in one.present().items():
            wanted = getattr(other, name)
            assert value.dtype == wanted.dtype
            np.testing.assert_allclose(value, wanted, rtol=0, atol=tolerance.get(name, 0.0), err_msg=name, verbose=True)


def truth(at: Moment, *absent: str, motion: int = 2) -> Frame:
    """The frame without its light in parts and these fields, with so many components of motion."""
    fields = dict.fromkeys(("direct", "indirect", *absent))
    return replace(at.frame, motion=np.ascontiguousarray(at.frame.motion[..., :motion]), **fields)

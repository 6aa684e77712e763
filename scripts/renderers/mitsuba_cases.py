"""Renders short shots with Mitsuba 3, with the settings of a typical user.

    python scripts/renderers/mitsuba_cases.py CASE OUT

Each case is a folder OUT/CASE: `noisy` with few samples and AOVs, `reference` with many samples, and cameras.json with
the camera of each frame and of the frame before the first. It needs `pip install mitsuba`, 3.5 or newer.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mitsuba as mi

mi.set_variant("scalar_rgb")
transform = mi.ScalarTransform4f

WIDTH, HEIGHT = 256, 144
FRAMES = range(8)
FOV = 40.0
MAX_DEPTH = 8

Scene = dict[str, Any]
Vector = Sequence[float]


@dataclass(frozen=True)
class Case:
    """One shot: its objects and camera in a frame, the AOVs and the samples per pixel."""

    things: Callable[[float], Scene]
    camera: Callable[[float], Any]
    aovs: str
    samples: int
    reference_samples: int = 150


def render(case: Case, out: Path) -> None:
    """Render the noisy frames and the reference of a case, and write its cameras."""
    for name in ("noisy", "reference"):
        (out / name).mkdir(parents=True, exist_ok=True)
    for frame in FRAMES:
        path: Scene = {"type": "path", "max_depth": MAX_DEPTH}
        noisy: Scene = {"type": "aov", "aovs": case.aovs, "beauty": path}
        write(case, frame, noisy, case.samples, out / "noisy" / f"frame.{frame:04d}.exr")
        write(case, frame, path, case.reference_samples, out / "reference" / f"frame.{frame:04d}.exr")
    (out / "cameras.json").write_text(json.dumps(cameras(case), indent=1) + "\n")


def write(case: Case, frame: int, integrator: Scene, samples: int, path: Path) -> None:
    """Render and write one frame; the seed differs between frames, and between noisy frames and references."""
    scene = mi.load_dict(
        {"type": "scene", "integrator": integrator, "sensor": sensor(case.camera(frame)), **case.things(frame)}
    )
    mi.render(scene, spp=samples, seed=1000 * samples + frame)
    mi.Bitmap(scene.sensors()[0].film().bitmap()).write(str(path))


def sensor(to_world: Any) -> Scene:
    film = {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "pixel_format": "rgb", "rfilter": {"type": "box"}}
    return {"type": "perspective", "fov": FOV, "fov_axis": "smaller", "to_world": to_world, "film": film}


def cameras(case: Case) -> Scene:
    """The camera of each frame, and of the frame before the first."""
    frames = [
        {"frame": frame, "to_world": case.camera(frame).matrix.numpy().tolist(), "fov": FOV, "fov_axis": "smaller"}
        for frame in range(-1, len(FRAMES))
    ]
    return {"width": WIDTH, "height": HEIGHT, "renderer": f"Mitsuba {mi.__version__}", "cameras": frames}


# Objects of a scene


def matte(*color: float) -> Scene:
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(*color)}}


def rough_metal(material: str, roughness: float) -> Scene:
    return {"type": "roughconductor", "material": material, "alpha": roughness}


def rgb(*color: float) -> Scene:
    return {"type": "rgb", "value": list(color)}


def ball(at: Vector, radius: float, bsdf: Scene) -> Scene:
    return {"type": "sphere", "center": list(at), "radius": radius, "bsdf": bsdf}


def cube(at: Vector, size: Vector, turn: float, bsdf: Scene) -> Scene:
    """A box whose edges have the lengths `size`, turned about the vertical by `turn` degrees."""
    half = [length / 2 for length in size]
    to_world = transform().translate(list(at)).rotate([0, 1, 0], turn).scale(half)
    return {"type": "cube", "to_world": to_world, "bsdf": bsdf}


def wall(at: Vector, toward: Vector, size: Vector, bsdf: Scene) -> Scene:
    """A rectangle at `at` whose front faces `toward`."""
    up = [0, 0, 1] if at[0] == toward[0] and at[2] == toward[2] else [0, 1, 0]
    to_world = transform().look_at(list(at), list(toward), up).scale([size[0] / 2, size[1] / 2, 1])
    return {"type": "rectangle", "to_world": to_world, "bsdf": bsdf}


def lamp(at: Vector, toward: Vector, size: Vector, *radiance: float) -> Scene:
    return {**wall(at, toward, size, matte(0, 0, 0)), "emitter": {"type": "area", "radiance": rgb(*radiance)}}


def camera(at: Vector, target: Vector) -> Any:
    return transform().look_at(list(at), list(target), [0, 1, 0])


# The scenes, one function each, and their cameras


def closed_box(frame: float) -> Scene:
    """A room with a lamp in the ceiling; a cube turns and a ball crosses."""
    white = matte(0.7, 0.7, 0.7)
    return {
        "floor": wall((0, -1, 0), (0, 0, 0), (4, 4), white),
        "ceiling": wall((0, 1, 0), (0, 0, 0), (4, 4), white),
        "back": wall((0, 0, -1.5), (0, 0, 0), (4, 2), white),
        "left": wall((-1.6, 0, 0), (0, 0, 0), (4, 2), matte(0.6, 0.06, 0.05)),
        "right": wall((1.6, 0, 0), (0, 0, 0), (4, 2), matte(0.1, 0.45, 0.1)),
        "lamp": lamp((0, 0.99, 0), (0, 0, 0), (0.8, 0.5), 14, 11, 7),
        "cube": cube((-0.6, -0.6, -0.5), (0.7, 0.8, 0.7), 20 + 4 * frame, matte(0.7, 0.55, 0.2)),
        "ball": ball((0.1 + 0.08 * frame, -0.65, 0.2), 0.35, matte(0.15, 0.25, 0.7)),
    }


def closed_box_camera(frame: float) -> Any:
    return camera((-0.3 + 0.07 * frame, 0.1, 3.6), (0.02 * frame, -0.1, 0))


def materials(frame: float) -> Scene:
    """Rough metals, glass and area lights under a uniform sky; the gold ball moves."""
    tiles = {"type": "checkerboard", "color0": rgb(0.1, 0.1, 0.12), "color1": rgb(0.7, 0.7, 0.65)}
    tiles["to_uv"] = transform().scale([16, 16, 1])
    return {
        "sky": {"type": "constant", "radiance": rgb(0.25, 0.35, 0.5)},
        "floor": wall((0, -1, 0), (0, 0, 0), (16, 16), {"type": "diffuse", "reflectance": tiles}),
        "gold": ball((-1.2 + 0.1 * frame, -0.5, 0.6), 0.5, rough_metal("Au", 0.1)),
        "copper": cube((-1.4, -0.55, -0.8), (0.9, 0.9, 0.9), 30, rough_metal("Cu", 0.4)),
        "chrome": ball((0.2, -0.4, -0.9), 0.6, {"type": "conductor", "material": "Cr"}),
        "glass": ball((1.1, -0.5, 0.3), 0.5, {"type": "dielectric"}),
        "frosted": cube((1.9, -0.5, -0.9), (0.6, 1.0, 0.6), 15, {"type": "roughdielectric", "alpha": 0.15}),
        "plastic": ball((0.1, -0.8, 1.2), 0.2, {"type": "plastic", "diffuse_reflectance": rgb(0.6, 0.08, 0.05)}),
        "lamp": lamp((-1.5, 2.2, 1.5), (0, -0.5, 0), (0.8, 0.8), 18, 16, 12),
        "tube": lamp((1.5, 0.6, -2.5), (0, -0.5, 0), (1.6, 0.1), 20, 30, 45),
    }


def materials_camera(frame: float) -> Any:
    return camera((-0.5 + 0.12 * frame, 0.5, 4.6), (0.1 + 0.02 * frame, -0.3, 0))


CASES = {
    "box": Case(
        closed_box,
        closed_box_camera,
        "depth:depth,normal:sh_normal,position:position,shape:shape_index,albedo:albedo",
        samples=4,
    ),
    "materials": Case(
        materials,
        materials_camera,
        "albedo:albedo,geo:geo_normal,normal:sh_normal,depth:depth,position:position,uv:uv,shape:shape_index,prim:prim_index",
        samples=1,
    ),
}


if __name__ == "__main__":
    render(CASES[sys.argv[1]], Path(sys.argv[2]).resolve() / sys.argv[1])

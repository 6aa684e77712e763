"""Render a few frames in Blender with the passes that svgf-cl reads, and denoise them.

    blender --background [SCENE.blend] --python examples/blender.py -- [FOLDER]
    python examples/blender.py [FOLDER] [--scene SCENE.blend]        # after `pip install bpy`

Without a scene, it builds a small one. The scene's file is not changed. Blender's own Python need not have svgf_cl,
because `svgf-cl` is called as a command. If it is not on the PATH, name it with `--svgf-cl`.
"""

from __future__ import annotations

import argparse
import math
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import bpy

# The names of passes in View Layer Properties > Passes, and their switches in Python.
DATA_PASSES = {
    "Z": "use_pass_z",
    "Normal": "use_pass_normal",
    "Vector": "use_pass_vector",
    "Denoising Data": "cycles.denoising_store_passes",
    "Cryptomatte Object": "use_pass_cryptomatte_object",  # separates objects; may be left out
}
# These passes add up to the picture. Without them the picture is denoised as a whole, and reflections lose detail.
LIGHT_PASSES = (
    *(f"use_pass_{kind}_{part}" for kind in ("diffuse", "glossy", "transmission") for part in ("direct", "indirect")),
    *(f"use_pass_{kind}_color" for kind in ("diffuse", "glossy", "transmission")),
    *(f"cycles.use_pass_volume_{part}" for part in ("direct", "indirect")),
    "use_pass_emit",
    "use_pass_environment",
)


def main() -> None:
    """Render, denoise, and print where the pictures are."""
    options = parsed()
    if options.scene:
        bpy.ops.wm.open_mainfile(filepath=str(options.scene))
    elif not bpy.data.filepath:
        build_scene()
    scene = bpy.context.scene
    noisy, denoised = options.folder / "noisy", options.folder / "denoised"
    set_up_rendering(scene, options.samples, options.frames)
    for layer in scene.view_layers:
        switch_passes_on(layer)
    set_up_files(scene, noisy)
    bpy.ops.render.render(animation=True)
    subprocess.run([*options.svgf_cl, "denoise", str(noisy), "-o", str(denoised), "--png"], check=True)
    print(f"noisy frames in {noisy}, denoised ones and PNGs to look at in {denoised}")


def parsed() -> argparse.Namespace:
    """Read the options; inside Blender these are the ones after ``--``."""
    before = "--" if "--" in sys.argv else sys.argv[-1] if bpy.app.binary_path else sys.argv[0]
    parser = argparse.ArgumentParser(prog="blender.py", description="Render in Blender and denoise.")
    parser.add_argument(
        "folder", nargs="?", type=Path, default=Path("out/examples/blender"), help="folder for the frames"
    )
    parser.add_argument("--scene", type=Path, metavar="SCENE.blend")
    parser.add_argument("--samples", type=int, default=2, metavar="N", help="samples per pixel (2)")
    parser.add_argument(
        "--frames", type=int, default=8, metavar="N", help="number of frames, from the scene's first one on (8)"
    )
    parser.add_argument("--svgf-cl", default="svgf-cl", metavar="COMMAND", help="command of svgf-cl")
    options = parser.parse_args(sys.argv[sys.argv.index(before) + 1 :])
    options.folder, options.svgf_cl = options.folder.resolve(), shlex.split(options.svgf_cl)
    if not shutil.which(options.svgf_cl[0]):
        parser.error(f"--svgf-cl: expected the command svgf-cl, found no {options.svgf_cl[0]}; give its whole path")
    return options


def set_up_rendering(scene: Any, samples: int, frames: int) -> None:
    """Few samples, noise that differs between frames, and no motion blur, which would leave the pass Vector empty."""
    scene.render.engine = "CYCLES"
    scene.frame_end = scene.frame_start + frames - 1
    scene.render.use_motion_blur = False
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.use_animated_seed = True


def switch_passes_on(layer: Any) -> None:
    """Switch on all passes of a view layer."""
    for name in (*DATA_PASSES.values(), *LIGHT_PASSES):
        owner, _, switch = name.rpartition(".")
        setattr(layer.cycles if owner else layer, switch, True)


def set_up_files(scene: Any, folder: Path) -> None:
    """Write one OpenEXR file per frame with all passes; colours are half floats, which is precise enough for them."""
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth, settings.exr_codec = "16", "ZIP"
    scene.render.filepath = str(folder / "frame_")


# The scene if none is given: balls of plaster, gold and glass on tiles; a cube turns, and the camera moves.


def build_scene() -> None:
    """Build the scene in an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 480, 270, 100
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.25, 0.35, 0.5, 1)
    bpy.ops.mesh.primitive_plane_add(size=20)
    show(tiled(material("Tiles", (0.7, 0.7, 0.65), 0.7)))
    for name, x, color, roughness, inputs in (
        ("Plaster", -1.4, (0.7, 0.12, 0.08), 0.8, {}),
        ("Gold", 0.0, (1.0, 0.75, 0.3), 0.15, {"Metallic": 1.0}),
        ("Glass", 1.4, (1.0, 1.0, 1.0), 0.0, {"Transmission Weight": 1.0}),
    ):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.6, location=(x, 0, 0.6))
        bpy.ops.object.shade_smooth()
        show(material(name, color, roughness, **inputs))
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(-0.7, -1.3, 0.3))
    show(material("Paint", (0.1, 0.25, 0.6), 0.4))
    animate(bpy.context.object, "rotation_euler", (0, 0, 0), (0, 0, 0.8))
    bpy.ops.object.light_add(type="AREA", location=(-3, -3, 4), rotation=(math.radians(45), 0, math.radians(-45)))
    bpy.context.object.data.energy, bpy.context.object.data.size = 400, 1.0
    bpy.ops.object.camera_add(rotation=(math.radians(75), 0, 0))
    animate(bpy.context.object, "location", (-0.4, -6.3, 2.1), (0.4, -6.3, 2.1))
    scene.camera = bpy.context.object


def material(name: str, color: tuple[float, float, float], roughness: float, **inputs: float) -> Any:
    """A Principled material."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    sockets = made.node_tree.nodes["Principled BSDF"].inputs
    for socket, value in {"Base Color": (*color, 1), "Roughness": roughness, **inputs}.items():
        sockets[socket].default_value = value
    return made


def tiled(surface: Any) -> Any:
    """Add dark tiles to a material, and return it."""
    nodes, links = surface.node_tree.nodes, surface.node_tree.links
    checker, color = nodes.new("ShaderNodeTexChecker"), nodes["Principled BSDF"].inputs["Base Color"]
    checker.inputs["Color1"].default_value = color.default_value
    checker.inputs["Color2"].default_value, checker.inputs["Scale"].default_value = (0.1, 0.1, 0.12, 1), 20
    links.new(checker.outputs["Color"], color)
    return surface


def show(surface: Any) -> None:
    """Give the material to the object that was added last."""
    bpy.context.object.data.materials.append(surface)


def animate(thing: Any, what: str, start: tuple[float, ...], end: tuple[float, ...]) -> None:
    """Animate a property of an object over the first eight frames."""
    for frame, value in ((1, start), (8, end)):
        setattr(thing, what, value)
        thing.keyframe_insert(what, frame=frame)


if __name__ == "__main__":
    main()

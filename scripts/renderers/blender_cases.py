"""Renders short shots with Blender's Cycles, with the settings of a typical user.

    python scripts/renderers/blender_cases.py CASE OUT

Each case is a folder OUT/CASE: `noisy` with few samples and all passes, `reference` with many and the light passes.
It needs `pip install bpy`, 4.2 to 5.0; `multi_part` needs 5.0, and the cases of the compositor a 4.x.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import blender_scenes as scenes
import bpy
from blender_parts import FIRST, LAST

WIDTH, HEIGHT = 256, 144
THREADS = 2

LIGHT_PASSES = (
    *(f"use_pass_diffuse_{part}" for part in ("direct", "indirect", "color")),
    *(f"use_pass_glossy_{part}" for part in ("direct", "indirect", "color")),
    *(f"use_pass_transmission_{part}" for part in ("direct", "indirect", "color")),
    "use_pass_emit",
    "use_pass_environment",
)
DATA_PASSES = ("z", "normal", "vector", "object_index", "cryptomatte_object", "cryptomatte_material")


@dataclass(frozen=True)
class Case:
    """One shot: the scene, the samples per pixel, and how the renderer writes the noisy frames.

    A case without samples for a reference has no own reference; another case with the same scene has it.
    """

    scene: Callable[[], None]
    samples: int
    reference_samples: int = 150
    animated_seed: bool = True
    write: Callable[[Path], None] = lambda folder: multilayer(folder)


def render(case: Case, out: Path) -> None:
    """Render the noisy frames of a case, and the reference of its first view layer."""
    for name, samples, seed in (("noisy", case.samples, 0), ("reference", case.reference_samples, 4321)):
        if not samples:
            continue
        bpy.ops.wm.read_factory_settings(use_empty=True)
        frame_settings(samples, seed, case.animated_seed)
        case.scene()
        first, *others = bpy.context.scene.view_layers
        switch_passes_on(first, data=name == "noisy")
        for layer in others:
            layer.use = name == "noisy"
            switch_passes_on(layer, data=True)
        write = case.write if name == "noisy" else multilayer
        write(out / name)
        bpy.ops.render.render(animation=True)


def frame_settings(samples: int, seed: int, animated_seed: bool) -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FIRST, LAST
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.render.threads_mode, scene.render.threads = "FIXED", THREADS
    scene.render.use_persistent_data = True
    scene.cycles.samples = samples
    scene.cycles.seed, scene.cycles.use_animated_seed = seed, animated_seed
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False


def switch_passes_on(layer: Any, data: bool) -> None:
    """Switch on the light passes of a view layer, and with `data` also the passes about surfaces."""
    for name in LIGHT_PASSES:
        setattr(layer, name, True)
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True
    for name in DATA_PASSES:
        setattr(layer, f"use_pass_{name}", data)
    layer.cycles.denoising_store_passes = data


def multilayer(folder: Path) -> None:
    """Write one OpenEXR file per frame with all passes, half float and zip."""
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth, settings.exr_codec = "16", "ZIP"
    if hasattr(settings, "use_exr_interleave"):
        settings.use_exr_interleave = True
    bpy.context.scene.render.filepath = str(folder / "shot_")


def multi_part(folder: Path) -> None:
    """Write one OpenEXR file per frame in which each pass is a part, the default of Blender 5."""
    multilayer(folder)
    bpy.context.scene.render.image_settings.use_exr_interleave = False


def default_sockets(folder: Path) -> None:
    """Use the compositor's File Output node, multilayer; each socket keeps the name that Blender gives it."""
    file_output(folder, "shot_", "OPEN_EXR_MULTILAYER", lambda name: "Image")


def named_sockets(folder: Path) -> None:
    """Use the compositor's File Output node, multilayer; each socket has the name of its pass."""
    file_output(folder, "shot_", "OPEN_EXR_MULTILAYER", lambda name: name)


def separate_files(folder: Path) -> None:
    """Use the compositor's File Output node; each pass is a separate file."""
    file_output(folder, "", "OPEN_EXR", lambda name: f"{name}_")


def file_output(folder: Path, stem: str, file_format: str, socket_name: Callable[[str], str]) -> None:
    """Link every pass of the first view layer to a File Output node; its format keeps Blender's defaults."""
    scene = bpy.context.scene
    scene.use_nodes = True
    nodes, links = scene.node_tree.nodes, scene.node_tree.links
    nodes.clear()
    passes, output = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeOutputFile")
    output.format.file_format = file_format
    output.base_path = str(folder / stem)
    output.file_slots.clear()
    slots = output.layer_slots if file_format == "OPEN_EXR_MULTILAYER" else output.file_slots
    wanted = [socket for socket in passes.outputs if socket.enabled and socket.name not in ("Alpha", "Noisy Image")]
    for socket in wanted:
        slots.new(socket_name(socket.name))
        links.new(socket, output.inputs[-1])
    composite = nodes.new("CompositorNodeComposite")
    links.new(passes.outputs["Image"], composite.inputs["Image"])
    scene.render.filepath = str(folder.parent / "composite" / "shot_")
    scene.render.image_settings.file_format = "OPEN_EXR"


CASES = {
    "metal_glass": Case(scenes.metal_glass, samples=1),
    "dof": Case(scenes.dof, samples=4),
    "texture": Case(scenes.texture, samples=1),
    "alpha": Case(scenes.alpha, samples=2),
    "volume": Case(scenes.volume, samples=2),
    "motion_blur": Case(scenes.motion_blur, samples=4),
    "bright": Case(scenes.bright, samples=1),
    "world": Case(scenes.world, samples=1, animated_seed=False),
    "file_output": Case(scenes.metal_glass, samples=2, reference_samples=0, write=default_sockets),
    "file_output_named": Case(scenes.metal_glass, samples=2, reference_samples=0, write=named_sockets),
    "separate_files": Case(scenes.metal_glass, samples=2, reference_samples=0, write=separate_files),
    "multi_part": Case(scenes.metal_glass, samples=2, reference_samples=0, write=multi_part),
}


if __name__ == "__main__":
    render(CASES[sys.argv[1]], Path(sys.argv[2]).resolve() / sys.argv[1])

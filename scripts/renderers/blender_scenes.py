"""The scenes of the Blender cases, one function each.

Each builds a scene of primitives in the empty file that is open.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import bpy
from blender_parts import (
    Object,
    area_light,
    box,
    bumped,
    camera,
    checker,
    cylinder,
    daylight,
    glass,
    glowing,
    metal,
    plane,
    point_light,
    sky,
    slide,
    sphere,
    surface,
    textured,
    torus,
)


def metal_glass() -> None:
    """Metals from sharp to rough, a glass ball and a mirror; the torus moves."""
    plane("Floor", (0, 0, 0), 20, checker("Tiles", 1.5), 1)
    plane("Mirror", (0, 3, 1.2), 4, metal("Mirror", (0.95, 0.95, 0.95), 0.0), 2, turn=(math.pi / 2, 0, 0.25))
    for index, (x, roughness) in enumerate(((-2.1, 0.0), (-0.7, 0.2), (0.7, 0.5)), start=3):
        sphere(f"Metal {roughness}", (x, 0, 0.6), 0.6, metal(f"Metal {roughness}", (0.9, 0.7, 0.45), roughness), index)
    sphere("Glass", (2.1, -0.3, 0.6), 0.6, glass("Glass"), 6)
    ring = torus("Torus", (-1.2, -1.4, 0.35), 0.35, surface("Red", (0.7, 0.08, 0.05)), 7)
    slide(ring, (1.2, -1.4, 0.35), (0.6, 0.3, 0))
    area_light((-3, -3, 4), (0, 0, 0), 1.0, 250)
    area_light((3, 1, 4), (1, 0, 0), 0.5, 120)
    sky((0.25, 0.35, 0.5), 0.5)
    camera((-0.7, -6, 1.8), (0.7, -6, 1.9), (0, 0, 0.8), (0.2, 0, 0.8))


def dof() -> None:
    """A wide open lens, focused on the middle row; small lamps in the background become discs."""
    plane("Floor", (0, 0, 0), 40, checker("Tiles", 1.0), 1)
    colors = ((0.7, 0.1, 0.1), (0.1, 0.5, 0.15), (0.1, 0.2, 0.7), (0.7, 0.55, 0.1), (0.5, 0.5, 0.5))
    for index, color in enumerate(colors, start=2):
        material = surface(f"Paint {index}", color, 0.35)
        sphere(f"Ball {index}", (-1.5 + 0.75 * (index - 2), -2.5 + 1.8 * (index - 2), 0.4), 0.4, material, index)
    for index in range(8):
        at = (-4 + 1.2 * index, 9, 0.8 + 0.5 * (index % 3))
        sphere(f"Lamp {index}", at, 0.05, glowing("Lamp", (1, 0.7, 0.4), 150), 8)
    cube = box("Cube", (-1.2, 1.0, 0.3), (0.5, 0.5, 0.5), surface("White", (0.8, 0.8, 0.8)), 9)
    slide(cube, (0.4, 1.0, 0.3), (0, 0, 0.8))
    area_light((-3, -3, 5), (0, 0, 0), 2.0, 400)
    sky((0.3, 0.4, 0.6), 0.3)
    eye = camera((-0.3, -5, 1.3), (0.3, -5, 1.3), (0, 1, 0.5), (0.3, 1, 0.5))
    eye.data.dof.use_dof, eye.data.dof.focus_distance, eye.data.dof.aperture_fstop = True, 6.0, 0.12


def motion_blur() -> None:
    """The shutter is open for half a frame; a bar spins, a ball flies, the camera pans."""
    bpy.context.scene.render.use_motion_blur = True
    plane("Floor", (0, 0, 0), 20, checker("Tiles", 1.5), 1)
    bar = box("Bar", (-1.2, 0, 1.0), (2.0, 0.2, 0.3), surface("Blue", (0.1, 0.2, 0.7), 0.3), 2)
    slide(bar, (-1.2, 0, 1.0), (0, 3.0, 0))
    ball = sphere("Ball", (0.2, -0.5, 0.5), 0.5, surface("Red", (0.7, 0.1, 0.08), 0.4), 3)
    slide(ball, (3.0, -0.5, 0.9))
    box("Post", (1.5, 1.5, 1.0), (0.4, 0.4, 2.0), surface("White", (0.8, 0.8, 0.8)), 4)
    area_light((-3, -3, 5), (0, 0, 0), 1.5, 400)
    sky((0.3, 0.4, 0.6), 0.5)
    camera((0, -6, 1.8), (0, -6, 1.8), (-0.5, 0, 0.8), (1.0, 0, 0.8))


def alpha() -> None:
    """No sky in the picture: threads thinner than a pixel, a leaf cut out by its texture, a pane with alpha 0.5."""
    bpy.context.scene.render.film_transparent = True
    thread = surface("Thread", (0.35, 0.2, 0.1), 0.5)
    for index in range(14):
        x = -2.2 + 0.16 * index
        cylinder(f"Thread {index}", (x, 0.2, 0), (x + 0.5 * math.sin(index), 0.1, 2.2), 0.004, thread, 2)
    leaf = plane("Leaf", (0.9, 0, 1.1), 1.6, leaf_material(), 3, turn=(1.3, 0.2, 0.1))
    slide(leaf, (1.3, 0, 1.2), (0.2, 0.5, 0.3))
    half = surface("Pane", (0.2, 0.5, 0.6), 0.3, Alpha=0.5)
    plane("Pane", (1.9, -0.6, 0.8), 1.2, half, 4, turn=(math.pi / 2, 0, 0.4))
    sphere("Ball", (0.0, 0.8, 0.5), 0.5, surface("Clay", (0.6, 0.4, 0.3)), 5)
    sphere("Glass", (-0.7, -0.8, 0.35), 0.35, glass("Glass"), 6)
    area_light((-3, -3, 4), (0, 0, 1), 1.5, 300)
    sky((0.4, 0.5, 0.7), 0.6)
    camera((-0.6, -5.5, 1.4), (0.6, -5.5, 1.4), (0, 0, 1.0), (0.1, 0, 1.0))


def leaf_material() -> Any:
    """Thin, with holes where a noise texture is dark."""
    material = surface("Leaf", (0.15, 0.5, 0.08), 0.5)
    textured(material, "Noise", "Base Color", Scale=3.0)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    holes, cut = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeMath")
    holes.inputs["Scale"].default_value = 6.0
    cut.operation = "GREATER_THAN"
    cut.inputs[1].default_value = 0.48
    links.new(holes.outputs[0], cut.inputs[0])
    links.new(cut.outputs[0], nodes["Principled BSDF"].inputs["Alpha"])
    return material


def volume() -> None:
    """Uniform fog in a box as large as a room, a lamp inside it, and objects that shade the fog."""
    bpy.context.scene.cycles.volume_bounces = 2  # at 0, Volume Indirect would be empty
    plane("Floor", (0, 0, 0), 20, surface("Grey", (0.5, 0.5, 0.5)), 1)
    box("Fog", (0, 0, 1.5), (7, 7, 3.2), fog(0.25), 2)
    for index in range(5):
        box(f"Post {index}", (-2.0 + index, 0.6, 0.8), (0.15, 0.15, 1.6), surface("Wood", (0.5, 0.3, 0.15)), 3)
    ball = sphere("Ball", (-1.0, -0.8, 0.5), 0.4, metal("Steel", (0.7, 0.7, 0.72), 0.25), 4)
    slide(ball, (1.0, -0.8, 0.5))
    point_light((0.2, 1.8, 1.4), 0.1, 250)
    sphere("Bulb", (-1.4, 0.0, 2.0), 0.08, glowing("Bulb", (1, 0.5, 0.2), 80), 5)
    sky((0.1, 0.15, 0.3), 0.3)
    camera((-0.8, -6.5, 1.5), (0.4, -6.0, 1.5), (0, 0, 1.0), (0, 0, 1.0))


def fog(density: float) -> Any:
    """A volume that scatters, without a surface."""
    material = bpy.data.materials.new("Fog")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    scatter, output = nodes.new("ShaderNodeVolumeScatter"), nodes.new("ShaderNodeOutputMaterial")
    scatter.inputs["Density"].default_value = density
    material.node_tree.links.new(scatter.outputs[0], output.inputs["Volume"])
    return material


def bright() -> None:
    """The sun's disc in the picture, lamps from 10 to 100000, caustics; light is neither clamped nor blurred."""
    cycles = bpy.context.scene.cycles
    cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    plane("Floor", (0, 0, 0), 30, surface("Floor", (0.6, 0.6, 0.6), 0.6), 1)
    for index, strength in enumerate((10.0, 1e3, 1e5)):
        lamp = glowing(f"Lamp {index}", (1, 0.8, 0.5), strength)
        sphere(f"Lamp {strength:g}", (-2.4 + 0.9 * index, 1.5, 1.6), 0.06, lamp, 2)
    sphere("Glass", (0.9, 0, 0.6), 0.6, glass("Glass"), 3)
    sphere("Chrome", (-1.0, 0, 0.5), 0.5, metal("Chrome", (0.9, 0.9, 0.9), 0.05), 4)
    ring = torus("Torus", (-0.4, -1.6, 0.3), 0.4, metal("Gold", (0.9, 0.65, 0.2), 0.1), 5)
    slide(ring, (1.2, -1.6, 0.3), (0.5, 0.2, 0))
    daylight(0.02, math.radians(11), math.radians(8), sun_disc=True)
    camera((-0.6, -6, 1.3), (0.6, -6, 1.3), (0.2, 0, 1.2), (0.6, 0, 1.2))


def texture() -> None:
    """Textures near and below the size of a pixel, and bumps; two view layers, the second one without the balls."""
    plane("Floor", (0, 0, 0), 30, checker("Fine tiles", 9.0), 1)
    noise = textured(surface("Marble", (0.5, 0.5, 0.5), 0.4), "Noise", "Base Color", Scale=25.0, Detail=8.0)
    plane("Wall", (0, 3.5, 2), 9, noise, 2, turn=(math.pi / 2, 0, 0))
    balls = (
        sphere("Rough ball", (-1.6, 0, 0.7), 0.7, bumped(surface("Clay", (0.7, 0.35, 0.2)), 30, 0.8), 3),
        sphere("Hammered ball", (0.2, 0, 0.7), 0.7, bumped(metal("Copper", (0.9, 0.5, 0.35), 0.25), 12, 0.5), 4),
    )
    cube = box("Cube", (1.4, -0.6, 0.5), (0.8, 0.8, 0.8), checker("Cube checks", 14, (0.6, 0.05, 0.05)), 5)
    slide(cube, (2.2, -0.8, 0.5), (0, 0, 0.7))
    area_light((-3, -3, 4), (0, 0, 0), 1.0, 350)
    sky((0.4, 0.5, 0.7), 0.4)
    camera((-0.5, -5.5, 1.7), (0.5, -5.3, 1.8), (0, 0, 0.8), (0.2, 0, 0.8))
    second_view_layer("Ebene.001 ü", without=balls)


def second_view_layer(name: str, without: Sequence[Object]) -> None:
    """Add a view layer without some objects; the first view layer keeps all objects."""
    scene = bpy.context.scene
    hidden = bpy.data.collections.new("Hidden in the second")
    scene.collection.children.link(hidden)
    for thing in without:
        hidden.objects.link(thing)
        scene.collection.objects.unlink(thing)
    layer = scene.view_layers.new(name)
    layer.layer_collection.children[hidden.name].exclude = True


def world() -> None:
    """Most of the picture is a cloudy sky over hills of balls; the camera turns."""
    tree, background, day = daylight(0.12, math.radians(25), math.radians(100), sun_disc=False)
    clouds(tree, day, background)
    plane("Ground", (0, 0, 0), 200, surface("Ground", (0.25, 0.22, 0.15)), 1)
    for index in range(9):
        at = (-6 + 1.5 * index, 4 + 1.5 * math.sin(2.2 * index), 0.1)
        sphere(f"Hill {index}", at, 0.9, surface("Grass", (0.1, 0.25, 0.06)), 2)
    balloon = sphere("Balloon", (-1.0, 3, 2.2), 0.35, surface("Red", (0.8, 0.1, 0.06), 0.3), 3)
    slide(balloon, (0.4, 3, 2.6))
    sphere("Chrome", (0.6, 0.5, 0.9), 0.4, metal("Chrome", (0.95, 0.95, 0.95), 0.0), 4)
    camera((0, -4, 1.2), (0, -4, 1.2), (-0.4, 2, 2.0), (0.6, 2, 2.0), 28)


def clouds(tree: Any, day: Any, background: Any) -> None:
    """Mix white clouds of a noise texture into a sky."""
    noise, ramp, mix = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexNoise", "ValToRGB", "MixRGB"))
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 3.5, 8.0
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.5, 0.65
    mix.inputs["Color2"].default_value = (12, 12, 12.5, 1)
    tree.links.new(noise.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs["Color"], mix.inputs["Fac"])
    tree.links.new(day.outputs["Color"], mix.inputs["Color1"])
    tree.links.new(mix.outputs["Color"], background.inputs["Color"])

"""Parts of the scenes for Blender: objects, lights, a camera, motion, materials and skies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import bpy

FIRST, LAST = 1, 8  # frames

Vector = Sequence[float]
Object = Any


def placed(name: str, material: Any, index: int, smooth: bool = True) -> Object:
    """Give the object that was added last a name, a material and an object index, and return it."""
    thing = bpy.context.object
    thing.name, thing.pass_index = name, index
    thing.data.materials.append(material)
    for polygon in thing.data.polygons:
        polygon.use_smooth = smooth
    return thing


def sphere(name: str, at: Vector, radius: float, material: Any, index: int) -> Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=radius, location=at)
    return placed(name, material, index)


def box(name: str, at: Vector, size: Vector, material: Any, index: int) -> Object:
    bpy.ops.mesh.primitive_cube_add(size=1, location=at, scale=size)
    return placed(name, material, index, smooth=False)


def torus(name: str, at: Vector, radius: float, material: Any, index: int) -> Object:
    bpy.ops.mesh.primitive_torus_add(
        location=at, major_radius=radius, minor_radius=radius / 3, major_segments=64, minor_segments=24
    )
    return placed(name, material, index)


def cylinder(name: str, start: Vector, end: Vector, radius: float, material: Any, index: int) -> Object:
    along = [b - a for a, b in zip(start, end, strict=True)]
    length = math.hypot(*along)
    turn = (0.0, math.acos(along[2] / length), math.atan2(along[1], along[0]))
    middle = [(a + b) / 2 for a, b in zip(start, end, strict=True)]
    bpy.ops.mesh.primitive_cylinder_add(vertices=12, radius=radius, depth=length, location=middle, rotation=turn)
    return placed(name, material, index)


def plane(name: str, at: Vector, size: float, material: Any, index: int, turn: Vector = (0, 0, 0)) -> Object:
    bpy.ops.mesh.primitive_plane_add(size=size, location=at, rotation=turn)
    return placed(name, material, index, smooth=False)


def area_light(at: Vector, toward: Vector, size: float, watts: float) -> Object:
    bpy.ops.object.light_add(type="AREA", location=at)
    light = bpy.context.object
    light.data.size, light.data.energy = size, watts
    light.rotation_euler = direction(at, toward)
    return light


def point_light(at: Vector, radius: float, watts: float) -> Object:
    bpy.ops.object.light_add(type="POINT", location=at)
    light = bpy.context.object
    light.data.shadow_soft_size, light.data.energy = radius, watts
    return light


def camera(start: Vector, end: Vector, target_start: Vector, target_end: Vector, millimetres: float = 35) -> Object:
    """A camera that moves from `start` to `end` at an even speed, while its target moves, too."""
    bpy.ops.object.camera_add(location=start)
    eye = bpy.context.object
    eye.name, eye.data.lens = "Cam", millimetres
    turns = [direction(at, toward) for at, toward in ((start, target_start), (end, target_end))]
    move(eye, start, end, turns[0], turns[1])
    bpy.context.scene.camera = eye
    return eye


def direction(at: Vector, toward: Vector) -> Vector:
    """Euler angles of a camera or light at `at` that faces `toward`, upright."""
    x, y, z = (b - a for a, b in zip(at, toward, strict=True))
    return (math.pi / 2 + math.atan2(z, math.hypot(x, y)), 0.0, math.atan2(y, x) - math.pi / 2)


def move(thing: Object, start: Vector, end: Vector, turn_start: Vector, turn_end: Vector) -> None:
    """Move an object straight at an even speed, beginning before the first frame and ending after the last."""
    for frame, at, turn in ((FIRST, start, turn_start), (LAST, end, turn_end)):
        thing.location, thing.rotation_euler = at, turn
        thing.keyframe_insert("location", frame=frame)
        thing.keyframe_insert("rotation_euler", frame=frame)
    for curve in curves(thing):
        curve.extrapolation = "LINEAR"
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def curves(thing: Object) -> Any:
    """The animation curves of an object."""
    action = thing.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return action.layers[0].strips[0].channelbag(thing.animation_data.action_slot).fcurves  # Blender 5


def slide(thing: Object, end: Vector, turn: Vector = (0, 0, 0)) -> None:
    """Move an object from its place to `end`, and turn it by `turn` at the same time."""
    start, turned = tuple(thing.location), tuple(thing.rotation_euler)
    move(thing, start, end, turned, [a + b for a, b in zip(turned, turn, strict=True)])


# Materials and skies


def surface(name: str, color: Vector, roughness: float = 0.8, **inputs: Any) -> Any:
    """A Principled material; `inputs` are its other sockets, with `_` instead of a space."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    principled = material.node_tree.nodes.get("Principled BSDF") or principled_of(material)
    principled.inputs["Base Color"].default_value = (*color, 1)
    principled.inputs["Roughness"].default_value = roughness
    for socket, value in inputs.items():
        principled.inputs[socket.replace("_", " ")].default_value = value
    return material


def principled_of(material: Any) -> Any:
    """Make a new Principled node the surface of a material without nodes."""
    nodes = material.node_tree.nodes
    principled, output = nodes.new("ShaderNodeBsdfPrincipled"), nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(principled.outputs[0], output.inputs["Surface"])
    return principled


def metal(name: str, color: Vector, roughness: float) -> Any:
    return surface(name, color, roughness, Metallic=1.0)


def glass(name: str) -> Any:
    return surface(name, (1, 1, 1), 0.0, Transmission_Weight=1.0, IOR=1.45)


def glowing(name: str, color: Vector, strength: float) -> Any:
    return surface(name, (0, 0, 0), Emission_Color=(*color, 1), Emission_Strength=strength)


def textured(material: Any, kind: str, socket: str, output: str | None = None, **values: Any) -> Any:
    """Link a texture in the objects' own coordinates to a socket of a Principled material."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    coordinates, texture = nodes.new("ShaderNodeTexCoord"), nodes.new(f"ShaderNodeTex{kind}")
    for name, value in values.items():
        texture.inputs[name].default_value = value
    links.new(coordinates.outputs["Object"], texture.inputs["Vector"])
    target = next(node for node in nodes if node.type == "BSDF_PRINCIPLED").inputs[socket]
    links.new(texture.outputs[output or "Color"], target)
    return material


def checker(name: str, scale: float, dark: Vector = (0.05, 0.05, 0.06), light: Vector = (0.8, 0.78, 0.7)) -> Any:
    return textured(surface(name, light), "Checker", "Base Color", Scale=scale, Color1=(*dark, 1), Color2=(*light, 1))


def bumped(material: Any, scale: float, strength: float) -> Any:
    """Add a noise texture as a bump map."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    noise, bump = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeBump")
    noise.inputs["Scale"].default_value, bump.inputs["Strength"].default_value = scale, strength
    links.new(noise.outputs[0], bump.inputs["Height"])
    target = next(node for node in nodes if node.type == "BSDF_PRINCIPLED").inputs["Normal"]
    links.new(bump.outputs["Normal"], target)
    return material


def sky(color: Vector, strength: float) -> tuple[Any, Any]:
    """An even sky; returns its node tree and background node."""
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes = world.node_tree.nodes
    nodes.clear()
    background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    background.inputs["Color"].default_value = (*color, 1)
    background.inputs["Strength"].default_value = strength
    world.node_tree.links.new(background.outputs[0], output.inputs["Surface"])
    return world.node_tree, background


def daylight(strength: float, elevation: float, turn: float, sun_disc: bool) -> tuple[Any, Any, Any]:
    """The sky of a clear day; returns its node tree, background node and sky node."""
    tree, background = sky((0, 0, 0), strength)
    texture = tree.nodes.new("ShaderNodeTexSky")
    kinds = texture.bl_rna.properties["sky_type"].enum_items.keys()
    texture.sky_type = "NISHITA" if "NISHITA" in kinds else "SINGLE_SCATTERING"
    texture.sun_disc, texture.sun_elevation, texture.sun_rotation = sun_disc, elevation, turn
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    return tree, background, texture

"""Lights (KHR_lights_punctual) and cameras of a file, placed by their nodes.

The extension's units, candela and lux, are kept, and so are the nits of KHR_materials_emissive_strength. So radiance is
in nits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from svgf_cl.errors import shown
from svgf_cl_tracer.camera import Camera, CarriedCamera, vector
from svgf_cl_tracer.errors import SceneError
from svgf_cl_tracer.lights import PointLight, Sun
from svgf_cl_tracer.meshes import colour
from svgf_cl_tracer.model import Eye, Light
from svgf_cl_tracer.motion import Motion

from .extensions import LIGHTS
from .file import Gltf, entry
from .nodes import Nodes


def read_lights(gltf: Gltf, nodes: Nodes) -> Iterator[Light]:
    """The lights of the scene's nodes."""
    known = gltf.document.get("extensions", {}).get(LIGHTS, {}).get("lights", [])
    for chain in nodes.chains():
        extension = nodes.node(chain).get("extensions", {}).get(LIGHTS)
        if extension:
            yield Light(_light(entry(known, "lights", extension["light"]), nodes.motion(chain)), nodes.names(chain))


def _light(document: dict[str, Any], motion: Motion) -> PointLight | Sun:
    strength = colour(np.array(document.get("color", (1.0, 1.0, 1.0))) * document.get("intensity", 1.0))
    kind = document.get("type")
    if kind not in ("directional", "point", "spot"):
        raise SceneError(f"lights: expected the type directional, point or spot, found {shown(kind)}")
    if kind == "directional":
        sun = Sun((0.0, 0.0, 1.0), strength, angular_radius=0.0, motion=motion)
        return sun if motion.changes else replace(sun, direction_to_light=vector(sun.direction_at(0.0)), motion=None)
    inner, outer = 180.0, 180.0
    if kind == "spot":
        cone = document.get("spot", {})
        inner = math.degrees(cone.get("innerConeAngle", 0.0))
        outer = math.degrees(cone.get("outerConeAngle", math.pi / 4.0))
    reach = document.get("range", math.inf)
    light = PointLight((0.0, 0.0, 0.0), strength, (0.0, 0.0, -1.0), inner, outer, reach, motion)
    if motion.changes:
        return light
    position, direction = light.placed(0.0)
    return replace(light, position=vector(position), direction=vector(direction), motion=None)


def read_camera(gltf: Gltf, nodes: Nodes) -> Eye | None:
    """The first camera among the scene's nodes; None if there is none."""
    for chain in nodes.chains():
        node = nodes.node(chain)
        if "camera" in node:
            camera = _camera(gltf.item("cameras", node["camera"]))
            return Eye(CarriedCamera(camera, nodes.motion(chain)), nodes.names(chain))
    return None


def _camera(document: dict[str, Any]) -> Camera:
    eye, ahead = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)
    if "orthographic" in document:
        return Camera(eye, ahead, view_height=2.0 * abs(document["orthographic"]["ymag"]))
    return Camera(eye, ahead, fov_y=math.degrees(document["perspective"]["yfov"]))
